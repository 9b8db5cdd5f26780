// SPDX-License-Identifier: Apache-2.0
// What the parts of the module plvo._plvo share, and what each of them adds to it.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <map>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>

#include "plvo/python/arguments.hpp"
#include "plvo/python/error.hpp"

namespace plvo::python {

void bind_camera(py::module_& module);
void bind_config(py::module_& module);
void bind_result(py::module_& module);
void bind_prior(py::module_& module);
void bind_odometry(py::module_& module);
void bind_map(py::module_& module);
void bind_sequence(py::module_& module);

// What docstrings.py makes of __init__.pyi.
extern const std::map<std::string, const char*> kDocstrings;

// The docstring of "Camera.builtin" in __init__.pyi, where all of them stand; null for a name like __len__
// without one. Throws where a public name has none: the module cannot be imported then.
const char* docstring(const std::string& name);

// A py::class_ whose members have the docstrings of __init__.pyi.
template <typename Class>
class Documented : public py::class_<Class> {
 public:
  Documented(py::module_& module, const char* name)
      : py::class_<Class>(module, name, docstring(name)), name_(name) {}

  template <typename Function, typename... Extra>
  Documented& def(const char* name, Function&& function, const Extra&... extra) {
    Base::def(name, std::forward<Function>(function), extra..., doc(name));
    return *this;
  }
  // py::init and py::pickle.
  template <typename Maker, typename... Extra>
  requires(!std::is_convertible_v<Maker, const char*>) Documented& def(Maker&& maker, const Extra&... extra) {
    Base::def(std::forward<Maker>(maker), extra...);
    return *this;
  }
  template <typename Function, typename... Extra>
  Documented& def_static(const char* name, Function&& function, const Extra&... extra) {
    Base::def_static(name, std::forward<Function>(function), extra..., doc(name));
    return *this;
  }
  template <typename Getter>
  Documented& def_property_readonly(const char* name, const Getter& getter) {
    Base::def_property_readonly(name, getter, doc(name));
    return *this;
  }
  template <typename Of, typename Member>
  Documented& def_readonly(const char* name, const Member Of::*member) {
    Base::def_readonly(name, member, doc(name));
    return *this;
  }

 private:
  using Base = py::class_<Class>;
  const char* doc(const char* member) const { return docstring(name_ + "." + member); }

  std::string name_;
};

// A class of the package. An object that __new__ made and __init__ did not is refused wherever it is used:
// pybind11 asks the type's `operator_new` for what such an object lacks, and by itself takes memory that
// nobody has initialised.
template <typename Class>
Documented<Class> bind_class(py::module_& module, const char* name) {
  Documented<Class> type(module, name);
  py::detail::get_type_info(typeid(Class))->operator_new = [](std::size_t) -> void* {
    const auto class_name = std::string(py::str(py::type::of<Class>().attr("__name__")));
    throw py::type_error("this plvo." + class_name +
                         " was not initialised: its __init__ has not been called");
  };
  return type;
}

// A type of named tuples that belongs to the package.
inline py::object namedtuple(py::module_& module, const char* name, const char* fields) {
  py::object type =
      py::module_::import("collections").attr("namedtuple")(name, fields, py::arg("module") = "plvo");
  type.attr("__doc__") = docstring(name);
  for (const py::handle field : py::object(type.attr("_fields")))
    type.attr(field).attr("__doc__") = docstring(name + ("." + field.cast<std::string>()));
  module.add_object(name, type);
  return type;
}

}  // namespace plvo::python

// SPDX-License-Identifier: Apache-2.0
// What the parts of the module plvo._plvo share, and what each of them adds to it.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>
#include <typeinfo>

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

// A class of the package. An object that __new__ made and __init__ did not is refused wherever it is used:
// pybind11 asks the type's `operator_new` for what such an object lacks, and by itself takes memory that
// nobody has initialised.
template <typename Class>
py::class_<Class> bind_class(py::module_& module, const char* name) {
  py::class_<Class> type(module, name);
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
  module.add_object(name, type);
  return type;
}

}  // namespace plvo::python

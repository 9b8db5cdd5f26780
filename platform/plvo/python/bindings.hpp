// SPDX-License-Identifier: Apache-2.0
// What the parts of the module plvo._plvo share, and what each of them adds to it.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "plvo/python/error.hpp"

namespace plvo::python {

void bind_camera(py::module_& module);
void bind_config(py::module_& module);
void bind_result(py::module_& module);
void bind_prior(py::module_& module);
void bind_odometry(py::module_& module);
void bind_sequence(py::module_& module);

// None is no value.
template <typename Value>
std::optional<Value> optional(const py::object& object) {
  return object.is_none() ? std::nullopt : std::optional<Value>(object.cast<Value>());
}

// Of a str, bytes or os.PathLike.
inline std::string path_text(const py::object& path) {
  return py::module_::import("os").attr("fsdecode")(path).cast<std::string>();
}

// A type of named tuples that belongs to the package.
inline py::object namedtuple(py::module_& module, const char* name, const char* fields) {
  py::object type =
      py::module_::import("collections").attr("namedtuple")(name, fields, py::arg("module") = "plvo");
  module.add_object(name, type);
  return type;
}

}  // namespace plvo::python

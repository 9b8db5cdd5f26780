// SPDX-License-Identifier: Apache-2.0
// A Status that is not ok becomes the exception plvo.Error: its text is the library's, and its attribute
// `code` the name of the code.
#pragma once

#include <pybind11/pybind11.h>

#include <string_view>

#include "plvo/base/status.hpp"

namespace plvo::python {

namespace py = pybind11;

// In the module that has the type.
inline void make_error_type(py::module_& module, const char* docstring) {
  PyObject* type = PyErr_NewExceptionWithDoc("plvo.Error", docstring, PyExc_Exception, nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.add_object("Error", py::reinterpret_steal<py::object>(type));
}

// The library's words. They may quote names of files and topics in no particular encoding: bytes that are not
// UTF-8 are escaped.
inline py::str words(std::string_view text) {
  PyObject* decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "backslashreplace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

inline void throw_unless_ok(const Status& status) {
  if (status.ok()) return;
  const py::object type = py::module_::import("plvo._plvo").attr("Error");
  const py::object error = type(words(status.message()));
  error.attr("code") = to_string(status.code());
  PyErr_SetObject(type.ptr(), error.ptr());
  throw py::error_already_set();
}

}  // namespace plvo::python

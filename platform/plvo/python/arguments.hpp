// SPDX-License-Identifier: Apache-2.0
// Arguments of Python as values of the library. Where a signature says no more than `object`, pybind11 would
// make a RuntimeError of a wrong one; here it is a TypeError or a ValueError that names the argument.
#pragma once

#include <pybind11/pybind11.h>

#include <limits>
#include <optional>
#include <string>
#include <type_traits>

namespace plvo::python {

namespace py = pybind11;

// expected: in words, "a plvo.Config". Value: also a reference to a class of the package.
template <typename Value>
Value argument(const py::handle& given, const std::string& name, const std::string& expected) {
  py::detail::make_caster<Value> caster;
  if (!given.is_none() && caster.load(given, true)) return py::detail::cast_op<Value>(caster);
  const std::string words = name + ": expected " + expected + ", got ";
  if (std::is_integral_v<Value> && PyIndex_Check(given.ptr()) != 0)
    throw py::value_error(words + std::string(py::repr(given)));
  throw py::type_error(words + std::string(py::str(py::type::handle_of(given).attr("__name__"))));
}

template <typename Value>
Value integer(const py::handle& given, const std::string& name) {
  using Range = std::numeric_limits<Value>;
  return argument<Value>(
      given, name, "an int from " + std::to_string(Range::min()) + " to " + std::to_string(Range::max()));
}

template <typename Value>
std::optional<Value> optional_integer(const py::object& given, const std::string& name) {
  return given.is_none() ? std::nullopt : std::optional(integer<Value>(given, name));
}

inline double number(const py::handle& given, const std::string& name) {
  return argument<double>(given, name, "a number");
}

inline std::string text(const py::handle& given, const std::string& name) {
  return argument<std::string>(given, name, "a str");
}

inline std::optional<std::string> optional_text(const py::object& given, const std::string& name) {
  return given.is_none() ? std::nullopt : std::optional(text(given, name));
}

// The bytes that the system knows a str, bytes or os.PathLike by.
inline std::string path_bytes(const py::object& path) {
  const auto bytes = py::module_::import("os").attr("fsencode")(path).cast<std::string>();
  if (bytes.find('\0') != std::string::npos) throw py::value_error("a path cannot hold a null character");
  return bytes;
}

}  // namespace plvo::python

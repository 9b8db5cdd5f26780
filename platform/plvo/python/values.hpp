// SPDX-License-Identifier: Apache-2.0
// Values for Python: classes whose objects are what their members say. Equality, hash and pickling all use
// one state, nested tuples of plain values with every member of the struct (members.hpp).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/members.hpp"

namespace plvo::python {

template <typename>
struct IsArray : std::false_type {};
template <typename Element, std::size_t N>
struct IsArray<std::array<Element, N>> : std::true_type {};
template <typename>
struct IsOptional : std::false_type {};
template <typename Part>
struct IsOptional<std::optional<Part>> : std::true_type {};
template <typename Type>
concept IsMatrix = std::is_base_of_v<Eigen::MatrixBase<Type>, Type>;

inline void refuse_state_unless(bool right) {
  if (!right) throw py::value_error("this is no state of a value of plvo");
}

template <typename Value>
py::object state_of(const Value& value);

// begin … end as a tuple.
template <typename Iterator>
py::tuple state_of_range(Iterator begin, Iterator end) {
  py::tuple state(static_cast<std::size_t>(end - begin));
  for (std::size_t i = 0; begin != end; ++begin) state[i++] = state_of(*begin);
  return state;
}

template <typename Value>
py::object state_of(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>) {
    return py::cast(value);
  } else if constexpr (std::is_enum_v<Value>) {
    return py::cast(static_cast<int>(value));
  } else if constexpr (std::is_pointer_v<Value>) {
    if (value != nullptr) throw py::type_error("a pointer cannot be pickled");
    return py::none();
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return py::bytes(value);
  } else if constexpr (std::is_same_v<Value, Status>) {
    return py::make_tuple(state_of(value.code()), py::bytes(value.message()));
  } else if constexpr (IsOptional<Value>::value) {
    return value ? state_of(*value) : py::none();
  } else if constexpr (IsMatrix<Value>) {
    return state_of_range(value.data(), value.data() + value.size());
  } else if constexpr (IsArray<Value>::value) {
    return state_of_range(value.begin(), value.end());
  } else {
    return std::apply([](const auto&... member) { return py::make_tuple(state_of(member)...); },
                      members(value));
  }
}

template <typename Value>
void restore(const py::handle& state, Value& value);

template <typename Iterator>
void restore_range(const py::handle& state, Iterator begin, Iterator end) {
  const auto elements = argument<py::tuple>(state, "state", "a tuple");
  refuse_state_unless(elements.size() == static_cast<std::size_t>(end - begin));
  for (std::size_t i = 0; begin != end; ++begin) restore(elements[i++], *begin);
}

// The inverse of state_of.
template <typename Value>
void restore(const py::handle& state, Value& value) {
  if constexpr (std::is_arithmetic_v<Value>) {
    value = argument<Value>(state, "state", "a number");
  } else if constexpr (std::is_enum_v<Value>) {
    value = static_cast<Value>(integer<std::underlying_type_t<Value>>(state, "state"));
  } else if constexpr (std::is_pointer_v<Value>) {
    refuse_state_unless(state.is_none());
    value = nullptr;
  } else if constexpr (std::is_same_v<Value, std::string>) {
    value = std::string(argument<py::bytes>(state, "state", "bytes"));
  } else if constexpr (std::is_same_v<Value, Status>) {
    std::pair<StatusCode, std::string> parts;
    const auto elements = argument<py::tuple>(state, "state", "a tuple");
    refuse_state_unless(elements.size() == 2);
    restore(elements[0], parts.first);
    restore(elements[1], parts.second);
    value = Status(parts.first, parts.second);
  } else if constexpr (IsOptional<Value>::value) {
    value.reset();
    if (!state.is_none()) restore(state, value.emplace());
  } else if constexpr (IsMatrix<Value>) {
    restore_range(state, value.data(), value.data() + value.size());
  } else if constexpr (IsArray<Value>::value) {
    restore_range(state, value.begin(), value.end());
  } else {
    const auto elements = argument<py::tuple>(state, "state", "a tuple");
    std::apply(
        [&](auto&... member) {
          refuse_state_unless(elements.size() == sizeof...(member));
          std::size_t i = 0;
          (restore(elements[i++], member), ...);
        },
        members(value));
  }
}

// A class of the package whose objects are values. They cannot be changed, so that they have a hash. A
// pickled one is read by the version that wrote it.
template <typename Value>
Documented<Value> bind_value(py::module_& module, const char* name) {
  Documented<Value> type = bind_class<Value>(module, name);
  type.def("__eq__",
           [](const Value& value, const py::object& other) -> py::object {
             if (!py::isinstance<Value>(other)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
             return py::bool_(
                 state_of(value).equal(state_of(argument<const Value&>(other, "other", "a value"))));
           })
      .def("__hash__", [](const Value& value) { return py::hash(state_of(value)); })
      .def(py::pickle([](const Value& value) { return py::make_tuple(PLVO_VERSION, state_of(value)); },
                      [](const py::tuple& pickled) {
                        refuse_state_unless(pickled.size() == 2);
                        if (const std::string version = text(pickled[0], "version"); version != PLVO_VERSION)
                          throw py::value_error("this was pickled by plvo " + version + "; this is plvo " +
                                                PLVO_VERSION);
                        Value value;
                        restore(pickled[1], value);
                        return value;
                      }));
  return type;
}

// A __repr__ that shows these properties: "<plvo.Counts detected=3 dropped=0>".
inline auto shown_by(std::vector<std::string> properties) {
  return [names = std::move(properties)](const py::object& self) {
    std::string text = "<plvo." + std::string(py::str(py::type::of(self).attr("__name__")));
    for (const std::string& name : names)
      text += " " + name + "=" + std::string(py::repr(self.attr(name.c_str())));
    return text + ">";
  };
}

}  // namespace plvo::python

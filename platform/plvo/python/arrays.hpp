// SPDX-License-Identifier: Apache-2.0
// NumPy arrays as the library's views, and the library's memory as NumPy arrays. Images and views are not
// copied; matrices that are taken, and those of copy_of, are.
#pragma once

#include <pybind11/numpy.h>

#include <span>
#include <string>
#include <vector>

#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::python {

namespace py = pybind11;

// A read-only array over memory that lives as long as `owner`.
inline py::array view(const py::dtype& type, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                      const void* data, py::handle owner) {
  py::array array(type, std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

template <int Rows, int Columns>
py::array matrix_view(const Matrix<Rows, Columns>& matrix, py::handle owner) {
  const py::ssize_t step = sizeof(double);
  if constexpr (Columns == 1) return view(py::dtype::of<double>(), {Rows}, {step}, matrix.data(), owner);
  return view(py::dtype::of<double>(), {Rows, Columns}, {step, step * Rows}, matrix.data(), owner);
}

// A column becomes one-dimensional.
template <int Rows, int Columns>
py::array copy_of(const Matrix<Rows, Columns>& matrix) {
  std::vector<py::ssize_t> shape{Rows};
  if (Columns > 1) shape.push_back(Columns);
  py::array_t<double> array(shape);
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column)
      array.mutable_data()[row * Columns + column] = matrix(row, column);
  return array;
}

// One row for each of `structs`: `columns` neighbouring members of a type, from `first` on; 0: an array
// without columns.
template <typename Member, typename Struct>
py::array members_view(std::span<const Struct> structs, Member Struct::*first, py::ssize_t columns,
                       py::handle owner) {
  const auto rows = static_cast<py::ssize_t>(structs.size());
  const void* data = structs.empty() ? nullptr : &(structs.data()->*first);
  const py::ssize_t row_step = sizeof(Struct), step = sizeof(Member);
  if (columns == 0) return view(py::dtype::of<Member>(), {rows}, {row_step}, data, owner);
  return view(py::dtype::of<Member>(), {rows, columns}, {row_step, step}, data, owner);
}

// Copies anything that NumPy makes an array of doubles of; a column may be one-dimensional.
template <int Rows, int Columns>
Matrix<Rows, Columns> matrix_of(const py::handle& object, const std::string& name) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(name + ": expected an array of numbers");
  }
  const bool column = Columns == 1 && array.ndim() == 1 && array.shape(0) == Rows;
  if (!column && !(array.ndim() == 2 && array.shape(0) == Rows && array.shape(1) == Columns))
    throw py::value_error(name + ": expected the shape (" + std::to_string(Rows) +
                          (Columns == 1 ? "" : ", " + std::to_string(Columns)) + ")");
  Matrix<Rows, Columns> matrix;
  for (int r = 0; r < Rows; ++r)
    for (int c = 0; c < Columns; ++c) matrix(r, c) = array.data()[r * Columns + c];
  return matrix;
}

inline void refuse_array(const std::string& name, const char* why) {
  throw py::value_error(name + ": " + why);
}

// Converts a 4×4 matrix.
inline Se3 se3_of(const py::handle& object, const std::string& name) {
  const Matrix4 T = matrix_of<4, 4>(object, name);
  if (T.row(3) != Vector4(0, 0, 0, 1).transpose()) refuse_array(name, "the last row must be 0 0 0 1");
  return {T.block<3, 3>(0, 0), T.block<3, 1>(0, 3)};
}

inline py::array matrix_4x4(const Se3& T) {
  Matrix4 matrix = Matrix4::Identity();
  matrix.block<3, 3>(0, 0) = T.R;
  matrix.block<3, 1>(0, 3) = T.t;
  return copy_of(matrix);
}

// Checks that the pixels of a row are contiguous; rows may be any distance apart.
inline void check_rows(const py::array& array, const std::string& name, py::ssize_t pixel_bytes) {
  constexpr py::ssize_t kMostPixels = py::ssize_t{1} << 20;
  if (array.shape(0) < 1 || array.shape(1) < 1 || array.shape(0) > kMostPixels ||
      array.shape(1) > kMostPixels)
    refuse_array(name, "an image has at least one pixel and at most 2^20 a side");
  const bool packed = array.strides(1) == pixel_bytes && (array.ndim() == 2 || array.strides(2) == 1);
  if (!packed || array.strides(0) < pixel_bytes * array.shape(1))
    refuse_array(name, "the pixels of a row must be contiguous; pass numpy.ascontiguousarray(…)");
}

inline ColourView colour_view(const py::array& array, bool bgr) {
  if (!array.dtype().equal(py::dtype::of<std::uint8_t>()))
    throw py::type_error("colour: expected an array of uint8, got " + std::string(py::str(array.dtype())));
  const bool grey = array.ndim() == 2;
  if (!grey && !(array.ndim() == 3 && array.shape(2) == 3))
    refuse_array("colour", "expected (height, width) or (height, width, 3)");
  check_rows(array, "colour", grey ? 1 : 3);
  return {static_cast<const std::uint8_t*>(array.data()), static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)), array.strides(0),
          grey ? PixelFormat::kGray8 : (bgr ? PixelFormat::kBgr8 : PixelFormat::kRgb8)};
}

inline DepthView depth_view(const py::array& array, double metres_per_unit) {
  if (!array.dtype().equal(py::dtype::of<std::uint16_t>()))
    throw py::type_error(
        "depth: expected an array of uint16 (see depth_units_per_metre of the camera), got " +
        std::string(py::str(array.dtype())));
  if (array.ndim() != 2) refuse_array("depth", "expected (height, width)");
  constexpr py::ssize_t kBytes = sizeof(std::uint16_t);
  check_rows(array, "depth", kBytes);
  if (array.strides(0) % kBytes != 0 || reinterpret_cast<std::uintptr_t>(array.data()) % kBytes != 0)
    refuse_array("depth", "pixels must lie at even addresses; pass a copy");
  return {static_cast<const std::uint16_t*>(array.data()), static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)), array.strides(0) / kBytes, metres_per_unit};
}

}  // namespace plvo::python

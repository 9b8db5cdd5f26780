// SPDX-License-Identifier: Apache-2.0
// Cameras for Python: a Calibration, which is a camera model and the unit of depth.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "plvo/camera/camera_info.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/values.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

Calibration make_camera(int width, int height, double fx, double fy, double cx, double cy,
                        const py::iterable& distortion, double depth_units_per_metre, double readout_s,
                        const py::object& depth_delay_s, double depth_readout_s,
                        const std::string& distortion_model, double stamp_sigma_s) {
  Calibration camera;
  camera.camera.width = width;
  camera.camera.height = height;
  camera.has_size = camera.depth_scale_given = camera.readout_given = true;
  camera.camera.pinhole = {fx, fy, cx, cy};
  std::vector<double> coefficients;
  for (const py::handle& item : distortion) coefficients.push_back(number(item, "distortion"));
  if (const Status status = distortion_of(distortion_model, coefficients, camera.camera.distortion);
      !status.ok())
    throw py::value_error(status.message());
  camera.depth_units_per_metre = depth_units_per_metre;
  camera.camera.readout_s = readout_s;
  camera.camera.stamp_sigma_s = stamp_sigma_s;
  if (!depth_delay_s.is_none())
    camera.camera.depth_timing = {true, number(depth_delay_s, "depth_delay_s"), depth_readout_s};
  throw_unless_ok(camera.validate(width, height));
  return camera;
}

Calibration builtin_camera(const std::string& name) {
  Calibration camera;
  throw_unless_ok(builtin_calibration(name, camera));
  return camera;
}

Calibration read_camera(const py::object& path) {
  Calibration camera;
  throw_unless_ok(read_calibration(path_bytes(path), camera));
  return camera;
}

py::array intrinsic_matrix(const Calibration& c) {
  const Pinhole& p = c.camera.pinhole;
  Matrix3 K;
  K << p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1;
  return copy_of(K);
}

std::string describe_camera(const Calibration& c) {
  const Pinhole& p = c.camera.pinhole;
  const std::string size = c.has_size ? fmt::format("{}x{}, ", c.camera.width, c.camera.height) : "";
  return fmt::format("<plvo.Camera {}fx={:g} fy={:g} cx={:g} cy={:g}, {}, {:g} units of depth per metre>",
                     size, p.fx, p.fy, p.cx, p.cy,
                     c.camera.distortion.is_zero() ? "no distortion" : lens_model_name(c.camera.distortion),
                     c.depth_units_per_metre);
}

}  // namespace

void bind_camera(py::module_& module) {
  const CameraModel model;
  bind_value<Calibration>(module, "Camera")
      .def(py::init(&make_camera), "width"_a, "height"_a, "fx"_a, "fy"_a, "cx"_a, "cy"_a,
           "distortion"_a = py::tuple(), "depth_units_per_metre"_a = 1000.0, "readout_s"_a = model.readout_s,
           "depth_delay_s"_a = py::none(), "depth_readout_s"_a = model.depth_timing.readout_s,
           "distortion_model"_a = "", "stamp_sigma_s"_a = model.stamp_sigma_s)
      .def_static("builtin", &builtin_camera, "name"_a)
      .def_static("read", &read_camera, "path"_a)
      .def_property_readonly("width", [](const Calibration& c) { return c.camera.width; })
      .def_property_readonly("height", [](const Calibration& c) { return c.camera.height; })
      .def_property_readonly("fx", [](const Calibration& c) { return c.camera.pinhole.fx; })
      .def_property_readonly("fy", [](const Calibration& c) { return c.camera.pinhole.fy; })
      .def_property_readonly("cx", [](const Calibration& c) { return c.camera.pinhole.cx; })
      .def_property_readonly("cy", [](const Calibration& c) { return c.camera.pinhole.cy; })
      .def_property_readonly("K", &intrinsic_matrix)
      .def("__repr__", &describe_camera)
      .def_property_readonly("distortion",
                             [](const Calibration& c) {
                               const Distortion& lens = c.camera.distortion;
                               if (lens.model == LensModel::kEquidistant)
                                 return py::make_tuple(lens.k1, lens.k2, lens.k3, lens.k4);
                               if (lens.is_plumb_bob())
                                 return py::make_tuple(lens.k1, lens.k2, lens.p1, lens.p2, lens.k3);
                               return py::make_tuple(lens.k1, lens.k2, lens.p1, lens.p2, lens.k3, lens.k4,
                                                     lens.k5, lens.k6);
                             })
      .def_property_readonly("distortion_model",
                             [](const Calibration& c) { return lens_model_name(c.camera.distortion); })
      .def_property_readonly("readout_s", [](const Calibration& c) { return c.camera.readout_s; })
      .def_property_readonly("depth_delay_s",
                             [](const Calibration& c) -> py::object {
                               const DepthTiming& timing = c.camera.depth_timing;
                               return timing.known ? py::object(py::float_(timing.delay_s)) : py::none();
                             })
      .def_property_readonly("depth_readout_s",
                             [](const Calibration& c) { return c.camera.depth_timing.readout_s; })
      .def_property_readonly("stamp_sigma_s", [](const Calibration& c) { return c.camera.stamp_sigma_s; })
      .def_readonly("depth_units_per_metre", &Calibration::depth_units_per_metre);
}

}  // namespace plvo::python

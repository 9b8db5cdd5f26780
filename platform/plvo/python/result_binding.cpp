// SPDX-License-Identifier: Apache-2.0
// Results for Python.
#include <string>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/odometry/track_result.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"

namespace plvo::python {

namespace {

py::array quaternion(const Se3& T) {
  const Quaternion q = to_quaternion(T.R);
  const double values[] = {q.x, q.y, q.z, q.w};
  return py::array_t<double>(4, values);
}

std::string describe(const TrackResult& result) {
  std::string text = std::string("<plvo.Result ") + to_string(result.state) + " at " +
                     std::to_string(result.stamp_ns) + " ns";
  if (const std::string message = result.status.message(); !message.empty()) text += ": " + message;
  return text + ">";
}

py::tuple values_of(const FeatureCounts& c) {
  return py::make_tuple(c.detected, c.dropped, c.with_depth, c.matched, c.inliers);
}

std::string describe_counts(const FeatureCounts& c) {
  return "<plvo.Counts detected=" + std::to_string(c.detected) + " dropped=" + std::to_string(c.dropped) +
         " with_depth=" + std::to_string(c.with_depth) + " matched=" + std::to_string(c.matched) +
         " inliers=" + std::to_string(c.inliers) + ">";
}

const TrackResult& result_of(const py::object& self) {
  return argument<const TrackResult&>(self, "self", "a plvo.Result");
}

}  // namespace

void bind_result(py::module_& module) {
  bind_class<FeatureCounts>(module, "Counts")
      .def_readonly("detected", &FeatureCounts::detected)
      .def_readonly("dropped", &FeatureCounts::dropped)
      .def_readonly("with_depth", &FeatureCounts::with_depth)
      .def_readonly("matched", &FeatureCounts::matched)
      .def_readonly("inliers", &FeatureCounts::inliers)
      .def("__repr__", &describe_counts)
      .def("__eq__",
           [](const FeatureCounts& counts, const py::object& other) -> py::object {
             if (!py::isinstance<FeatureCounts>(other))
               return py::reinterpret_borrow<py::object>(Py_NotImplemented);
             const auto& o = argument<const FeatureCounts&>(other, "other", "a plvo.Counts");
             return py::bool_(values_of(counts).equal(values_of(o)));
           })
      .def("__hash__", [](const FeatureCounts& counts) { return py::hash(values_of(counts)); })
      .def(py::pickle(&values_of, [](const py::tuple& values) {
        if (values.size() != 5) throw py::value_error("these are no counts of plvo");
        FeatureCounts counts;
        int* const members[] = {&counts.detected, &counts.dropped, &counts.with_depth, &counts.matched,
                                &counts.inliers};
        for (std::size_t i = 0; i < 5; ++i) *members[i] = values[i].cast<int>();
        return counts;
      }));

  const auto covariance = [](Matrix6 TrackResult::*member) {
    return py::cpp_function(
        [member](const py::object& self) { return matrix_view<6, 6>(result_of(self).*member, self); });
  };
  bind_class<TrackResult>(module, "Result")
      .def_property_readonly("state", [](const TrackResult& r) { return to_string(r.state); })
      .def_property_readonly("has_pose", &has_pose)
      .def_property_readonly("code", [](const TrackResult& r) { return to_string(r.status.code()); })
      .def_property_readonly("message", [](const TrackResult& r) { return r.status.message(); })
      .def_readonly("stamp_ns", &TrackResult::stamp_ns)
      .def_property_readonly("stamp",
                             [](const TrackResult& r) { return static_cast<double>(r.stamp_ns) * 1e-9; })
      .def_readonly("reference_stamp_ns", &TrackResult::reference_stamp_ns)
      .def_property_readonly("T_world_camera",
                             [](const TrackResult& r) { return matrix_4x4(r.T_world_camera); })
      .def_property_readonly("T_camera_reference",
                             [](const TrackResult& r) { return matrix_4x4(r.T_camera_reference); })
      .def_property_readonly(
          "position",
          [](const py::object& self) { return matrix_view<3, 1>(result_of(self).T_world_camera.t, self); })
      .def_property_readonly("quaternion", [](const TrackResult& r) { return quaternion(r.T_world_camera); })
      .def_property_readonly("covariance", covariance(&TrackResult::pose_covariance))
      .def_property_readonly("motion_covariance", covariance(&TrackResult::motion_covariance))
      .def_readonly("points", &TrackResult::points)
      .def_readonly("lines", &TrackResult::lines)
      .def_readonly("ransac_iterations", &TrackResult::ransac_iterations)
      .def_readonly("lm_iterations", &TrackResult::lm_iterations)
      .def_readonly("mean_brightness", &TrackResult::mean_brightness)
      .def_readonly("returned", &TrackResult::returned)
      .def_readonly("repeated", &TrackResult::repeated)
      .def_readonly("feature_step", &TrackResult::feature_step)
      .def("__repr__", &describe);
}

}  // namespace plvo::python

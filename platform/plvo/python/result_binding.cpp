// SPDX-License-Identifier: Apache-2.0
// Results for Python.
#include <string>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/odometry/track_result.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/values.hpp"

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

const TrackResult& result_of(const py::object& self) {
  return argument<const TrackResult&>(self, "self", "a plvo.Result");
}

}  // namespace

void bind_result(py::module_& module) {
  bind_value<FeatureCounts>(module, "Counts")
      .def_readonly("detected", &FeatureCounts::detected)
      .def_readonly("dropped", &FeatureCounts::dropped)
      .def_readonly("with_depth", &FeatureCounts::with_depth)
      .def_readonly("matched", &FeatureCounts::matched)
      .def_readonly("inliers", &FeatureCounts::inliers)
      .def("__repr__", shown_by({"detected", "dropped", "with_depth", "matched", "inliers"}));

  const auto covariance = [](Matrix6 TrackResult::*member) {
    return py::cpp_function(
        [member](const py::object& self) { return matrix_view<6, 6>(result_of(self).*member, self); });
  };
  bind_value<TrackResult>(module, "Result")
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
      .def_readonly("relocalised", &TrackResult::relocalised)
      .def_readonly("repeated", &TrackResult::repeated)
      .def_readonly("world", &TrackResult::world)
      .def_readonly("restarted", &TrackResult::restarted)
      .def_readonly("disagreement", &TrackResult::disagreement)
      .def_readonly("feature_step", &TrackResult::feature_step)
      .def("__repr__", &describe);
}

}  // namespace plvo::python

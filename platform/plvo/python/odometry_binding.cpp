// SPDX-License-Identifier: Apache-2.0
// plvo.Odometry and the features that it shows.
#include <memory>

#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/tracker.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

py::object features_of(const py::object& self, const py::object& type) {
  const FeatureView v = argument<Tracker&>(self, "self", "a plvo.Odometry").features();
  const auto two_pixels = [&](std::span<const SegmentView> segments) {
    return members_view(segments, &SegmentView::a_u, 4, self);
  };
  return type(view(py::dtype::of<std::uint8_t>(), {v.image.height, v.image.width}, {v.image.stride, 1},
                   v.image.data, self),
              members_view(v.keypoints, &Keypoint::u, 2, self), two_pixels(v.segments),
              members_view(v.segments, &SegmentView::has_3d, 0, self), two_pixels(v.reference_segments),
              members_view(v.point_tracks, &PointTrackView::u_reference, 4, self),
              members_view(v.point_tracks, &PointTrackView::inlier, 0, self),
              members_view(v.line_tracks, &LineTrackView::reference, 2, self),
              members_view(v.line_tracks, &LineTrackView::inlier, 0, self));
}

}  // namespace

void bind_odometry(py::module_& module) {
  const py::object features = namedtuple(module, "Features",
                                         "image keypoints segments segment_has_3d reference_segments "
                                         "point_tracks point_inliers line_tracks line_inliers");
  bind_class<Tracker>(module, "Odometry")
      .def(py::init([](const Calibration& camera, const py::object& config, const py::object& keypoints,
                       const py::object& segments, const py::object& references, const py::object& line_bands,
                       const py::object& kept_keyframes, const py::object& surfaces, int cores,
                       const py::object& mask) {
             return std::make_unique<Tracker>(
                 camera,
                 config.is_none() ? Settings() : argument<const Settings&>(config, "config", "a plvo.Config"),
                 OwnLimits{keypoints, segments, references, line_bands, kept_keyframes, surfaces}, cores,
                 mask);
           }),
           "camera"_a, "config"_a = py::none(), py::kw_only(), "keypoints"_a = py::none(),
           "segments"_a = py::none(), "references"_a = py::none(), "line_bands"_a = py::none(),
           "kept_keyframes"_a = py::none(), "surfaces"_a = py::none(), "cores"_a = Limits().cores,
           "mask"_a = py::none())
      .def(
          "track",
          [](Tracker& tracker, const py::array& colour, const py::array& depth, std::int64_t stamp_ns,
             const py::object& depth_stamp_ns, bool bgr, const py::object& prior) {
            return tracker.track(colour, depth, stamp_ns,
                                 optional_integer<std::int64_t>(depth_stamp_ns, "depth_stamp_ns"), bgr,
                                 prior.is_none()
                                     ? MotionPrior()
                                     : argument<const MotionPrior&>(prior, "prior", "a plvo.MotionPrior"));
          },
          "colour"_a, "depth"_a, "stamp_ns"_a, "depth_stamp_ns"_a = py::none(), py::kw_only(),
          "bgr"_a = false, "prior"_a = py::none())
      .def("frame_took", &Tracker::frame_took, "ns"_a)
      .def("reset", &Tracker::reset)
      .def("set_pose", &Tracker::set_pose, "T_world_camera"_a, "covariance"_a = py::none())
      .def("features", [features](const py::object& self) { return features_of(self, features); })
      .def_property_readonly("memory_bytes", &Tracker::memory_bytes);
}

}  // namespace plvo::python

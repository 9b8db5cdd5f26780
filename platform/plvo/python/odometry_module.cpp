// SPDX-License-Identifier: Apache-2.0
// plvo._plvo: cameras, recorded sequences and the odometry for Python. What a user sees is described in
// plvo/__init__.pyi and docs/python.md.
#include <pybind11/pybind11.h>

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/host/trajectory_file.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/error.hpp"
#include "plvo/replay/sequence_calibration.hpp"
#include "plvo/replay/tum_camera.hpp"

namespace plvo::python {
namespace {

using namespace py::literals;

// ---- Cameras: a Calibration, which is a camera model and the unit of depth.

Calibration make_camera(int width, int height, double fx, double fy, double cx, double cy,
                        const py::sequence& distortion, double depth_units_per_metre, double readout_s,
                        const py::object& depth_delay_s, double depth_readout_s) {
  Calibration camera;
  camera.camera.width = width;
  camera.camera.height = height;
  camera.has_size = camera.depth_scale_given = camera.readout_given = true;
  camera.camera.pinhole = {fx, fy, cx, cy};
  if (distortion.size() != 0 && distortion.size() != 4 && distortion.size() != 5)
    throw py::value_error("distortion: expected k1 k2 p1 p2 or k1 k2 p1 p2 k3 (plumb_bob)");
  Distortion& lens = camera.camera.distortion;
  double* const entries[] = {&lens.k1, &lens.k2, &lens.p1, &lens.p2, &lens.k3};
  for (std::size_t i = 0; i < distortion.size(); ++i) *entries[i] = distortion[i].cast<double>();
  camera.depth_units_per_metre = depth_units_per_metre;
  camera.camera.readout_s = readout_s;
  if (!depth_delay_s.is_none())
    camera.camera.depth_timing = {true, depth_delay_s.cast<double>(), depth_readout_s};
  throw_unless_ok(camera.validate(width, height));
  return camera;
}

std::string path_text(const py::object& path) {
  return py::module_::import("os").attr("fsdecode")(path).cast<std::string>();
}

Calibration builtin_camera(const std::string& name) {
  Calibration camera;
  throw_unless_ok(builtin_calibration(name, camera));
  return camera;
}

Calibration read_camera(const py::object& path) {
  Calibration camera;
  throw_unless_ok(read_calibration(path_text(path), camera));
  return camera;
}

void bind_camera(py::module_& module) {
  const CameraModel model;
  py::class_<Calibration>(module, "Camera")
      .def(py::init(&make_camera), "width"_a, "height"_a, "fx"_a, "fy"_a, "cx"_a, "cy"_a,
           "distortion"_a = py::tuple(), "depth_units_per_metre"_a = 1000.0, "readout_s"_a = model.readout_s,
           "depth_delay_s"_a = py::none(), "depth_readout_s"_a = model.depth_timing.readout_s)
      .def_static("builtin", &builtin_camera, "name"_a)
      .def_static("read", &read_camera, "path"_a)
      .def_property_readonly("width", [](const Calibration& c) { return c.camera.width; })
      .def_property_readonly("height", [](const Calibration& c) { return c.camera.height; })
      .def_property_readonly("fx", [](const Calibration& c) { return c.camera.pinhole.fx; })
      .def_property_readonly("fy", [](const Calibration& c) { return c.camera.pinhole.fy; })
      .def_property_readonly("cx", [](const Calibration& c) { return c.camera.pinhole.cx; })
      .def_property_readonly("cy", [](const Calibration& c) { return c.camera.pinhole.cy; })
      .def_property_readonly("distortion",
                             [](const Calibration& c) {
                               const Distortion& lens = c.camera.distortion;
                               return py::make_tuple(lens.k1, lens.k2, lens.p1, lens.p2, lens.k3);
                             })
      .def_property_readonly("readout_s", [](const Calibration& c) { return c.camera.readout_s; })
      .def_readonly("depth_units_per_metre", &Calibration::depth_units_per_metre);
}

// ---- Config

template <typename Value>
struct Choice {
  const char* name;
  Value value;
};

template <typename Value, std::size_t N>
Value choose(const char* what, const std::string& text, const Choice<Value> (&choices)[N]) {
  std::string names;
  for (const Choice<Value>& choice : choices) {
    if (text == choice.name) return choice.value;
    names += (names.empty() ? "" : ", ") + std::string(choice.name);
  }
  throw py::value_error(std::string(what) + ": expected one of " + names + ", got '" + text + "'");
}

Config make_config(const std::string& preset, const std::optional<std::string>& features,
                   const std::optional<std::string>& reference, const std::optional<std::uint64_t>& seed) {
  constexpr Choice<bool> kPresets[] = {{"default", false}, {"paper", true}};
  constexpr Choice<Features> kFeatures[] = {
      {"points", Features::kPoints}, {"lines", Features::kLines}, {"both", Features::kBoth}};
  constexpr Choice<ReferencePolicy> kReferences[] = {{"previous", ReferencePolicy::kPreviousFrame},
                                                     {"keyframe", ReferencePolicy::kKeyframe},
                                                     {"both", ReferencePolicy::kKeyframeAndPrevious}};
  Config config = choose("preset", preset, kPresets) ? Config::paper() : Config();
  if (features) config.features = choose("features", *features, kFeatures);
  if (reference) config.references.policy = choose("reference", *reference, kReferences);
  if (seed) config.seed = *seed;
  return config;
}

template <typename Value>
std::optional<Value> optional(const py::object& object) {
  return object.is_none() ? std::nullopt : std::optional<Value>(object.cast<Value>());
}

void bind_config(py::module_& module) {
  py::class_<Config>(module, "Config")
      .def(py::init([](const std::string& preset, const py::object& features, const py::object& reference,
                       const py::object& seed) {
             return make_config(preset, optional<std::string>(features), optional<std::string>(reference),
                                optional<std::uint64_t>(seed));
           }),
           py::kw_only(), "preset"_a = "default", "features"_a = py::none(), "reference"_a = py::none(),
           "seed"_a = py::none())
      .def_readonly("seed", &Config::seed);
}

// ---- Results

py::array matrix_4x4(const Se3& T) {
  py::array_t<double> array({4, 4});
  auto out = array.mutable_unchecked<2>();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      out(row, column) = row == 3 ? (column == 3 ? 1.0 : 0.0) : column == 3 ? T.t(row) : T.R(row, column);
  return array;
}

py::array quaternion(const Se3& T) {
  const Quaternion q = to_quaternion(T.R);
  const double values[] = {q.x, q.y, q.z, q.w};
  return py::array_t<double>(4, values);
}

std::string describe(const TrackResult& result) {
  std::string text = std::string("<plvo.Result ") + to_string(result.state) + " at " +
                     std::to_string(result.stamp_ns) + " ns";
  if (!result.status.ok()) text += std::string(": ") + result.status.message();
  return text + ">";
}

void bind_result(py::module_& module) {
  py::class_<FeatureCounts>(module, "Counts")
      .def_readonly("detected", &FeatureCounts::detected)
      .def_readonly("dropped", &FeatureCounts::dropped)
      .def_readonly("with_depth", &FeatureCounts::with_depth)
      .def_readonly("matched", &FeatureCounts::matched)
      .def_readonly("inliers", &FeatureCounts::inliers);

  const auto covariance = [](Matrix6 TrackResult::*member) {
    return py::cpp_function([member](const py::object& self) {
      return matrix_view<6, 6>(self.cast<const TrackResult&>().*member, self);
    });
  };
  py::class_<TrackResult>(module, "Result")
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
      .def_property_readonly("position",
                             [](const py::object& self) {
                               return matrix_view<3, 1>(self.cast<const TrackResult&>().T_world_camera.t,
                                                        self);
                             })
      .def_property_readonly("quaternion", [](const TrackResult& r) { return quaternion(r.T_world_camera); })
      .def_property_readonly("covariance", covariance(&TrackResult::pose_covariance))
      .def_property_readonly("motion_covariance", covariance(&TrackResult::motion_covariance))
      .def_readonly("points", &TrackResult::points)
      .def_readonly("lines", &TrackResult::lines)
      .def_readonly("ransac_iterations", &TrackResult::ransac_iterations)
      .def_readonly("lm_iterations", &TrackResult::lm_iterations)
      .def_readonly("mean_brightness", &TrackResult::mean_brightness)
      .def("__repr__", &describe);
}

// ---- The odometry

class Tracker {
 public:
  Tracker(const Calibration& camera, const Config& config, const std::optional<int>& keypoints,
          const std::optional<int>& segments)
      : metres_per_unit_(1.0 / camera.depth_units_per_metre) {
    Limits limits;
    limits.width = camera.camera.width;
    limits.height = camera.camera.height;
    limits.keypoints = keypoints.value_or(limits.keypoints);
    limits.segments = segments.value_or(limits.segments);
    throw_unless_ok(limits.validate());
    memory_.resize(required_bytes(limits));
    throw_unless_ok(odometry_.init(memory_, camera.camera, config, limits));
  }

  TrackResult track(const py::array& colour, const py::array& depth, std::int64_t stamp_ns,
                    const std::optional<std::int64_t>& depth_stamp_ns, bool bgr) {
    const RgbdFrame frame{stamp_ns, depth_stamp_ns.value_or(stamp_ns), colour_view(colour, bgr),
                          depth_view(depth, metres_per_unit_)};
    if (busy_.test_and_set())
      throw std::runtime_error(
          "this Odometry is tracking a frame in another thread; give each thread its own");
    TrackResult result;
    {
      const py::gil_scoped_release others_may_run;
      result = odometry_.track(frame);
    }
    busy_.clear();
    if (result.status.code() == StatusCode::kInvalidArgument) throw_unless_ok(result.status);
    return result;
  }

  FeatureView features() {
    if (busy_.test_and_set()) throw std::runtime_error("this Odometry is tracking a frame in another thread");
    busy_.clear();
    return odometry_.features();
  }
  std::size_t memory_bytes() const { return memory_.size(); }

 private:
  std::vector<std::byte> memory_;
  Odometry odometry_;
  double metres_per_unit_;
  std::atomic_flag busy_;
};

py::object namedtuple(py::module_& module, const char* name, const char* fields) {
  py::object type = py::module_::import("collections").attr("namedtuple")(name, fields, "module"_a = "plvo");
  module.add_object(name, type);
  return type;
}

py::object features_of(const py::object& self, const py::object& type) {
  const FeatureView v = self.cast<Tracker&>().features();
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

void bind_odometry(py::module_& module) {
  const py::object features = namedtuple(module, "Features",
                                         "image keypoints segments segment_has_3d reference_segments "
                                         "point_tracks point_inliers line_tracks line_inliers");
  py::class_<Tracker>(module, "Odometry")
      .def(py::init([](const Calibration& camera, const py::object& config, const py::object& keypoints,
                       const py::object& segments) {
             return std::make_unique<Tracker>(camera, config.is_none() ? Config() : config.cast<Config>(),
                                              optional<int>(keypoints), optional<int>(segments));
           }),
           "camera"_a, "config"_a = py::none(), py::kw_only(), "keypoints"_a = py::none(),
           "segments"_a = py::none())
      .def(
          "track",
          [](Tracker& tracker, const py::array& colour, const py::array& depth, std::int64_t stamp_ns,
             const py::object& depth_stamp_ns, bool bgr) {
            return tracker.track(colour, depth, stamp_ns, optional<std::int64_t>(depth_stamp_ns), bgr);
          },
          "colour"_a, "depth"_a, "stamp_ns"_a, "depth_stamp_ns"_a = py::none(), py::kw_only(),
          "bgr"_a = false)
      .def("features", [features](const py::object& self) { return features_of(self, features); })
      .def_property_readonly("memory_bytes", &Tracker::memory_bytes);
}

// ---- Recorded sequences

void warn(const std::string& text) {
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

Calibration calibration_for(const std::filesystem::path& folder, const py::object& camera) {
  Calibration found;
  std::string guess;
  if (camera.is_none()) {
    throw_unless_ok(sequence_calibration(folder, found, guess));
  } else if (py::isinstance<Calibration>(camera)) {
    return camera.cast<Calibration>();
  } else {
    const std::string name = path_text(camera);
    for (std::string_view builtin : builtin_calibration_names())
      if (name == builtin) return builtin_camera(name);
    throw_unless_ok(read_calibration(name, found));
  }
  if (!guess.empty()) warn(guess);
  for (const std::string& sentence : found.assumptions()) warn(sentence);
  return found;
}

class Sequence {
 public:
  Sequence(const py::object& path, const py::object& camera) {
    const std::filesystem::path folder = path_text(path);
    // A folder that is no sequence should be told so before a missing calibration is.
    TumIndex index;
    throw_unless_ok(read_tum_index(folder, {}, TumOptions().tolerance_ns, index));
    calibration_ = calibration_for(folder, camera);
    throw_unless_ok(camera_.open(folder, calibration_));
    calibration_.camera = camera_.model();
    calibration_.has_size = true;
  }

  // False at the end. Damaged pairs of images are warned of, and left out.
  bool next(RgbdFrame& frame) {
    for (;;) {
      Status status;
      {
        const py::gil_scoped_release others_may_run;
        status = camera_.next(frame);
      }
      if (status.ok()) return true;
      if (status.code() == StatusCode::kEndOfStream) return false;
      if (status.code() != StatusCode::kDamaged) throw_unless_ok(status);
      warn(status.message());
    }
  }
  const Calibration& calibration() const { return calibration_; }
  std::size_t length() const { return camera_.frame_count(); }

 private:
  Calibration calibration_;
  TumCamera camera_;
};

void bind_sequence(py::module_& module) {
  const py::object frame_type = namedtuple(module, "Frame", "colour depth stamp_ns depth_stamp_ns");
  py::class_<Sequence>(module, "Sequence")
      .def(py::init<const py::object&, const py::object&>(), "folder"_a, "camera"_a = py::none())
      .def_property_readonly("camera", &Sequence::calibration)
      .def("__len__", &Sequence::length)
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [frame_type](const py::object& self) {
        RgbdFrame frame;
        if (!self.cast<Sequence&>().next(frame)) throw py::stop_iteration();
        const ColourView& colour = frame.colour;
        const DepthView& depth = frame.depth;
        return frame_type(view(py::dtype::of<std::uint8_t>(), {colour.height, colour.width, 3},
                               {colour.stride_bytes, 3, 1}, colour.data, self),
                          view(py::dtype::of<std::uint16_t>(), {depth.height, depth.width},
                               {2 * depth.stride, 2}, depth.data, self),
                          frame.stamp_ns, frame.depth_stamp_ns);
      });
}

}  // namespace
}  // namespace plvo::python

PYBIND11_MODULE(_plvo, module) {
  using namespace plvo::python;
  module.attr("__version__") = PLVO_VERSION;
  make_error_type(module);
  bind_camera(module);
  bind_config(module);
  bind_result(module);
  bind_odometry(module);
  bind_sequence(module);
}

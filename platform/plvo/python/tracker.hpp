// SPDX-License-Identifier: Apache-2.0
// The odometry for Python, in a block of its own; other threads run while it tracks. The second of two cores
// never meets the interpreter. There is no stage hook: see docs/user/python.md.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "plvo/host/thread_pair.hpp"
#include "plvo/map/map.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/one_thread.hpp"
#include "plvo/python/settings.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo::python {

// The numbers of Limits that are not None stand in for those of the preset.
struct OwnLimits {
  py::object keypoints, segments, references, line_bands, kept_keyframes, surfaces;

  void put_into(Limits& limits) const {
    const std::tuple<const char*, const py::object&, int&> numbers[] = {
        {"keypoints", keypoints, limits.keypoints},
        {"segments", segments, limits.segments},
        {"references", references, limits.references},
        {"line_bands", line_bands, limits.line_bands},
        {"kept_keyframes", kept_keyframes, limits.kept_keyframes},
        {"surfaces", surfaces, limits.surfaces}};
    for (const auto& [name, own, entry] : numbers) entry = optional_integer<int>(own, name).value_or(entry);
  }
};

// A copy of a mask: 1 where the pixel is used, else 0.
using UsedPixels = py::array_t<std::uint8_t, py::array::c_style>;
inline UsedPixels used_pixels(const py::object& mask) {
  const auto array = py::array::ensure(mask);
  if (!array ||
      !(array.dtype().equal(py::dtype::of<bool>()) || array.dtype().equal(py::dtype::of<std::uint8_t>()))) {
    PyErr_Clear();
    throw py::type_error("mask: expected an array of bool or uint8, not 0 where a pixel is used");
  }
  if (array.ndim() != 2) refuse_array("mask", "expected (height, width)");
  const UsedPixels given(array);
  UsedPixels used({given.shape(0), given.shape(1)});
  std::transform(given.data(), given.data() + given.size(), used.mutable_data(),
                 [](std::uint8_t value) { return static_cast<std::uint8_t>(value != 0 ? 1 : 0); });
  return used;
}

class Tracker {
 public:
  Tracker(const Calibration& camera, const Settings& settings, const OwnLimits& own, int cores,
          const py::object& mask)
      : metres_per_unit_(1.0 / camera.depth_units_per_metre) {
    Limits limits = settings.limits;
    limits.cores = cores;
    limits.width = camera.camera.width;
    limits.height = camera.camera.height;
    own.put_into(limits);
    limits.mask = !mask.is_none();
    throw_unless_ok(limits.validate());
    memory_.resize(required_bytes(limits));
    Config config = settings.config;
    if (limits.mask) {
      used_ = used_pixels(mask);
      config.mask = {used_.data(), static_cast<int>(used_.shape(1)), static_cast<int>(used_.shape(0)),
                     used_.shape(1)};
    }
    if (cores > 1) {
      pair_ = std::make_unique<ThreadPair>();
      config.executor = pair_->executor();
    }
    throw_unless_ok(odometry_.init(memory_, camera.camera, config, limits));
  }

  TrackResult track(const py::array& colour, const py::array& depth, std::int64_t stamp_ns,
                    const std::optional<std::int64_t>& depth_stamp_ns, bool bgr, const MotionPrior& prior) {
    const RgbdFrame frame{stamp_ns, depth_stamp_ns.value_or(stamp_ns), colour_view(colour, bgr),
                          depth_view(depth, metres_per_unit_)};
    const OneThread::Use use(one_thread_);
    TrackResult result;
    {
      const py::gil_scoped_release others_may_run;
      result = odometry_.track(frame, prior);
    }
    if (result.status.code() == StatusCode::kInvalidArgument) throw_unless_ok(result.status);
    return result;
  }

  FeatureView features() {
    const OneThread::Use use(one_thread_);
    return odometry_.features();
  }
  void frame_took(std::int64_t ns) {
    const OneThread::Use use(one_thread_);
    odometry_.frame_took(ns);
  }
  void reset() {
    const OneThread::Use use(one_thread_);
    odometry_.reset();
  }
  void set_pose(const py::object& T_world_camera, const py::object& covariance) {
    const Se3 T = se3_of(T_world_camera, "T_world_camera");
    const Matrix6 C = covariance.is_none() ? Matrix6::Zero() : matrix_of<6, 6>(covariance, "covariance");
    const OneThread::Use use(one_thread_);
    throw_unless_ok(odometry_.set_pose(T, C));
  }
  std::size_t memory_bytes() const { return memory_.size(); }
  // The odometry belongs to nobody else meanwhile.
  MapResult update(Map& map, const TrackResult& result) {
    const OneThread::Use use(one_thread_);
    return map.update(odometry_, result);
  }

 private:
  std::vector<std::byte> memory_;
  std::unique_ptr<ThreadPair> pair_;
  UsedPixels used_;  // Config::mask, which is borrowed
  Odometry odometry_;
  double metres_per_unit_;
  OneThread one_thread_{"Odometry"};
};

}  // namespace plvo::python

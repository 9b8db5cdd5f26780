// SPDX-License-Identifier: Apache-2.0
// Keeps the points and lines of the keyframes of a run in 3D, for the report. The number is bounded for a run
// of any length: when a list is full, every second entry goes, and from then on half as many are taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "plvo/math/se3.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo::report {

struct Scene {
  std::vector<Vector3> points;                     // world, m
  std::vector<std::pair<Vector3, Vector3>> lines;  // their ends
};

class SceneRecorder {
 public:
  static constexpr std::size_t kMostPoints = 20'000;
  static constexpr std::size_t kMostLines = 5'000;
  // What is less certain is left out: it would surround the scene like a cloud.
  static constexpr double kMostSigma_m = 0.05;

  // Call after track(). Takes the features of a keyframe once; the keyframe has then been tracked already.
  void offer(const Odometry& odometry);
  const Scene& scene() const { return scene_; }

 private:
  std::int64_t keyframe_stamp_ns_ = 0;
  bool any_ = false;
  std::size_t point_step_ = 1, line_step_ = 1;
  Scene scene_;
};

}  // namespace plvo::report

// SPDX-License-Identifier: Apache-2.0
// The true edges of a rendered image: the visible edges of the boxes of the scene. Printed texture, shadows
// and cylinders are not included.
#pragma once

#include <memory>
#include <vector>

#include "plvo/bench/detectors/line_measures.hpp"
#include "plvo/bench/detectors/view.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/render/ray_caster.hpp"
#include "plvo/simulator/scene/scene.hpp"

namespace plvo::bench {

class SceneEdges {
 public:
  SceneEdges(SceneName scene, std::uint64_t seed, const CameraModel& camera);

  // Stretches of at least kShortest_px that are not hidden and across which the noise-free image, seen from
  // this view, changes by at least kLeast_grey.
  std::vector<Line> visible(const Se3& T_world_camera, const std::vector<std::uint8_t>& clean);

  static constexpr double kShortest_px = 20;
  static constexpr double kLeast_grey = 8;

 private:
  void add_stretches(const Vector3& a, const Vector3& b, int solid, const std::vector<std::uint8_t>& clean,
                     std::vector<Line>& edges) const;
  bool shows(int solid, const Vector2& pixel, double depth_m) const;

  CameraModel camera_;
  std::unique_ptr<sim::Scene> scene_;
  sim::RayCaster caster_;
};

}  // namespace plvo::bench

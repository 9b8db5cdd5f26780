// SPDX-License-Identifier: Apache-2.0
// The proof that pictures, depths and poses belong together: a frame warped into the next one with the true
// pose falls on the same colours and the same depths; with a wrong pose it does not. And the hierarchy of
// boxes finds what trying every solid finds.
#include <algorithm>
#include <cmath>

#include "plvo/base/random.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/simulator/scene/scene.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::shoot;
using test::Shot;
using test::small_options;

struct Residuals {
  double gray_median = 0, gray_90 = 0;    // gray levels
  double depth_median = 0, depth_70 = 0;  // m
  std::size_t count = 0;
};

double quantile(std::vector<double>& values, double q) {
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

// Gray levels after two passes of the binomial filter (1 2 1)/4 along each axis: bilinear interpolation would
// smear detail at the limit of the resolution, which would say something about the interpolation, not about
// the geometry.
std::vector<double> smooth_gray(const CameraModel& camera, const Shot& shot) {
  const auto width = static_cast<std::size_t>(camera.width);
  std::vector<double> gray(shot.exact.size());
  for (std::size_t i = 0; i < gray.size(); ++i) gray[i] = shot.gray(i);
  for (const std::size_t step : {std::size_t{1}, width, std::size_t{1}, width}) {
    std::vector<double> out = gray;
    for (std::size_t i = step; i + step < gray.size(); ++i)
      out[i] = 0.25 * (gray[i - step] + 2 * gray[i] + gray[i + step]);
    gray = out;
  }
  return gray;
}

// Warps `from` into `to` by T_to_from; pixels that leave the picture or are hidden in `to` are left out.
Residuals warp(const CameraModel& camera, const Shot& from, const Shot& to, const Se3& T_to_from) {
  const std::vector<double> gray_from = smooth_gray(camera, from);
  const std::vector<double> gray_to = smooth_gray(camera, to);
  std::vector<double> gray;
  std::vector<double> depth;
  for (int y = 2; y < camera.height - 2; ++y) {
    for (int x = 2; x < camera.width - 2; ++x) {
      const auto i = static_cast<std::size_t>(y * camera.width + x);
      if (from.exact[i] <= 0) continue;
      const Vector3 p = T_to_from * back_project(camera.pinhole, x, y, static_cast<double>(from.exact[i]));
      if (p.z() < 0.05) continue;
      const Vector2 q = project(camera.pinhole, p);
      if (!(q.x() >= 1 && q.y() >= 1 && q.x() < camera.width - 2 && q.y() < camera.height - 2)) continue;
      const int qx = static_cast<int>(q.x());
      const int qy = static_cast<int>(q.y());
      const double u = q.x() - qx;
      const double v = q.y() - qy;
      const auto bilinear = [&](auto value) {
        const auto k = static_cast<std::size_t>(qy * camera.width + qx);
        const auto w = static_cast<std::size_t>(camera.width);
        return (1 - v) * ((1 - u) * value(k) + u * value(k + 1)) +
               v * ((1 - u) * value(k + w) + u * value(k + w + 1));
      };
      // Inverse depth is linear over the picture of a plane.
      const double seen = 1 / bilinear([&](std::size_t k) { return 1 / static_cast<double>(to.exact[k]); });
      if (std::abs(seen - p.z()) > 0.05 * p.z()) continue;  // hidden, or on a rim
      depth.push_back(std::abs(seen - p.z()));
      gray.push_back(std::abs(bilinear([&](std::size_t k) { return gray_to[k]; }) - gray_from[i]));
    }
  }
  Residuals r;
  r.count = gray.size();
  if (gray.empty()) return r;
  r.gray_median = quantile(gray, 0.5);
  r.gray_90 = quantile(gray, 0.9);
  r.depth_median = quantile(depth, 0.5);
  r.depth_70 = quantile(depth, 0.7);
  return r;
}

class Geometry : public testing::TestWithParam<SceneName> {};

TEST_P(Geometry, AFrameWarpedByTheTruePoseFallsOnTheNext) {
  SimulatorOptions options = small_options(GetParam());
  options.noise = false;
  options.frames = 12;
  const std::vector<Shot> shots = shoot(options);
  ASSERT_EQ(shots.size(), 12U);
  for (std::size_t k = 2; k + 1 < shots.size(); k += 4) {
    const Se3 T_to_from = shots[k + 1].T_world_camera.inverse() * shots[k].T_world_camera;
    const Residuals right = warp(options.camera, shots[k], shots[k + 1], T_to_from);
    ASSERT_GT(right.count, 160U * 120U / 2);
    EXPECT_LT(right.depth_median, 2e-5);
    EXPECT_LT(right.depth_70, 1e-3);  // beyond it come pixels that straddle two surfaces
    EXPECT_LT(right.gray_median, 1.0);
    EXPECT_LT(right.gray_90, 6.0);
    // The opposite motion is as large and wrong.
    const Residuals wrong = warp(options.camera, shots[k], shots[k + 1], T_to_from.inverse());
    EXPECT_GT(wrong.depth_median, 20 * right.depth_median);
    EXPECT_GT(wrong.gray_90, right.gray_90);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Geometry,
                         testing::Values(SceneName::kCorridor, SceneName::kStaircase, SceneName::kHall,
                                         SceneName::kDesk, SceneName::kBare),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(Bvh, FindsWhatTryingEverySolidFinds) {
  for (const SceneName name :
       {SceneName::kCorridor, SceneName::kStaircase, SceneName::kHall, SceneName::kDesk, SceneName::kBare}) {
    const std::unique_ptr<sim::Scene> scene = sim::build_scene(name, 3);
    Random random(11);
    const sim::Float3 lo = scene->free_lo;
    const sim::Float3 size = scene->free_hi - lo;
    for (int i = 0; i < 2000; ++i) {
      const auto draw = [&] { return static_cast<float>(random.uniform()); };
      const sim::Float3 origin = lo + sim::Float3{draw() * size.x, draw() * size.y, draw() * size.z};
      const sim::Ray ray{origin, {draw() - 0.5F, draw() - 0.5F, draw() - 0.5F}};
      sim::Hit slow;
      slow.t = 1e4F;
      for (std::size_t k = 0; k < scene->solids.size(); ++k) {
        float t = 0;
        int face = 0;
        if (intersect(scene->solids[k], ray, 1e-3F, slow.t, t, face)) slow = {t, static_cast<int>(k), face};
      }
      const sim::Hit fast = scene->bvh.closest(ray, 1e-3F, 1e4F);
      ASSERT_GE(slow.solid, 0) << "a ray escapes from the room";
      EXPECT_EQ(fast.t, slow.t);
      EXPECT_TRUE(scene->bvh.occluded(ray, 1e-3F, slow.t * 1.001F));
      EXPECT_FALSE(scene->bvh.occluded(ray, 1e-3F, slow.t * 0.999F));
    }
  }
}

}  // namespace
}  // namespace plvo

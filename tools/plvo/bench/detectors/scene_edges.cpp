// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/detectors/scene_edges.hpp"

#include <cmath>

namespace plvo::bench {
namespace {

constexpr double kNearest_m = 0.1;
constexpr int kGap_px = 3;  // longest interruption of a stretch

Vector3 to_vector(const sim::Float3& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

// Corner 0 … 7: bit i gives the side along axis i.
Vector3 corner(const sim::Solid& box, int number) {
  const auto side = [number](int axis, float half) { return (number >> axis & 1) != 0 ? half : -half; };
  return to_vector(box.to_world({side(0, box.half.x), side(1, box.half.y), side(2, box.half.z)}));
}

// Clips the edge to the part in front of the camera; false if no part of it is.
bool clip_to_front(Vector3& a, Vector3& b) {
  if (a.z() < kNearest_m && b.z() < kNearest_m) return false;
  const auto move = [](Vector3& behind, const Vector3& front) {
    behind = front + (behind - front) * ((front.z() - kNearest_m) / (front.z() - behind.z()));
  };
  if (a.z() < kNearest_m) move(a, b);
  if (b.z() < kNearest_m) move(b, a);
  return true;
}

// The part of the line from a that lies within the image, as the fractions of its length at which it begins
// and ends.
bool clip_to_image(const Vector2& a, const Vector2& b, int width, int height, double& begin, double& end) {
  begin = 0;
  end = 1;
  const Vector2 d = b - a;
  const Vector2 most(width - 1, height - 1);
  for (int i = 0; i < 2; ++i) {
    if (std::abs(d(i)) < 1e-9) {
      if (a(i) < 0 || a(i) > most(i)) return false;
      continue;
    }
    const double at_low = -a(i) / d(i);
    const double at_high = (most(i) - a(i)) / d(i);
    begin = std::max(begin, std::min(at_low, at_high));
    end = std::min(end, std::max(at_low, at_high));
  }
  return begin < end;
}

}  // namespace

SceneEdges::SceneEdges(SceneName scene, std::uint64_t seed, const CameraModel& camera)
    : camera_(camera), scene_(sim::build_scene(scene, seed)), caster_(*scene_, camera, 1) {}

std::vector<Line> SceneEdges::visible(const Se3& T_world_camera, const std::vector<std::uint8_t>& clean) {
  caster_.cast(std::vector<Se3>(static_cast<std::size_t>(camera_.height), T_world_camera));
  const Se3 T_camera_world = T_world_camera.inverse();
  std::vector<Line> edges;
  for (std::size_t solid = 0; solid < scene_->solids.size(); ++solid) {
    const sim::Solid& box = scene_->solids[solid];
    if (box.shape != sim::Solid::Shape::kBox) continue;
    for (int from = 0; from < 8; ++from) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((from >> axis & 1) != 0) continue;
        Vector3 a = T_camera_world * corner(box, from);
        Vector3 b = T_camera_world * corner(box, from | 1 << axis);
        if (clip_to_front(a, b)) add_stretches(a, b, static_cast<int>(solid), clean, edges);
      }
    }
  }
  return edges;
}

// True if the pixel or one of its neighbours observes that solid at this depth.
bool SceneEdges::shows(int solid, const Vector2& pixel, double depth_m) const {
  const ImageView<const sim::PixelHit> hits = caster_.hits();
  const int u = static_cast<int>(std::lround(pixel.x()));
  const int v = static_cast<int>(std::lround(pixel.y()));
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, hits.height - 1); ++y) {
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, hits.width - 1); ++x) {
      const sim::PixelHit& hit = hits.row(y)[x];
      if (hit.surface >= 0 && hit.surface / sim::Solid::kFaces == solid &&
          std::abs(static_cast<double>(hit.depth_m) - depth_m) < 0.01 + 0.02 * depth_m)
        return true;
    }
  }
  return false;
}

void SceneEdges::add_stretches(const Vector3& a, const Vector3& b, int solid,
                               const std::vector<std::uint8_t>& clean, std::vector<Line>& edges) const {
  const Vector2 pixel_a = project(camera_.pinhole, a);
  const Vector2 pixel_b = project(camera_.pinhole, b);
  double begin = 0, end = 0;
  if (!clip_to_image(pixel_a, pixel_b, camera_.width, camera_.height, begin, end)) return;
  const double length = (pixel_b - pixel_a).norm();
  const auto samples = static_cast<int>((end - begin) * length);
  if (samples < kShortest_px) return;
  const Vector2 direction = (pixel_b - pixel_a) / length;
  const Vector2 normal(-direction.y(), direction.x());
  const auto pixel = [&](int i) { return Vector2(pixel_a + (begin * length + i) * direction); };
  int first = -1, last = -1;
  const auto close = [&] {
    if (first >= 0 && last - first >= kShortest_px) edges.push_back({pixel(first), pixel(last)});
    first = -1;
  };
  for (int i = 0; i <= samples; ++i) {
    const double share = begin + i / length;
    const double depth_m =
        1 / ((1 - share) / a.z() + share / b.z());  // 1/z is linear along a line of the image
    if (!shows(solid, pixel(i), depth_m) ||
        std::abs(step_across(clean, camera_.width, camera_.height, pixel(i), normal)) < kLeast_grey)
      continue;
    if (first >= 0 && i - last > kGap_px) close();
    if (first < 0) first = i;
    last = i;
  }
  close();
}

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
// Compares the true edges of a rendered image with the surfaces at its pixels.
#include "plvo/bench/detectors/scene_edges.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace plvo::bench {
namespace {

CameraModel edge_camera() {
  CameraModel camera;
  camera.width = 320;
  camera.height = 240;
  camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  return camera;
}

// Looks along +x from the middle of the bare room, upright.
Se3 middle_of_the_room() {
  Se3 T_world_camera;
  T_world_camera.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T_world_camera.t = Vector3(1.5, 2.5, 1.4);
  return T_world_camera;
}

// Renders each surface with its own grey level, so that low contrast hides hardly any edge.
std::vector<std::uint8_t> surfaces_as_grey(const sim::RayCaster& caster) {
  std::vector<std::uint8_t> grey;
  const ImageView<const sim::PixelHit> hits = caster.hits();
  for (int y = 0; y < hits.height; ++y)
    for (int x = 0; x < hits.width; ++x)
      grey.push_back(static_cast<std::uint8_t>(37 * (hits.row(y)[x].surface + 1)));
  return grey;
}

class BareRoom : public ::testing::Test {
 protected:
  BareRoom() : scene_(sim::build_scene(SceneName::kBare, 1)), caster_(*scene_, edge_camera(), 1) {
    caster_.cast(std::vector<Se3>(240, middle_of_the_room()));
    grey_ = surfaces_as_grey(caster_);
    edges_ = SceneEdges(SceneName::kBare, 1, edge_camera()).visible(middle_of_the_room(), grey_);
  }
  std::unique_ptr<sim::Scene> scene_;
  sim::RayCaster caster_;
  std::vector<std::uint8_t> grey_;
  std::vector<Line> edges_;
};

TEST_F(BareRoom, EdgesSeparateTwoSurfaces) {
  ASSERT_GE(edges_.size(), 10U);
  const auto surface = [&](const Vector2& p) {
    return caster_.hits()
        .row(static_cast<int>(std::lround(p.y())))[static_cast<int>(std::lround(p.x()))]
        .surface;
  };
  int samples = 0, between_two = 0;
  for (const Line& edge : edges_) {
    EXPECT_GE(edge.length(), SceneEdges::kShortest_px);
    const Vector2 direction = (edge.b - edge.a) / edge.length();
    const Vector2 normal(-direction.y(), direction.x());
    for (double s = 0; s <= edge.length(); s += 1) {
      const Vector2 at = edge.a + s * direction;
      if (at.x() < 3 || at.y() < 3 || at.x() > 316 || at.y() > 236) continue;
      ++samples;
      between_two += surface(at + 1.5 * normal) != surface(at - 1.5 * normal) ? 1 : 0;
    }
  }
  EXPECT_GT(between_two, 0.97 * samples) << samples;
}

// The room is 6 m long, 5 m wide and 2.7 m high, and its far wall is 4.5 m away. This gives the corner with
// the right-hand wall independently of the code under test.
TEST_F(BareRoom, FarCornerOfTheRoomIsFound) {
  const double x = 159.5 + 262.5 * 2.5 / 4.5;  // at y = 0, 2.5 m to the right
  double covered = 0;
  for (const Line& edge : edges_)
    if (std::abs(edge.a.x() - x) < 0.6 && std::abs(edge.b.x() - x) < 0.6)
      covered += std::abs(edge.b.y() - edge.a.y());
  EXPECT_GT(covered, 100) << "of the 157 px from the floor to the ceiling";
}

TEST_F(BareRoom, InvisibleEdgesAreExcluded) {
  const std::vector<std::uint8_t> plain(320 * 240, 128);
  EXPECT_TRUE(SceneEdges(SceneName::kBare, 1, edge_camera()).visible(middle_of_the_room(), plain).empty());
}

}  // namespace
}  // namespace plvo::bench

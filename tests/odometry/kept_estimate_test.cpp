// SPDX-License-Identifier: Apache-2.0
// The estimate that explains most so far is kept while other motions are tried, and put back if none is
// better. It must be the one that an estimate from the same start would give again.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "plvo/odometry/tracking/reference_tracking.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

struct KeptModules {
  FeatureExtraction extraction;
  ReferenceTracking tracking;
  std::array<FrameFeatures, 2> frames;

  constexpr void allocate(Arena& memory, const Limits& limits) {
    for (FrameFeatures& frame : frames) frame.allocate(memory, limits);
    extraction.allocate(memory, limits);
    tracking.allocate(memory, limits);
  }
  static std::size_t bytes(const Limits& limits) {
    Arena sizer = Arena::counting();
    KeptModules modules;
    modules.allocate(sizer, limits);
    FeatureExtraction::reserve(sizer, limits);
    ReferenceTracking::reserve(sizer, limits);
    return sizer.peak() + kArenaAlignment;
  }
};

// What an estimate leaves behind, in containers of its own.
struct Left {
  Se3 motion;
  Matrix6 covariance;
  std::vector<Vector2> pixels;
  std::vector<std::uint16_t> point_references, line_references;
  std::vector<std::uint8_t> point_inliers, line_inliers;
  std::size_t surfaces;
  int inliers;
};

Left copy_of(const TrackedMotion& tracked, const ReferenceTracks& tracks) {
  Left left{tracked.motion.T_current_reference,
            tracked.motion.C_H,
            {},
            {},
            {},
            {},
            {},
            tracks.surfaces.size(),
            tracks.inliers};
  for (std::size_t i = 0; i < tracks.points.matches.size(); ++i) {
    left.pixels.push_back(tracks.points.pixels[i]);
    left.point_references.push_back(tracks.points.matches[i].reference);
    left.point_inliers.push_back(tracks.point_inliers[i]);
  }
  for (std::size_t i = 0; i < tracks.lines.size(); ++i) {
    left.line_references.push_back(tracks.lines[i].reference);
    left.line_inliers.push_back(tracks.line_inliers[i]);
  }
  return left;
}

void expect_same(const Left& a, const Left& b) {
  EXPECT_EQ(a.motion.R, b.motion.R);
  EXPECT_EQ(a.motion.t, b.motion.t);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_EQ(a.point_references, b.point_references);
  EXPECT_EQ(a.line_references, b.line_references);
  EXPECT_EQ(a.point_inliers, b.point_inliers);
  EXPECT_EQ(a.line_inliers, b.line_inliers);
  EXPECT_EQ(a.surfaces, b.surfaces);
  EXPECT_EQ(a.inliers, b.inliers);
}

TEST(KeptEstimate, IsTheSameAsOneFromTheSameStart) {
  const Limits limits = Limits::vga();
  ProceduralSequence room(640, 480);
  const CameraModel camera = room.camera();
  const Config config;
  std::vector<std::byte> memory(KeptModules::bytes(limits));
  Arena arena(memory);
  KeptModules modules;
  modules.allocate(arena, limits);
  arena.seal();
  modules.extraction.init(camera);
  const NoiseScales noise = initial_scales(config.noise);
  StageTimes times{};
  CarriedCells carried;
  carried.init(camera.width, camera.height);
  const StageContext context{camera, config, noise, arena, times, carried, nullptr};
  const MotionPrior prior;
  PredictedMotion predicted;
  const std::size_t before = arena.used();
  for (int i = 0; i < 2; ++i) {
    const RgbdFrame frame = room.render(i);
    FrameFeatures& features = modules.frames[static_cast<std::size_t>(i)];
    features.clear({static_cast<std::size_t>(limits.keypoints), static_cast<std::size_t>(limits.segments)});
    (void)modules.extraction.prepare_image(context, frame.colour);
    const DepthSampler depth = modules.extraction.depth_sampler(frame, config.depth_noise);
    const CurrentFrame current{context, modules.extraction, depth, predicted, features, prior};
    modules.extraction.detect(context, depth, true, features);
    current.describe_points();
    if (i == 0) {
      modules.extraction.lift_lines(context, depth, {}, features.lines);
      modules.extraction.lift(context, depth, features);
      continue;
    }
    Reference reference;
    reference.features = &modules.frames[0];
    const Se3 start = ProceduralRenderer::T_world_camera(1).inverse() * ProceduralRenderer::T_world_camera(0);
    TrackedMotion tracked;
    ReferenceTracking& tracking = modules.tracking;
    {
      const ScratchScope scope(arena);
      tracking.refine({&reference, 1}, current, start, false, tracked);
      ASSERT_TRUE(tracked.ok());
      const Left first = copy_of(tracked, tracking.tracks(0));
      ASSERT_GT(first.surfaces, 50U);
      ASSERT_GT(first.inliers, 100);
      const int iterations = tracked.lm_iterations;

      KeptEstimate* kept = nullptr;
      tracking.keep(tracked, arena, kept);
      Vector6 step;
      step << 0.1, 0, 0, 0, 0.05, 0;
      tracking.refine({&reference, 1}, current, boxplus(start, step), false, tracked);
      const Left other = copy_of(tracked, tracking.tracks(0));
      EXPECT_NE(first.pixels, other.pixels);
      const int all_iterations = tracked.lm_iterations;
      EXPECT_GE(all_iterations, iterations);

      tracking.put_back(*kept, tracked);
      EXPECT_TRUE(tracked.ok());
      EXPECT_EQ(tracked.lm_iterations, all_iterations);
      expect_same(copy_of(tracked, tracking.tracks(0)), first);

      tracking.refine({&reference, 1}, current, start, false, tracked);
      expect_same(copy_of(tracked, tracking.tracks(0)), first);
      EXPECT_FALSE(arena.exhausted());
    }
    EXPECT_EQ(arena.used(), before);
  }
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// After the caller has provided the block, neither init nor track allocates or frees heap memory. Tested over
// a whole sequence with lost, refused and recovered frames.
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "allocation_guard.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace plvo {
namespace {

struct Settings {
  Config config;
  Limits limits = Limits::qvga();
};

class NoAllocation : public testing::TestWithParam<std::function<Settings()>> {
 protected:
  void SetUp() override {
    if (!AllocationGuard::available())
      GTEST_SKIP() << "SKIPPED: a sanitizer owns malloc here, so allocations cannot be counted; the other "
                      "presets do it";
  }
};

TEST_P(NoAllocation, HappensOverASequenceWithLostFrames) {
  const auto [config, limits] = GetParam()();
  ProceduralSequence sequence(limits.width, limits.height);
  std::vector<std::byte> memory(required_bytes(limits));

  AllocationGuard guard;
  Odometry odometry;
  const Status status = odometry.init(memory, sequence.camera(), config, limits);
  guard.disarm();
  ASSERT_TRUE(status.ok()) << status.message();

  int tracked = 0, lost = 0, refused = 0, tracked_after_loss = 0;
  const auto track = [&](const RgbdFrame& frame) {
    guard.arm();
    const TrackResult result = odometry.track(frame);
    // For configurations with a budget: one step down, later up again.
    odometry.frame_took(result.stamp_ns < sequence.stamp_ns(9) ? 2 : 0);
    guard.disarm();
    return result;
  };
  for (int i = 0; i < 20; ++i) {
    const bool dark = i == 6 || i == 7 || i == 13;
    const TrackResult result = track(dark ? sequence.render_dark(i) : sequence.render(i));
    if (result.state == TrackState::kLost) ++lost;
    if (result.state == TrackState::kTracking) {
      ++tracked;
      if (lost > 0) ++tracked_after_loss;
    }
    if (i == 10) {
      // Frames that are refused: without an image, with an old stamp, of another size.
      RgbdFrame blind = sequence.render(i + 1);
      blind.depth.data = nullptr;
      RgbdFrame small = sequence.render(i + 1);
      small.colour.width /= 2;
      for (const RgbdFrame& bad : {blind, small, sequence.render(0)})
        if (track(bad).status.code() == StatusCode::kInvalidArgument) ++refused;
    }
  }
  EXPECT_EQ(guard.taken(), 0);
  EXPECT_EQ(guard.returned(), 0);
  // Checks that the sequence contained the intended cases.
  EXPECT_EQ(lost, 3);
  EXPECT_EQ(refused, 3);
  EXPECT_GE(tracked, 15);
  EXPECT_GE(tracked_after_loss, 10);
}

Config keyframe_alone() {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  return config;
}

Config budgeted() {
  Config config;
  config.budget = {.frame_ns = 1, .patience_frames = 2, .spare_share = 0.5};
  return config;
}

Limits with_surfaces() {
  Limits limits = Limits::qvga();
  limits.surfaces = 200;
  return limits;
}

INSTANTIATE_TEST_SUITE_P(
    Configs, NoAllocation,
    testing::Values([] { return Settings{.config = {}}; }, [] { return Settings{.config = Config::paper()}; },
                    [] { return Settings{.config = keyframe_alone()}; },
                    [] { return Settings{.config = {}, .limits = with_surfaces()}; },
                    [] { return Settings{.config = budgeted()}; },
                    [] { return Settings{.config = Config::tiny(), .limits = Limits::tiny()}; }));

TEST(NoAllocationWhenLostForGood, GivesUpTheReferenceAndStartsAnew) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "SKIPPED: a sanitizer owns malloc here";
  constexpr Limits kLimits = Limits::qvga();
  ProceduralSequence sequence(kLimits.width, kLimits.height);
  std::vector<std::byte> memory(required_bytes(kLimits));
  Config config;
  config.references.max_lost_s = 0.06;
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, sequence.camera(), config, kLimits).ok());
  AllocationGuard guard;
  guard.disarm();
  TrackState last = TrackState::kLost;
  for (int i = 0; i < 9; ++i) {
    const RgbdFrame frame = i >= 2 && i < 6 ? sequence.render_dark(i) : sequence.render(i);
    guard.arm();
    last = odometry.track(frame).state;
    guard.disarm();
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(last, TrackState::kTracking);
}

}  // namespace
}  // namespace plvo

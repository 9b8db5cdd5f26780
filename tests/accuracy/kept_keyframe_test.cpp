// SPDX-License-Identifier: Apache-2.0
// A keyframe that is kept for long goes on erring alike: what is reported of the motion from it must not get
// surer with every frame, and the estimate must stay what it is (common_mode_error.hpp).
#include <cstdio>

#include "tracked_sequence.hpp"

namespace plvo {
namespace {

// Mean over the motions from a keyframe that is at least eight frames old; 6 if the covariance is true.
double nees_of_old_keyframes(const test::TrackedSequence& tracked) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < tracked.results.size(); ++i) {
    if (tracked.results[i].state != TrackState::kTracking || i < tracked.reference(i) + 8) continue;
    sum += tracked.nees_of_motion(i);
    ++count;
  }
  EXPECT_GE(count, 20);
  return sum / count;
}

TEST(KeptKeyframe, DoesNotMakeTheCovarianceSurerWithEveryFrame) {
  Config config, as_if_new;
  as_if_new.noise.common_mode_share = 0;
  const test::TrackedSequence tracked = test::track_sequence(SceneName::kCorridor, 60, config);
  const test::TrackedSequence other = test::track_sequence(SceneName::kCorridor, 60, as_if_new);
  test::expect_same_poses(tracked, other);
  const double told = nees_of_old_keyframes(tracked), surer = nees_of_old_keyframes(other);
  std::printf("NEES of motions from old keyframes: %.2f, as if new %.2f\n", told, surer);
  EXPECT_GT(surer, 1.5 * told);
  // 6 if true: no surer than that, but for chance, and not twice as unsure. As if new it is surer.
  constexpr double kLeast = 3, kMost = 6.5;
  EXPECT_GT(told, kLeast);
  EXPECT_LT(told, kMost);
  EXPECT_GT(surer, kMost);
}

}  // namespace
}  // namespace plvo

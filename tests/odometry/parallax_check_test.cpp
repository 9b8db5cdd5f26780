// SPDX-License-Identifier: Apache-2.0
// The ratio of what depth adds to the motion, compared with the sums that it stands for.
#include "plvo/odometry/parallax_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

using test::Gaussian;

constexpr double kStep_s = 1.0 / 30;
constexpr double kDepthSigma_m = 0.005;

struct Seen {
  DepthShift shift;
  double elapsed_s = kStep_s;
};

Seen seen(double t_z, double z) { return {{t_z, z, 1 / (kDepthSigma_m * kDepthSigma_m), 0}}; }

bool fails_over(const std::vector<Seen>& frames) {
  ParallaxCheck check;
  for (const Seen& frame : frames) check.note(frame.shift, frame.elapsed_s);
  return check.fails();
}

// r over its SD, by weighted sums over all frames.
double ratio_in_sigmas(const std::vector<Seen>& frames) {
  double product = 0, square = 0, weight = 1;
  for (std::size_t i = frames.size(); i-- > 0;) {
    const DepthShift& shift = frames[i].shift;
    product += weight * shift.information * shift.z * shift.t_z;
    square += weight * shift.information * shift.t_z * shift.t_z;
    weight *= 1 / (1 + frames[i].elapsed_s);
  }
  return product / square / std::sqrt(1 / square + 0.03 * 0.03);
}

// t_z in every frame, and `share` of it is added by depth, besides noise.
std::vector<Seen> in_proportion(double t_z, double share, int count, Gaussian& gaussian) {
  std::vector<Seen> frames;
  for (int i = 0; i < count; ++i) frames.push_back(seen(t_z, share * t_z + kDepthSigma_m * gaussian()));
  return frames;
}

TEST(ParallaxCheck, IsATestOfTheRatio) {
  int failed = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Gaussian gaussian(seed);
    std::vector<Seen> frames;
    for (int i = 0; i < 40; ++i) {
      frames.push_back(seen(0.02 * gaussian(), 0));
      frames.back().shift.z =
          0.3 * frames.back().shift.t_z / static_cast<double>(1 + seed % 5) + kDepthSigma_m * gaussian();
      frames.back().elapsed_s = kStep_s * (1 + i % 4);
    }
    const double sigmas = ratio_in_sigmas(frames);
    EXPECT_EQ(fails_over(frames), sigmas > 2.5) << seed << ": " << sigmas;
    failed += fails_over(frames) ? 1 : 0;
  }
  EXPECT_GT(failed, 10);
  EXPECT_LT(failed, 190);
}

TEST(ParallaxCheck, PassesNoise) {
  int failed = 0;
  constexpr int kTrials = 1000;
  for (int trial = 0; trial < kTrials; ++trial) {
    Gaussian gaussian(static_cast<std::uint64_t>(trial) + 1);
    failed += fails_over(in_proportion(0.03, 0, 60, gaussian)) ? 1 : 0;
  }
  // Beyond 2.5 SDs on one side: 0.6 %, and less with the error of the calibration.
  EXPECT_LE(failed, 15);
}

TEST(ParallaxCheck, FindsAMirrorOverASecond) {
  Gaussian gaussian(5);
  EXPECT_FALSE(fails_over(in_proportion(0.03, 0.3, 1, gaussian)));
  EXPECT_TRUE(fails_over(in_proportion(0.03, 0.3, 30, gaussian)));
  EXPECT_TRUE(fails_over(in_proportion(-0.03, 0.3, 30, gaussian)));  // backwards
}

TEST(ParallaxCheck, PassesErrorsOfTheCalibration) {
  Gaussian gaussian(6);
  gaussian.set_silent(true);
  EXPECT_FALSE(fails_over(in_proportion(1, 0.03, 300, gaussian)));
}

// No surface shows its parallax before its depth.
TEST(ParallaxCheck, PassesParallaxThatIsLargerThanDepthAllows) {
  Gaussian gaussian(7);
  EXPECT_FALSE(fails_over(in_proportion(0.03, -0.3, 60, gaussian)));
}

TEST(ParallaxCheck, PassesACameraAtRestAndFramesWithoutPoints) {
  EXPECT_FALSE(ParallaxCheck().fails());
  EXPECT_FALSE(fails_over(std::vector<Seen>(60)));
  Gaussian gaussian(8);
  EXPECT_FALSE(fails_over(in_proportion(0, 0.3, 60, gaussian)));
}

TEST(ParallaxCheck, ForgetsTheMirror) {
  Gaussian gaussian(9);
  std::vector<Seen> frames = in_proportion(0.03, 0.3, 60, gaussian);
  EXPECT_TRUE(fails_over(frames));
  for (const Seen& frame : in_proportion(0.03, 0, 150, gaussian)) frames.push_back(frame);
  EXPECT_FALSE(fails_over(frames));
}

}  // namespace
}  // namespace plvo

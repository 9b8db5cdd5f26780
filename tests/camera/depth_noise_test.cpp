// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/depth_noise.hpp"

#include <gtest/gtest.h>

namespace plvo {
namespace {

TEST(DepthNoise, FollowsEquation2) {
  const DepthNoise noise;
  EXPECT_NEAR(noise.sigma(1), 2.73e-3 + 7.4e-4 - 5.8e-4, 1e-15);
  EXPECT_NEAR(noise.sigma(4), 2.73e-3 * 16 + 7.4e-4 * 4 - 5.8e-4, 1e-15);
}

TEST(DepthNoise, NeverFallsBelowItsFloor) {
  // The paper's polynomial is negative below 0.34 m.
  const DepthNoise noise;
  double nearer = 0;
  for (int mm = 0; mm < 10000; mm += 7) {
    const double sigma = noise.sigma(mm * 1e-3);
    EXPECT_GE(sigma, noise.floor_m);
    EXPECT_GE(sigma, nearer) << "does not fall with distance";
    nearer = sigma;
  }
  EXPECT_EQ(noise.sigma(0), noise.floor_m);
  EXPECT_GT(noise.sigma(0.6), noise.floor_m);
}

TEST(DepthNoise, ReturnsTheFloorForNaN) {
  const DepthNoise noise;
  const double nan = __builtin_nan("");
  EXPECT_EQ(noise.sigma(nan), noise.floor_m);
}

}  // namespace
}  // namespace plvo

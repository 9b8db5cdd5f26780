// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/disagreement.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace plvo {
namespace {

Disagreement after(int frames, double q) {
  Disagreement disagreement;
  for (int i = 0; i < frames; ++i) disagreement.note(q);
  return disagreement;
}

TEST(Disagreement, LeavesATrueCovarianceAlone) {
  EXPECT_EQ(Disagreement().inflation(), 1);
  EXPECT_EQ(after(1000, 6).inflation(), 1);
  // One frame out of the ordinary does not count.
  Disagreement disagreement = after(100, 2);
  disagreement.note(20);
  EXPECT_EQ(disagreement.inflation(), 1);
}

TEST(Disagreement, CountsTheExcessOnceForEachFrameOfASecond) {
  EXPECT_NEAR(after(100, 12).inflation(), 31, 1e-6);
  EXPECT_NEAR(after(100, 9).inflation(), 16, 1e-6);
  EXPECT_GT(after(5, 12).inflation(), 1);
}

TEST(Disagreement, EndsWhenTheKindsAgreeAgain) {
  Disagreement disagreement = after(100, 12);
  for (int i = 0; i < 10; ++i) disagreement.note(2);
  EXPECT_EQ(disagreement.inflation(), 1);
}

TEST(Disagreement, HasABound) {
  for (const double q :
       {1e9, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_NEAR(after(100, q).inflation(), after(100, 100).inflation(), 1e-6);
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/mahalanobis.hpp"

#include <gtest/gtest.h>

#include "plvo/math/chi_square.hpp"

namespace plvo {
namespace {

TEST(Mahalanobis, IsTheDistanceInStandardDeviations) {
  Matrix<2, 2> C;
  C << 4, 1.2, 1.2, 9;
  const Vector<2> e(1, -2);
  EXPECT_NEAR(mahalanobis_squared<2>(e, C), (9 + 4.8 + 16) / 34.56, 1e-12);  // by the adjugate
  EXPECT_EQ(mahalanobis_squared<2>(e, Matrix<2, 2>::Zero()), std::numeric_limits<double>::infinity());
}

TEST(Mahalanobis, TheBoundOfAPlausibleMotionIsTheQuantile) {
  EXPECT_DOUBLE_EQ(kMostPlausibleMotion, chi_square_quantile(6, 0.9999));
}

}  // namespace
}  // namespace plvo

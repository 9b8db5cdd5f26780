// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/observation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "numeric_jacobian.hpp"

namespace plvo {
namespace {

constexpr Pinhole kKinect{525.0, 520.0, 319.5, 239.5};

struct Pixel {
  double u, v, d;
};
const Pixel kPixels[] = {
    {319.5, 239.5, 1}, {0, 0, 0.6}, {639, 479, 4.5}, {100, 400, 2}, {600.25, 20.75, 3.3}};

TEST(ObservePoint, IsTheBackProjection) {
  for (const Pixel& px : kPixels) {
    const Point3d point = observe_point(kKinect, px.u, px.v, px.d, 0.5, 0.01);
    EXPECT_LT((point.p - back_project(kKinect, px.u, px.v, px.d)).norm(), 1e-15);
    EXPECT_LT((project(kKinect, point.p) - Vector2(px.u, px.v)).norm(), 1e-12);
  }
}

TEST(ObservePoint, JacobianMatchesNumericJacobian) {
  for (const Pixel& px : kPixels) {
    Matrix3 J;
    (void)observe_point(kKinect, px.u, px.v, px.d, 0.5, 0.01, &J);
    const auto f = [](const Vector3& x) { return back_project(kKinect, x(0), x(1), x(2)); };
    const Matrix3 numeric = numeric_jacobian<3, 3>(f, Vector3(px.u, px.v, px.d), 1e-4);
    EXPECT_LT((J - numeric).norm(), 1e-9);
  }
}

TEST(ObservePoint, CovarianceIsEquation4) {
  for (const Pixel& px : kPixels) {
    Matrix3 J;
    const Point3d point = observe_point(kKinect, px.u, px.v, px.d, 0.5, 0.02, &J);
    const Matrix3 expected = J * Vector3(0.25, 0.25, 0.0004).asDiagonal() * J.transpose();
    EXPECT_LT((point.Sigma - expected).norm(), 1e-14 * expected.norm());
    EXPECT_EQ(point.Sigma, Matrix3(point.Sigma.transpose())) << "symmetric to the bit";
    EXPECT_GT(point.Sigma.determinant(), 0);
  }
}

TEST(ObservePoint, CovarianceMatchesMonteCarlo) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 20000;
  const DepthNoise noise;
  for (const Pixel& px : kPixels) {
    const double sigma_px = 0.5, sigma_d = noise.sigma(px.d);
    const Point3d point = observe_point(kKinect, px.u, px.v, px.d, sigma_px, sigma_d);
    const Matrix3 information = point.Sigma.inverse();
    Matrix3 sum = Matrix3::Zero();
    double nees = 0;
    for (int i = 0; i < kTrials; ++i) {
      const Vector3 p = back_project(kKinect, px.u + sigma_px * normal(generator),
                                     px.v + sigma_px * normal(generator), px.d + sigma_d * normal(generator));
      const Vector3 e = p - point.p;
      sum += e * e.transpose();
      nees += e.dot(information * e);
    }
    // The sample covariance normalised by the stated one must be the identity, entry by entry, within
    // sampling error.
    const Matrix3 whitened = information * (sum / kTrials);
    EXPECT_LT((whitened - Matrix3::Identity()).cwiseAbs().maxCoeff() /
                  (1 + point.Sigma.norm() * information.norm()),
              0.05);
    EXPECT_NEAR(nees / kTrials, 3, 5 * 2.45 / std::sqrt(kTrials)) << "mean of a chi-square with 3 degrees";
  }
}

}  // namespace
}  // namespace plvo

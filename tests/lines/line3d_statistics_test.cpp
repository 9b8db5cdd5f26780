// SPDX-License-Identifier: Apache-2.0
// Monte Carlo tests of the covariance (10) and of the bias at occluding edges.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "dense.hpp"
#include "line_scene.hpp"
#include "plvo/lines/line3d.hpp"

namespace plvo {
namespace {

using test::kSeed;
using test::LineScene;

constexpr double kWithTails = 16;  // limit of r² that does not cut off the tails of the noise

// The four observable numbers of a line: the offsets of A and B from the true line in two directions across
// it.
struct Offsets {
  Vector4 error;
  Matrix4 covariance;
};

Offsets across(const Line3d& line, const LineScene& truth) {
  const Vector3 d = (truth.b - truth.a).normalized();
  const Vector3 u = d.unitOrthogonal(), v = d.cross(u);
  Matrix<4, 6> J = Matrix<4, 6>::Zero();
  J.block<1, 3>(0, 0) = u.transpose();
  J.block<1, 3>(1, 0) = v.transpose();
  J.block<1, 3>(2, 3) = u.transpose();
  J.block<1, 3>(3, 3) = v.transpose();
  Vector6 e;
  e << line.a - truth.a, line.b - truth.a;
  return {J * e, J * line.Sigma * J.transpose()};
}

// Half of the 95 % band of the mean of n chi-square variables with `dof` degrees of freedom, in the normal
// approximation.
double half_band(int n, int dof) { return 1.96 * std::sqrt(2.0 * dof / n); }

TEST(Line3dStatistics, NeesOfTheLineIsWithinThe95PercentBand) {
  Random random(21);
  const Pinhole pinhole;
  const int trials = 1500;
  double nees = 0, nees_ends = 0;
  Line3dConfig config = Line3dConfig::paper();  // the noise is independent from sample to sample
  config.trust_segment = true;
  config.sigma_p_px = 0.8;
  for (int trial = 0; trial < trials; ++trial) {
    LineScene scene = LineScene::random(random, pinhole);
    double first_t = 0, last_t = 0;
    const LineSamples samples =
        scene.noisy_samples(random, config.sigma_p_px, DepthNoise{}, &first_t, &last_t);
    // The detector's error shifts and rotates the segment against the image of the line, with the stated σ.
    Segment seen = scene.segment;
    seen.sigma_px = 0.2;
    seen.sigma_angle_rad = 0.3 / seen.length_px();
    const double shift = seen.sigma_px * test::gaussian(random);
    const double turn = seen.sigma_angle_rad * test::gaussian(random);
    const Vector2 n = seen.normal(), middle = seen.middle();
    const double half = 0.5 * seen.length_px();
    const Vector2 d = seen.direction();
    seen.a = middle - half * d + (shift - half * turn) * n;
    seen.b = middle + half * d + (shift + half * turn) * n;
    Line3d line;
    ASSERT_EQ(fit_line3d(seen, samples, pinhole, config, kSeed, line, kWithTails).outcome,
              Line3dOutcome::kOk);
    const Offsets o = across(line, scene);
    nees += o.error.dot(Vector4(test::solve_positive(o.covariance, o.error))) / trials;
    Vector6 e;
    e << line.a - scene.point_at(first_t), line.b - scene.point_at(last_t);
    nees_ends += e.dot(Vector6(test::solve_positive(line.Sigma, e))) / trials;
  }
  EXPECT_NEAR(nees, 4, half_band(trials, 4));
  RecordProperty("nees_4", std::to_string(nees));
  RecordProperty("nees_6", std::to_string(nees_ends));
  // The NEES of the ends also covers G_1 − A, the pixel noise along the segment.
  EXPECT_NEAR(nees_ends, 6, half_band(trials, 6));
}

// Depth errors are constant over runs of 8 px, like those of a Kinect. The variance under the paper's
// assumption is then wrong by the length of the run; the stated correlation corrects it.
TEST(Line3dStatistics, CorrelatedDepthErrorsAreAccountedFor) {
  Random random(22);
  const Pinhole pinhole;
  const int trials = 1000, run = 8;
  double as_paper = 0, as_stated = 0, as_seen = 0;
  for (int trial = 0; trial < trials; ++trial) {
    LineScene scene = LineScene::random(random, pinhole);
    scene.segment.sigma_px = 0.2;
    scene.segment.sigma_angle_rad = 0.001;
    LineSamples samples = scene.exact_samples();
    const double spacing = scene.segment.length_px() / (samples.count - 1);
    double error = 0;
    int cell = -1;
    for (int i = 0; i < samples.count; ++i) {
      if (static_cast<int>(i * spacing / run) != cell) {
        cell = static_cast<int>(i * spacing / run);
        error = test::gaussian(random);
      }
      LineSample& s = samples.sample[static_cast<std::size_t>(i)];
      s.depth_m += error * s.sigma_d_m;
    }
    Line3dConfig config = Line3dConfig::paper();
    for (double* nees : {&as_paper, &as_stated, &as_seen}) {
      config.depth_correlation_px = nees == &as_stated ? run : 1;
      config.trust_residuals = nees == &as_seen;
      Line3d line;
      ASSERT_EQ(fit_line3d(scene.segment, samples, pinhole, config, kSeed, line, kWithTails).outcome,
                Line3dOutcome::kOk);
      const Vector3 d = (scene.b - scene.a).normalized();
      const Vector3 across_plane = scene.a.cross(scene.b).normalized();
      const Vector3 in_plane = d.cross(across_plane);
      Matrix<2, 6> J = Matrix<2, 6>::Zero();
      J.block<1, 3>(0, 0) = J.block<1, 3>(1, 3) = in_plane.transpose();
      Vector6 e;
      e << line.a - scene.a, line.b - scene.a;
      const Vector2 error2 = J * e;
      const Matrix2 C = J * line.Sigma * J.transpose();
      *nees += error2.dot(C.inverse() * error2) / trials;
    }
  }
  EXPECT_GT(as_paper, 6);
  EXPECT_NEAR(as_stated, 2, 0.4);
  EXPECT_GT(as_seen, 1.2);  // estimated from the residuals alone, within a third
  EXPECT_LT(as_seen, 2.7);
}

// A straight border between a wall at `near` and one at `near + step`. The depth image is displaced by
// `shift` pixels across the border and is not blurred.
struct Border {
  double near_m, step_m, shift_px;
  Segment segment;
  double operator()(int x, int y) const {
    const Vector2 p(x, y);
    const double across = (p - segment.a).dot(segment.normal());
    return across > shift_px ? near_m + step_m : near_m;
  }
};

TEST(OccludingEdge, DoesNotBiasTheLineTowardsTheBackground) {
  Random random(23);
  const Pinhole pinhole;
  int plain_good = 0, good = 0, total = 0;
  for (const double step : {0.3, 0.6, 1.0, 2.0})
    for (const double shift : {-2.6, -1.5, -0.5, 0.5, 1.5, 2.6})
      for (int trial = 0; trial < 6; ++trial) {
        Border border{1 + random.uniform(), step, shift, test::random_segment(random, 40, 250)};
        const test::DepthFunction noisy{[&](int x, int y) {
          const double d = border(x, y);
          return d + DepthNoise{}.sigma(d) * test::gaussian(random);
        }};
        const Vector3 a = back_project(pinhole, border.segment.a.x(), border.segment.a.y(), border.near_m);
        const Vector3 b = back_project(pinhole, border.segment.b.x(), border.segment.b.y(), border.near_m);
        const auto is_good = [&](int reach) {
          Line3dConfig config;
          config.side_reach_px = reach;
          Line3d line;
          if (observe_line(border.segment, noisy, pinhole, DepthNoise{}, config, kSeed, line).outcome !=
              Line3dOutcome::kOk)
            return 0;
          return test::offset_from_line(line.a, a, b) < 0.03 && test::offset_from_line(line.b, a, b) < 0.03
                     ? 1
                     : 0;
        };
        ++total;
        plain_good += is_good(0);
        good += is_good(3);
      }
  EXPECT_EQ(good, total);
  EXPECT_LT(plain_good,
            total * 3 / 4);  // the paper's rule reads the background wherever the depth is displaced
}

}  // namespace
}  // namespace plvo

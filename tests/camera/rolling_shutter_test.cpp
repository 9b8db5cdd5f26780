// SPDX-License-Identifier: Apache-2.0
// Against a slow statement of the same: the point is moved in a thousand small steps from its row's exposure
// to that of the middle row.
#include "plvo/camera/rolling_shutter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

CameraModel rolling_camera(double readout_s) {
  CameraModel camera;
  camera.readout_s = readout_s;
  return camera;
}

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random.below(1'000'001)) * 1e-6;
}

Vector6 velocity_of(Random& random) {
  Vector6 velocity;
  for (int i = 0; i < 3; ++i) velocity[i] = uniform(random, -1, 1);      // m/s
  for (int i = 3; i < 6; ++i) velocity[i] = uniform(random, -1.5, 1.5);  // rad/s
  return velocity;
}

// dX/dt = v + ω × X from X(0) = p to X(seconds), by the midpoint rule.
Vector3 integrate(Vector3 p, const Vector6& velocity, double seconds) {
  constexpr int kSteps = 1000;
  const Vector3 v = velocity.head<3>();
  const Vector3 omega = velocity.tail<3>();
  const double h = seconds / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Vector3 middle = p + 0.5 * h * (v + omega.cross(p));
    p += h * (v + omega.cross(middle));
  }
  return p;
}

TEST(RollingShutter, MovesAPointToTheMiddleRowsMoment) {
  const CameraModel camera = rolling_camera(0.03);
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector6 velocity = velocity_of(random);
    const double u = uniform(random, 0, 639);
    const double v = uniform(random, 0, 479);
    const Vector3 seen = back_project(camera.pinhole, u, v, uniform(random, 0.5, 5));
    const Vector3 expected = integrate(seen, velocity, -camera.readout_s * (v / 479 - 0.5));
    const Vector3 moved = RollingShutter(camera, velocity).at_mid_exposure(seen);
    // Third order in the angle, of at most 0.04 rad.
    EXPECT_LT((moved - expected).norm(), 0.0005 * (seen - expected).norm() + 1e-6) << trial;
  }
}

TEST(RollingShutter, AsSeenIsTheWayBack) {
  const CameraModel camera = rolling_camera(0.0261);
  Random random(8);
  for (int trial = 0; trial < 200; ++trial) {
    const RollingShutter shutter(camera, velocity_of(random));
    const Vector3 seen = back_project(camera.pinhole, uniform(random, 40, 600), uniform(random, 40, 440),
                                      uniform(random, 0.5, 5));
    const Vector3 again = shutter.as_seen(shutter.at_mid_exposure(seen));
    const Vector2 error_px = project(camera.pinhole, again) - project(camera.pinhole, seen);
    EXPECT_LT(error_px.norm(), 0.05) << trial;
  }
}

TEST(RollingShutter, TheMiddleRowStays) {
  const CameraModel camera = rolling_camera(0.03);
  Vector6 velocity;
  velocity << 1, -1, 0.5, 1, 2, -1;
  const Vector3 p = back_project(camera.pinhole, 100, 239.5, 2);
  EXPECT_LT((RollingShutter(camera, velocity).at_mid_exposure(p) - p).norm(), 1e-12);
}

TEST(RollingShutter, NothingMovesWithoutOne) {
  Vector6 velocity = Vector6::Ones();
  const Vector3 p(0.3, 0.4, 1);
  EXPECT_EQ(RollingShutter().at_mid_exposure(p), p);
  EXPECT_EQ(RollingShutter(rolling_camera(0), velocity).at_mid_exposure(p), p);
  EXPECT_FALSE(RollingShutter(rolling_camera(0), velocity).active());
  const Vector3 behind(0.3, 0.4, -1);
  EXPECT_EQ(RollingShutter(rolling_camera(0.03), velocity).at_mid_exposure(behind), behind);
  EXPECT_EQ(RollingShutter(rolling_camera(0.03), velocity).as_seen(behind), behind);
}

TEST(RollingShutter, AReadoutOutOfRangeIsRefused) {
  EXPECT_TRUE(rolling_camera(0.1).validate().ok());
  for (double readout_s : {-0.001, 0.11, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(rolling_camera(readout_s).validate().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plvo

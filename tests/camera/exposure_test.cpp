// SPDX-License-Identifier: Apache-2.0
// Compares Exposure with a slow reference that moves the point in a thousand small steps from the row time of
// its row to that of the middle row.
#include "plvo/camera/exposure.hpp"

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

TEST(Exposure, MovesAPointToTheRowTimeOfTheMiddleRow) {
  const CameraModel camera = rolling_camera(0.03);
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector6 velocity = velocity_of(random);
    const double u = uniform(random, 0, 639);
    const double v = uniform(random, 0, 479);
    const Vector3 seen = back_project(camera.pinhole, u, v, uniform(random, 0.5, 5));
    const Vector3 expected = integrate(seen, velocity, -camera.readout_s * (v / 479 - 0.5));
    const Vector3 moved = Exposure(camera, velocity, 0).at_mid_exposure(seen);
    // The error is of third order in the angle, which is at most 0.04 rad.
    EXPECT_LT((moved - expected).norm(), 0.0005 * (seen - expected).norm() + 1e-6) << trial;
  }
}

TEST(Exposure, AsSeenMovesAPointBackToItsOwnRow) {
  const CameraModel camera = rolling_camera(0.0261);
  Random random(8);
  for (int trial = 0; trial < 200; ++trial) {
    const Exposure shutter(camera, velocity_of(random), 0);
    const Vector3 seen = back_project(camera.pinhole, uniform(random, 40, 600), uniform(random, 40, 440),
                                      uniform(random, 0.5, 5));
    const Vector3 again = shutter.as_seen(shutter.at_mid_exposure(seen));
    const Vector2 error_px = project(camera.pinhole, again) - project(camera.pinhole, seen);
    EXPECT_LT(error_px.norm(), 0.05) << trial;
  }
}

TEST(Exposure, DoesNotMoveAPointOfTheMiddleRow) {
  const CameraModel camera = rolling_camera(0.03);
  Vector6 velocity;
  velocity << 1, -1, 0.5, 1, 2, -1;
  const Vector3 p = back_project(camera.pinhole, 100, 239.5, 2);
  EXPECT_LT((Exposure(camera, velocity, 0).at_mid_exposure(p) - p).norm(), 1e-12);
}

TEST(Exposure, MovesNothingWithoutReadoutOrBehindTheCamera) {
  Vector6 velocity = Vector6::Ones();
  const Vector3 p(0.3, 0.4, 1);
  EXPECT_EQ(Exposure().at_mid_exposure(p), p);
  EXPECT_EQ(Exposure(rolling_camera(0), velocity, 0).at_mid_exposure(p), p);
  const Vector3 behind(0.3, 0.4, -1);
  EXPECT_EQ(Exposure(rolling_camera(0.03), velocity, 0).at_mid_exposure(behind), behind);
  EXPECT_EQ(Exposure(rolling_camera(0.03), velocity, 0).as_seen(behind), behind);
}

TEST(Exposure, DepthIsSeenWhereTheSurfaceWasAtItsTime) {
  CameraModel camera = rolling_camera(0.03);
  camera.depth_timing = {true, 0, 0.02};
  Random random(9);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector6 velocity = velocity_of(random);
    const double after = uniform(random, -0.02, 0.02);
    const double v = uniform(random, 0, 479);
    const double depth_v = uniform(random, 0, 479);
    const Vector3 p = back_project(camera.pinhole, uniform(random, 0, 639), v, uniform(random, 0.5, 5));
    const Exposure exposure(camera, velocity, after);
    EXPECT_TRUE(exposure.depth_apart());
    const double lag = after + 0.02 * (depth_v / 479 - 0.5) - 0.03 * (v / 479 - 0.5);
    const Vector3 then = exposure.at_depth_time(p, v, depth_v);
    // The error is of third order in the angle, which is at most 0.1 rad.
    EXPECT_LT((then - integrate(p, velocity, lag)).norm(), 0.002 * (then - p).norm() + 1e-6) << trial;
    // The round trip is exact to second order in the angle.
    EXPECT_LT((exposure.from_depth_time(then, v, depth_v) - p).norm(), 0.001 * (then - p).norm() + 1e-6)
        << trial;
  }
}

TEST(Exposure, AsDepthSeesUsesTheRowOfTheDepthImage) {
  CameraModel camera = rolling_camera(0.03);
  camera.depth_timing = {true, 0, 0.03};
  Random random(10);
  for (int trial = 0; trial < 200; ++trial) {
    const Exposure exposure(camera, velocity_of(random), uniform(random, -0.02, 0.02));
    const double v = uniform(random, 0, 479);
    const Vector3 p = back_project(camera.pinhole, uniform(random, 0, 639), v, uniform(random, 0.5, 5));
    const Vector2 seen = project(camera.pinhole, exposure.as_depth_sees(p, v));
    double row = v;
    for (int i = 0; i < 20; ++i) row = project(camera.pinhole, exposure.at_depth_time(p, v, row)).y();
    const Vector2 expected = project(camera.pinhole, exposure.at_depth_time(p, v, row));
    EXPECT_LT((seen - expected).norm(), 0.2) << trial;
  }
}

TEST(Exposure, DepthIsApartOnlyWhenItsTimingIsKnownAndDiffers) {
  const Vector6 velocity = Vector6::Ones();
  EXPECT_FALSE(Exposure(rolling_camera(0.03), velocity, 0.01).depth_apart());
  CameraModel together = rolling_camera(0.03);
  together.depth_timing = {true, 0, 0.03};
  EXPECT_FALSE(Exposure(together, velocity, 0).depth_apart());
  EXPECT_TRUE(Exposure(together, velocity, 1e-3).depth_apart());
}

TEST(Exposure, RejectsADepthTimingOutOfRange) {
  for (const double seconds : {-0.11, 0.11, std::numeric_limits<double>::quiet_NaN()}) {
    CameraModel camera;
    camera.depth_timing.delay_s = seconds;
    EXPECT_EQ(camera.validate().code(), StatusCode::kInvalidArgument);
    camera.depth_timing = {true, 0, seconds};
    EXPECT_EQ(camera.validate().code(), StatusCode::kInvalidArgument);
  }
}

TEST(Exposure, RejectsAReadoutOutOfRange) {
  EXPECT_TRUE(rolling_camera(0.1).validate().ok());
  for (double readout_s : {-0.001, 0.11, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(rolling_camera(readout_s).validate().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plvo

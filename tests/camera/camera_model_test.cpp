// SPDX-License-Identifier: Apache-2.0
#include "plvo/camera/camera_model.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "numeric_jacobian.hpp"

namespace plvo {
namespace {

// The Kinect of TUM's freiburg1 sequences. Its distortion is strong, and not monotonic far outside the image.
CameraModel freiburg1() {
  return {640, 480, {517.3, 516.5, 318.6, 255.3}, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
}

TEST(Pinhole, ProjectInvertsBackProject) {
  const Pinhole k{517.3, 516.5, 318.6, 255.3};
  for (double d : {0.3, 1.0, 5.0})
    EXPECT_LT((project(k, back_project(k, 12.25, 470.5, d)) - Vector2(12.25, 470.5)).norm(), 1e-12);
  EXPECT_EQ(back_project(k, k.cx, k.cy, 2), Vector3(0, 0, 2));
  EXPECT_GT(back_project(k, k.cx + 1, k.cy, 2).x(), 0) << "x points right";
  EXPECT_GT(back_project(k, k.cx, k.cy + 1, 2).y(), 0) << "y points down";
}

TEST(Pinhole, DerivativeOfProjectMatchesNumericJacobian) {
  const Pinhole k{517.3, 516.5, 318.6, 255.3};
  for (const Vector3& p : {Vector3(0.3, -0.2, 0.8), Vector3(-1.5, 1, 4)}) {
    const auto J = numeric_jacobian<2, 3>([&](const Vector3& x) { return project(k, x); }, p, 1e-5);
    EXPECT_LT((project_derivative(k, p) - J).norm(), 1e-6 * J.norm());
  }
}

TEST(Distortion, FollowsTheBrownConradyModel) {
  // Each check isolates one term at (0.3, −0.2), where r² = 0.13.
  const Vector2 ideal(0.3, -0.2);
  const auto moved = [&](const Distortion& lens) { return Vector2(distort(lens, ideal) - ideal); };
  EXPECT_LT((moved({1, 0, 0, 0, 0}) - 0.13 * ideal).norm(), 1e-15);
  EXPECT_LT((moved({0, 1, 0, 0, 0}) - 0.0169 * ideal).norm(), 1e-15);
  EXPECT_LT((moved({0, 0, 0, 0, 1}) - 0.002197 * ideal).norm(), 1e-15);
  EXPECT_LT((moved({0, 0, 1, 0, 0}) - Vector2(2 * 0.3 * -0.2, 0.13 + 2 * 0.04)).norm(), 1e-15);
  EXPECT_LT((moved({0, 0, 0, 1, 0}) - Vector2(0.13 + 2 * 0.09, 2 * 0.3 * -0.2)).norm(), 1e-15);
}

TEST(Distortion, JacobianMatchesNumericJacobian) {
  const Distortion lens = freiburg1().distortion;
  for (double x : {-0.6, -0.1, 0.0, 0.4}) {
    for (double y : {-0.5, 0.0, 0.3}) {
      Matrix2 J;
      (void)distort(lens, {x, y}, &J);
      const auto f = [&](const Vector2& p) { return distort(lens, p); };
      EXPECT_LT((J - numeric_jacobian<2, 2>(f, Vector2(x, y), 1e-5)).norm(), 1e-9) << x << " " << y;
    }
  }
}

void expect_round_trip(const CameraModel& camera, double tolerance_px) {
  for (int v = 0; v < camera.height; v += 13) {
    for (int u = 0; u < camera.width; u += 13) {
      const Vector2 px(u, v);
      EXPECT_LT((undistort_pixel(camera, distort_pixel(camera, px)) - px).norm(), tolerance_px)
          << u << " " << v;
    }
  }
}

TEST(Distortion, UndistortInvertsDistortOverTheWholeImage) {
  expect_round_trip(freiburg1(), 1e-9);
  CameraModel freiburg2{640, 480, {520.9, 521.0, 325.1, 249.7}, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}};
  expect_round_trip(freiburg2, 1e-9);
  CameraModel barrel{640, 480, {400, 400, 320, 240}, {-0.28, 0.07, 0.001, -0.001, 0}};
  expect_round_trip(barrel, 1e-9);
}

TEST(Distortion, DistortInvertsUndistortOverTheWholeSensor) {
  const CameraModel camera = freiburg1();
  for (int v = 0; v < camera.height; v += 13) {
    for (int u = 0; u < camera.width; u += 13) {
      const Vector2 px(u, v);
      EXPECT_LT((distort_pixel(camera, undistort_pixel(camera, px)) - px).norm(), 1e-9) << u << " " << v;
    }
  }
}

TEST(Distortion, ZeroDistortionMovesNoPixel) {
  CameraModel camera = freiburg1();
  camera.distortion = {};
  EXPECT_TRUE(camera.distortion.is_zero());
  EXPECT_LT((distort_pixel(camera, {17, 300}) - Vector2(17, 300)).norm(), 1e-12);
  EXPECT_LT((undistort_pixel(camera, {17, 300}) - Vector2(17, 300)).norm(), 1e-12);
}

TEST(Distortion, UndistortIsFiniteFarOutsideTheImage) {
  for (const Vector2& px : {Vector2(-1e4, -1e4), Vector2(1e6, 3), Vector2(639, 1e5)})
    EXPECT_TRUE(undistort_pixel(freiburg1(), px).allFinite()) << px.transpose();
}

TEST(Validate, AcceptsUsualCameras) {
  EXPECT_TRUE(CameraModel{}.validate().ok());
  EXPECT_TRUE(freiburg1().validate().ok()) << freiburg1().validate().message();
  CameraModel smallest{32, 32, {30, 30, 15.5, 15.5}, {}};
  EXPECT_TRUE(smallest.validate().ok());
}

struct BadCamera {
  const char* says;  // what the message must name
  void (*spoil)(CameraModel&);
};

class ValidateRefuses : public testing::TestWithParam<BadCamera> {};

TEST_P(ValidateRefuses, AnInvalidCameraAndNamesTheEntry) {
  CameraModel camera = freiburg1();
  GetParam().spoil(camera);
  const Status status = camera.validate();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(status.message()).find(GetParam().says), std::string::npos) << status.message();
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

INSTANTIATE_TEST_SUITE_P(Camera, ValidateRefuses,
                         testing::Values(BadCamera{"32", [](CameraModel& c) { c.width = 31; }},
                                         BadCamera{"32", [](CameraModel& c) { c.height = 0; }},
                                         BadCamera{"32", [](CameraModel& c) { c.height = -480; }},
                                         BadCamera{"fx", [](CameraModel& c) { c.pinhole.fx = kNan; }},
                                         BadCamera{"fx", [](CameraModel& c) { c.pinhole.fx = 0; }},
                                         BadCamera{"from 1 to 100000",
                                                   [](CameraModel& c) { c.pinhole.fx = 1e308; }},
                                         BadCamera{"fy", [](CameraModel& c) { c.pinhole.fy = 1e-300; }},
                                         BadCamera{"fy", [](CameraModel& c) { c.pinhole.fy = -516.5; }},
                                         BadCamera{"fy", [](CameraModel& c) { c.pinhole.fy = kInfinity; }},
                                         BadCamera{"cx", [](CameraModel& c) { c.pinhole.cx = 640; }},
                                         BadCamera{"cx", [](CameraModel& c) { c.pinhole.cx = kNan; }},
                                         BadCamera{"cy", [](CameraModel& c) { c.pinhole.cy = -1; }},
                                         BadCamera{"k1", [](CameraModel& c) { c.distortion.k1 = kNan; }},
                                         BadCamera{"k3", [](CameraModel& c) { c.distortion.k3 = kInfinity; }},
                                         BadCamera{"folds",
                                                   [](CameraModel& c) {
                                                     c.distortion = {-2, 0, 0, 0, 0};
                                                   }},
                                         BadCamera{"folds", [](CameraModel& c) {
                                                     c.distortion = {0, 0, 0, -1, 0};
                                                   }}));

}  // namespace
}  // namespace plvo

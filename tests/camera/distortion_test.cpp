// SPDX-License-Identifier: Apache-2.0
// Compares the lens models with OpenCV's formulas in long double, with each other's inverse over whole
// images, and with recorded fingerprints.
#include "plvo/camera/distortion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fingerprint.hpp"
#include "numeric_jacobian.hpp"
#include "plvo/camera/camera_info.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

using Real = long double;

Distortion fisheye(double k1, double k2, double k3, double k4) {
  return {.k1 = k1, .k2 = k2, .k3 = k3, .k4 = k4, .model = LensModel::kEquidistant};
}

struct NamedCamera {
  const char* name;
  CameraModel camera;
};
// Lenses that sensors report, and wider ones.
const NamedCamera kCameras[] = {
    {"rational, nearly straight",
     {1280, 720, {611, 611, 638, 367}, {0.4538, -2.5786, 0.0008, -0.0003, 1.4886, 0.3304, -2.4063, 1.4179}}},
    {"rational, a wide barrel",
     {640, 480, {210, 208, 325, 236}, {0.6, 0.05, 0.001, -0.002, 0, 0.9, 0.12, 0}}},
    {"rational, a pincushion", {640, 480, {500, 500, 320, 240}, {0.3, 0.1, 0, 0, 0, -0.05, 0.02, 0.01}}},
    {"fisheye, tracking camera", {848, 800, {286, 286, 421, 400}, fisheye(-0.0063, 0.0493, -0.0463, 0.0090)}},
    {"fisheye, plain", {640, 480, {120, 121, 318, 241}, fisheye(0, 0, 0, 0)}},
    {"fisheye, narrow", {640, 480, {600, 600, 320, 240}, fisheye(-0.2, 0.1, 0.05, -0.02)}},
};

template <typename Each>
void for_image(const CameraModel& camera, Each each) {
  for (int v = 0; v < camera.height; v += 7)
    for (int u = 0; u < camera.width; u += 7) each(Vector2(u, v));
}
Vector2 normalised(const CameraModel& camera, const Vector2& px) {
  const Pinhole& k = camera.pinhole;
  return {(px.x() - k.cx) / k.fx, (px.y() - k.cy) / k.fy};
}

void reference(const Distortion& lens, const Vector2& ideal, Real& out_x, Real& out_y) {
  const Real x = ideal.x(), y = ideal.y();
  const Real r2 = x * x + y * y;
  if (lens.model == LensModel::kEquidistant) {
    const Real r = std::sqrt(r2), theta = std::atan(r);
    const Real bent = theta * (1 + lens.k1 * std::pow(theta, 2) + lens.k2 * std::pow(theta, 4) +
                               lens.k3 * std::pow(theta, 6) + lens.k4 * std::pow(theta, 8));
    out_x = r == 0 ? x : x * bent / r;
    out_y = r == 0 ? y : y * bent / r;
    return;
  }
  const Real r4 = r2 * r2, r6 = r4 * r2;
  const Real radial =
      (1 + lens.k1 * r2 + lens.k2 * r4 + lens.k3 * r6) / (1 + lens.k4 * r2 + lens.k5 * r4 + lens.k6 * r6);
  out_x = x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x);
  out_y = y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y;
}

TEST(Lens, FollowsOpenCvsFormulas) {
  for (const NamedCamera& named : kCameras) {
    const char* name = named.name;
    const CameraModel& camera = named.camera;
    double worst = 0;
    for_image(camera, [&](const Vector2& px) {
      const Vector2 ideal = normalised(camera, px);
      Real x = 0, y = 0;
      reference(camera.distortion, ideal, x, y);
      const Vector2 got = distort(camera.distortion, ideal);
      worst = std::max(
          {worst, std::abs(static_cast<double>(got.x() - x)), std::abs(static_cast<double>(got.y() - y))});
    });
    EXPECT_LT(worst, 4e-15) << name;
  }
}

TEST(Lens, JacobianMatchesNumericJacobian) {
  for (const NamedCamera& named : kCameras) {
    const char* name = named.name;
    const CameraModel& camera = named.camera;
    for (double x : {-0.7, -0.1, 0.0, 0.4}) {
      for (double y : {-0.5, 0.0, 0.3}) {
        Matrix2 J;
        const Distortion& lens = camera.distortion;
        EXPECT_EQ(distort(lens, {x, y}, &J), distort(lens, {x, y}));
        const auto f = [&](const Vector2& p) { return distort(lens, p); };
        EXPECT_LT((J - numeric_jacobian<2, 2>(f, Vector2(x, y), 1e-5)).norm(), 2e-9) << name << x << " " << y;
      }
    }
  }
}

TEST(Lens, UndistortInvertsDistortOverTheWholeIdealImage) {
  for (const NamedCamera& named : kCameras) {
    const char* name = named.name;
    const CameraModel& camera = named.camera;
    ASSERT_TRUE(camera.validate().ok()) << name << camera.validate().message();
    for_image(camera, [&](const Vector2& px) {
      ASSERT_LT((undistort_pixel(camera, distort_pixel(camera, px)) - px).norm(), 1e-9)
          << name << ' ' << px.transpose();
    });
  }
}

TEST(Lens, DistortInvertsUndistortForRaysBelowARightAngle) {
  for (const NamedCamera& named : kCameras) {
    const char* name = named.name;
    const CameraModel& camera = named.camera;
    int none = 0;
    for_image(camera, [&](const Vector2& px) {
      const Distortion& lens = camera.distortion;
      if (lens.model == LensModel::kEquidistant) {
        const Vector2 target = normalised(camera, px);
        const double theta = 0.999 * kPi / 2, s = theta * theta;
        const double widest = theta * (1 + s * (lens.k1 + s * (lens.k2 + s * (lens.k3 + s * lens.k4))));
        if (target.norm() > widest) {
          ++none;
          const Vector2 far = undistort(lens, target);
          ASSERT_TRUE(far.allFinite() && far.norm() > 500) << name << ' ' << px.transpose();
          ASSERT_LT((far.normalized() - target.normalized()).norm(), 1e-12) << name;
          return;
        }
      }
      ASSERT_LT((distort_pixel(camera, undistort_pixel(camera, px)) - px).norm(), 1e-9)
          << name << ' ' << px.transpose();
    });
    const bool wide = camera.pinhole.fx < 300 && camera.distortion.model == LensModel::kEquidistant;
    EXPECT_EQ(none > 0, wide) << name << ' ' << none;
  }
}

TEST(Lens, ResultsAreFiniteFarOutsideTheImage) {
  for (const NamedCamera& named : kCameras)
    for (const Vector2& px : {Vector2(-1e4, -1e4), Vector2(1e6, 3), Vector2(639, 1e5), Vector2(-1e9, 1e9)}) {
      EXPECT_TRUE(undistort_pixel(named.camera, px).allFinite()) << named.name << px.transpose();
      EXPECT_TRUE(distort_pixel(named.camera, px).allFinite()) << named.name << px.transpose();
    }
}

// The denominator of the rational model must not change a bit of plumb_bob.
TEST(Lens, PlumbBobEqualsItsOwnFormulaToTheBit) {
  const Distortion lens{0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  EXPECT_TRUE(lens.is_plumb_bob());
  for_image({640, 480, {517.3, 516.5, 318.6, 255.3}, lens}, [&](const Vector2& px) {
    const double x = (px.x() - 318.6) / 517.3, y = (px.y() - 255.3) / 516.5;
    const double r2 = x * x + y * y;
    const double radial = 1 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
    const double slope = lens.k1 + r2 * (2 * lens.k2 + r2 * 3 * lens.k3);
    Matrix2 J;
    const Vector2 got = distort(lens, {x, y}, &J);
    ASSERT_EQ(got.x(), x * radial + 2 * lens.p1 * x * y + lens.p2 * (r2 + 2 * x * x));
    ASSERT_EQ(got.y(), y * radial + lens.p1 * (r2 + 2 * y * y) + 2 * lens.p2 * x * y);
    ASSERT_EQ(J(0, 0), radial + 2 * x * x * slope + 2 * lens.p1 * y + 6 * lens.p2 * x);
    ASSERT_EQ(J(1, 1), radial + 2 * y * y * slope + 6 * lens.p1 * y + 2 * lens.p2 * x);
  });
}

// The fingerprints were recorded with GCC on x86-64.
TEST(Lens, ResultsHaveTheRecordedBits) {
  Fingerprint there, back;
  for (const NamedCamera& named : kCameras)
    for_image(named.camera, [&](const Vector2& px) {
      const Vector2 raw = distort_pixel(named.camera, px), ideal = undistort_pixel(named.camera, raw);
      for (int i = 0; i < 2; ++i) {
        there.add(raw[i]);
        back.add(ideal[i]);
      }
    });
  EXPECT_EQ(there.value(), 12670850935264392294ULL);
  EXPECT_EQ(back.value(), 9630241771354188109ULL);
}

TEST(Lens, IsZeroOnlyForPlumbBobWithZeroCoefficients) {
  EXPECT_TRUE(Distortion{}.is_zero());
  EXPECT_FALSE(fisheye(0, 0, 0, 0).is_zero()) << "it bends by itself";
  EXPECT_FALSE((Distortion{.k6 = 1e-9}.is_zero()));
}

struct BadLens {
  const char* says;
  Distortion lens;
};
class LensRefused : public testing::TestWithParam<BadLens> {};

TEST_P(LensRefused, MessageNamesTheErrorAndTheRemedy) {
  CameraModel camera{640, 480, {300, 300, 320, 240}, GetParam().lens};
  const Status status = camera.validate();
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(status.message()).find(GetParam().says), std::string::npos) << status.message();
  // A camera with a narrower field of view may have the same lens.
  if (std::string(GetParam().says).find("folds") == std::string::npos) return;
  EXPECT_NE(std::string(status.message()).find("calibrate again"), std::string::npos) << status.message();
  camera.pinhole.fx = camera.pinhole.fy = 3000;
  EXPECT_TRUE(camera.validate().ok()) << camera.validate().message();
}

INSTANTIATE_TEST_SUITE_P(
    Camera, LensRefused,
    testing::Values(
        // The image corners are at r = 1.33, 53°.
        BadLens{"the rational distortion folds the image", {-0.9, 0, 0, 0, 0, -0.1, 0, 0}},
        BadLens{"the rational distortion folds the image 45 degrees",
                {0, 0, 0, 0, 0, -1, 0, 0}},  // a pole at 45°
        BadLens{"check k1 k2 p1 p2 k3 k4 k5 k6 and their order", {0, 0, 0, 0, 0, 0, 0, -0.5}},
        BadLens{"the equidistant distortion folds the image", fisheye(-0.6, 0, 0, 0)},
        BadLens{"check k1 k2 k3 k4 and their order", fisheye(0, 0, 0, -0.5)},
        BadLens{"k1 k2 k3 k4 alone", {.p1 = 0.1, .model = LensModel::kEquidistant}},
        BadLens{"k1 k2 k3 k4 alone", {.k6 = 0.1, .model = LensModel::kEquidistant}},
        BadLens{"must be numbers", {.k5 = std::numeric_limits<double>::quiet_NaN()}},
        BadLens{"must be numbers", fisheye(0, 0, 0, std::numeric_limits<double>::infinity())}));

TEST(CameraInfo, AssignsCoefficientsByTheNameOfTheModel) {
  const std::vector<double> eight{1, 2, 3, 4, 5, 6, 7, 8};
  Distortion lens;
  ASSERT_TRUE(distortion_of("rational_polynomial", eight, lens).ok());
  EXPECT_TRUE(lens.k1 == 1 && lens.k2 == 2 && lens.p1 == 3 && lens.p2 == 4 && lens.k3 == 5 && lens.k4 == 6 &&
              lens.k5 == 7 && lens.k6 == 8 && lens.model == LensModel::kRational);
  for (const char* name : {"equidistant", "fisheye"}) {
    ASSERT_TRUE(distortion_of(name, std::vector<double>{1, 2, 3, 4}, lens).ok());
    EXPECT_TRUE(lens.k1 == 1 && lens.k2 == 2 && lens.k3 == 3 && lens.k4 == 4 && lens.p1 == 0 &&
                lens.p2 == 0 && lens.model == LensModel::kEquidistant);
  }
  ASSERT_TRUE(distortion_of("plumb_bob", std::vector<double>{1, 2, 3, 4}, lens).ok());
  EXPECT_TRUE(lens.is_plumb_bob() && lens.p2 == 4 && lens.k3 == 0);
  // As librealsense names it, and its other names where there is no lens to speak of.
  ASSERT_TRUE(distortion_of("Brown Conrady", std::vector<double>{1, 2, 3, 4, 5}, lens).ok());
  EXPECT_TRUE(lens.is_plumb_bob() && lens.p2 == 4 && lens.k3 == 5);
  for (const char* name : {"Inverse Brown Conrady", "Modified Brown Conrady", "None"}) {
    lens.k1 = 1;
    ASSERT_TRUE(distortion_of(name, std::vector<double>(5), lens).ok()) << name;
    EXPECT_TRUE(lens.is_zero());
    EXPECT_EQ(distortion_of(name, std::vector<double>{0.1, 0, 0, 0, 0}, lens).code(),
              StatusCode::kUnsupported);
  }
  ASSERT_TRUE(distortion_of("", eight, lens).ok());
  EXPECT_EQ(lens.k6, 8);
  ASSERT_TRUE(distortion_of("plumb_bob", {}, lens).ok());
  EXPECT_TRUE(lens.is_zero());
  std::vector<double> fourteen = eight;
  fourteen.resize(14);
  ASSERT_TRUE(distortion_of("rational_polynomial", fourteen, lens).ok());
  EXPECT_EQ(lens.k6, 8);
}

TEST(CameraInfo, RejectsUnknownModelsAndWrongCounts) {
  Distortion lens{0.5};
  const auto refusal = [&](const char* model, std::vector<double> numbers, StatusCode code) {
    const Status status = distortion_of(model, numbers, lens);
    EXPECT_EQ(status.code(), code) << status.message();
    EXPECT_EQ(lens.k1, 0.5) << "unchanged";
    return std::string(status.message());
  };
  const auto invalid = StatusCode::kInvalidArgument, unsupported = StatusCode::kUnsupported;
  EXPECT_NE(refusal("equidistant", {1, 2, 3, 4, 5}, invalid).find("k1 k2 k3 k4, not 5"), std::string::npos);
  EXPECT_NE(refusal("equidistant", {}, invalid).find("not 0"), std::string::npos);
  EXPECT_NE(refusal("plumb_bob", std::vector<double>(8), invalid).find("rational_polynomial's"),
            std::string::npos);
  EXPECT_NE(refusal("rational_polynomial", std::vector<double>(6), invalid).find("not 6"), std::string::npos);
  EXPECT_NE(refusal("", {1}, invalid).find("4 or 5"), std::string::npos);
  EXPECT_NE(refusal("rational_polynomial", std::vector<double>(12, 0.1), unsupported).find("thin prism"),
            std::string::npos);
  EXPECT_NE(refusal("omnidirectional", {1}, unsupported).find("'omnidirectional' is not supported"),
            std::string::npos);
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Tests that the colours of the drawings stay apart for colour-blind people. Their sight is simulated by the
// matrices of Machado, Oliveira and Fernandes (IEEE TVCG 2009) for complete protanopia, deuteranopia and
// tritanopia; distances are those of CIELAB (ΔE*ab), in which 2.3 can just be noticed.
#include "plvo/report/palette.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plvo/math/se3.hpp"

namespace plvo::report {
namespace {

const Matrix3 kNormalSight = Matrix3::Identity();
const Matrix3 kProtanopia =
    (Matrix3() << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998)
        .finished();
const Matrix3 kDeuteranopia =
    (Matrix3() << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881)
        .finished();
const Matrix3 kTritanopia =
    (Matrix3() << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900)
        .finished();
const std::vector<Matrix3> kSights = {kNormalSight, kProtanopia, kDeuteranopia, kTritanopia};

// sRGB → linear light → simulated sight → CIELAB (D65).
Vector3 lab(Colour colour, const Matrix3& sight) {
  const auto linear = [](std::uint8_t level) {
    const double v = level / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const Vector3 light =
      (sight * Vector3(linear(colour.r), linear(colour.g), linear(colour.b))).cwiseMax(0.0).cwiseMin(1.0);
  const Matrix3 to_xyz =
      (Matrix3() << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505).finished();
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const Vector3 xyz = to_xyz * light;
  const double x = f(xyz.x() / 0.95047), y = f(xyz.y()), z = f(xyz.z() / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double least_distance(const std::vector<Colour>& colours) {
  double least = 1e9;
  for (const Matrix3& sight : kSights)
    for (std::size_t i = 0; i < colours.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        least = std::min(least, (lab(colours[i], sight) - lab(colours[j], sight)).norm());
  return least;
}

TEST(Palette, FeaturesStayApartForEveryKindOfSight) {
  EXPECT_GT(least_distance({kPointColour, kLineColour, kLine3dColour, kRejectedColour, kSeenColour}), 20);
}

TEST(Palette, CurvesStayApartForEveryKindOfSight) {
  EXPECT_GT(least_distance({kCurves.begin(), kCurves.end()}), 15);
}

TEST(Palette, RedAndGreenOfEqualLightnessAreFoundToBeClose) {
  EXPECT_LT(least_distance({{200, 80, 60}, {90, 140, 60}}), 15);
}

TEST(Palette, DepthGetsDarkerAllTheWay) {
  for (const Matrix3& sight : kSights) {
    double before = 100;
    for (double depth_m = kDepthNear_m; depth_m <= kDepthFar_m; depth_m += 0.1) {
      const double lightness = lab(depth_colour(depth_m), sight).x();
      EXPECT_LT(lightness, before) << depth_m;
      before = lightness;
    }
  }
  EXPECT_GT(lab(depth_colour(100), kNormalSight).x(), 15) << "far is not the black of missing depth";
  EXPECT_EQ(depth_colour(0), kDepthRamp.front());
  EXPECT_EQ(depth_colour(100), kDepthRamp.back());
}

TEST(Palette, PagesGetEveryColour) {
  const std::string css = palette_css();
  for (const char* variable :
       {"--point: #f0e442;", "--line: #56b4e9;", "--line-3d: #0072b2;", "--rejected: #d55e00;",
        "--seen: #999999;", "--curve-0: #0072b2;", "--curve-5: #56b4e9;",
        "--depth-ramp: linear-gradient(90deg, #f0e442, #009e73, #0072b2, #3c1e64);"})
    EXPECT_NE(css.find(variable), std::string::npos) << variable << '\n' << css;
}

}  // namespace
}  // namespace plvo::report

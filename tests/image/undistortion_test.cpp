// SPDX-License-Identifier: Apache-2.0
// Compares the map with the lens model distort_pixel, evaluated in double precision at every pixel.
#include "plvo/image/undistortion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gray_image.hpp"
#include "plvo/base/arena.hpp"

namespace plvo {
namespace {

using test::GrayImage;

constexpr int kBentWidth = 161;
constexpr int kBentHeight = 119;

CameraModel camera_with(const Distortion& distortion) {
  CameraModel camera;
  camera.width = kBentWidth;
  camera.height = kBentHeight;
  camera.pinhole = {135, 134, 81.2, 58.7};
  camera.distortion = distortion;
  return camera;
}
// kBarrel shows more than the ideal image, kPincushion does not contain its corners, kKinect does both.
const Distortion kBarrel{-0.25, 0.06, 0, 0, 0};
const Distortion kPincushion{0.12, 0.02, 0.002, -0.001, 0};
const Distortion kKinect{0.2624, -0.9531, -0.0054, 0.0026, 1.1633};

class Map {
 public:
  explicit Map(const CameraModel& camera)
      : memory_(static_cast<std::size_t>(camera.width * camera.height + (camera.width + camera.height) * 8 +
                                         1000)) {
    Arena arena(memory_);
    map.allocate(arena, camera.width, camera.height);
    map.init(camera);
  }
  UndistortionMap map;

 private:
  std::vector<std::byte> memory_;
};

// A bilinear read also touches the next pixel, so the last row and column count as outside of the image.
// Within one step of the map from the border both answers are right: reach = 1/32 px widens the seen area,
// −1/32 px narrows it.
bool seen(const Vector2& raw, double reach = 0) {
  return raw.x() >= -reach && raw.y() >= -reach && raw.x() < kBentWidth - 1 + reach &&
         raw.y() < kBentHeight - 1 + reach;
}
constexpr double kStep = 1.0 / 32;

double bilinear(GrayView image, const Vector2& at) {
  const int x = static_cast<int>(at.x());
  const int y = static_cast<int>(at.y());
  const double fx = at.x() - x;
  const double fy = at.y() - y;
  return (1 - fy) * ((1 - fx) * image.at(x, y) + fx * image.at(x + 1, y)) +
         fy * ((1 - fx) * image.at(x, y + 1) + fx * image.at(x + 1, y + 1));
}

TEST(Undistortion, ZeroDistortionMovesNoPixel) {
  const Map owned(camera_with({}));
  EXPECT_FALSE(owned.map.active());
  for (int y = 0; y < kBentHeight; y += 7)
    for (int x = 0; x < kBentWidth; x += 5) {
      int raw_x = -1, raw_y = -1;
      EXPECT_TRUE(owned.map.raw_pixel(x, y, raw_x, raw_y));
      EXPECT_EQ(raw_x, x);
      EXPECT_EQ(raw_y, y);
    }
}

TEST(Undistortion, ReadsTheRawImageAtTheDistortedPosition) {
  // The slopes reach 10 grey levels per pixel: an error of 1/40 px in position is a quarter of a level, and
  // the result is rounded.
  GrayImage raw(kBentWidth, kBentHeight, 6);
  raw.paint([](int x, int y) { return 128 + 50 * std::sin(0.14 * x) + 50 * std::cos(0.13 * y + 0.05 * x); });
  for (const Distortion& lens : {kBarrel, kPincushion, kKinect}) {
    const CameraModel camera = camera_with(lens);
    ASSERT_TRUE(camera.validate().ok()) << camera.validate().message();
    const Map owned(camera);
    ASSERT_TRUE(owned.map.active());
    GrayImage ideal(kBentWidth, kBentHeight, 1);
    owned.map.undistort(raw.view(), ideal.view());
    int inside = 0;
    for (int y = 0; y < kBentHeight; ++y)
      for (int x = 0; x < kBentWidth; ++x) {
        const Vector2 at = distort_pixel(camera, Vector2(x, y));
        if (!seen(at)) continue;
        ++inside;
        ASSERT_NEAR(ideal.view().at(x, y), bilinear(raw.view(), at), 0.75) << x << " " << y;
      }
    EXPECT_GT(inside, kBentWidth * kBentHeight / 2);
  }
}

// Two processors share the rows of an image; the result must not depend on the row that divides them.
TEST(Undistortion, RowsInTwoPartsEqualTheWhole) {
  GrayImage raw(kBentWidth, kBentHeight, 6);
  raw.paint([](int x, int y) { return 128 + 100 * std::sin(0.7 * x + 0.4 * y); });
  const Map owned(camera_with(kBarrel));
  GrayImage whole(kBentWidth, kBentHeight, 1);
  owned.map.undistort(raw.view(), whole.view());
  for (const int divide : {1, 8, 13, 60, kBentHeight - 1}) {
    GrayImage parts(kBentWidth, kBentHeight, 1);
    owned.map.undistort(raw.view(), parts.view(), 0, divide);
    owned.map.undistort(raw.view(), parts.view(), divide, kBentHeight);
    for (int y = 0; y < kBentHeight; ++y)
      for (int x = 0; x < kBentWidth; ++x)
        ASSERT_EQ(parts.view().at(x, y), whole.view().at(x, y)) << x << " " << y << " divided at " << divide;
  }
}

// TUM's fr1, the strongest lens of the Kinects in that data set, at both image sizes.
TEST(Undistortion, MapOfAKinectsLensIsAccurateToAFiftiethOfAPixel) {
  for (const int halvings : {0, 1}) {
    CameraModel camera;
    const double scale = 1.0 / (1 << halvings);
    camera.width = 640 >> halvings;
    camera.height = 480 >> halvings;
    camera.pinhole = {517.306408 * scale, 516.469215 * scale, 318.643040 * scale, 255.313989 * scale};
    camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
    const Map owned(camera);
    double worst = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Vector2 error = owned.map.position_px(x, y) - distort_pixel(camera, Vector2(x, y));
        worst = std::max({worst, std::abs(error.x()), std::abs(error.y())});
      }
    EXPECT_LT(worst, 0.02) << camera.width;
  }
}

// A sensor's rational lens at its own image size, and fisheyes of 130° and 180°, at all pixels that the
// camera saw.
TEST(Undistortion, MapsOfWideLensesAreAccurateToAFiftiethOfAPixel) {
  const auto fisheye = [](double k1, double k2, double k3, double k4) {
    return Distortion{.k1 = k1, .k2 = k2, .k3 = k3, .k4 = k4, .model = LensModel::kEquidistant};
  };
  for (const CameraModel& camera :
       {CameraModel{1280, 720, {611, 611, 638, 367}, {0.45, -2.58, 0.0008, -0.0003, 1.49, 0.33, -2.41, 1.42}},
        CameraModel{640, 480, {210, 208, 325, 236}, {0.6, 0.05, 0.001, -0.002, 0, 0.9, 0.12, 0}},
        CameraModel{848, 800, {286, 286, 421, 400}, fisheye(-0.0063, 0.0493, -0.0463, 0.0090)},
        CameraModel{640, 480, {203, 203, 318, 241}, fisheye(0, 0, 0, 0)}}) {
    ASSERT_TRUE(camera.validate().ok()) << camera.validate().message();
    const Map owned(camera);
    ASSERT_TRUE(owned.map.active());
    double worst = 0;
    int inside = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Vector2 at = distort_pixel(camera, Vector2(x, y));
        if (at.x() < 0 || at.y() < 0 || at.x() > camera.width || at.y() > camera.height) continue;
        ++inside;
        const Vector2 error = owned.map.position_px(x, y) - at;
        worst = std::max({worst, std::abs(error.x()), std::abs(error.y())});
      }
    EXPECT_GT(inside, camera.width * camera.height / 2);
    EXPECT_LT(worst, 0.02) << camera.width;
  }
}

// The linear map of a window equals the map at its centre and approximates it around the centre.
TEST(Undistortion, WindowsApproximateTheMap) {
  const CameraModel camera = camera_with(kBarrel);
  const Map owned(camera);
  for (int y = 20; y < kBentHeight - 20; y += 7)
    for (int x = 20; x < kBentWidth - 20; x += 5) {
      const UndistortionMap::Window window(owned.map, x, y);
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
          int raw_x = -1, raw_y = -1;
          ASSERT_TRUE(window.raw_pixel(dx, dy, raw_x, raw_y));
          const Vector2 at = distort_pixel(camera, Vector2(x + dx, y + dy));
          ASSERT_LE(std::abs(raw_x - at.x()), dx == 0 && dy == 0 ? 0.5 + kStep : 0.55);
          ASSERT_LE(std::abs(raw_y - at.y()), dx == 0 && dy == 0 ? 0.5 + kStep : 0.55);
        }
    }
}

TEST(Undistortion, RawPixelIsTheNearestOneOrNone) {
  for (const Distortion& lens : {kBarrel, kPincushion, kKinect}) {
    const CameraModel camera = camera_with(lens);
    const Map owned(camera);
    for (int y = 0; y < kBentHeight; ++y)
      for (int x = 0; x < kBentWidth; ++x) {
        const Vector2 at = distort_pixel(camera, Vector2(x, y));
        int raw_x = -1, raw_y = -1;
        const bool known = owned.map.raw_pixel(x, y, raw_x, raw_y);
        if (seen(at, -2 * kStep)) {
          ASSERT_TRUE(known) << x << " " << y;
        }
        if (!seen(at, kStep)) {
          ASSERT_FALSE(known) << x << " " << y;
        }
        if (!known) continue;
        // Half a pixel of rounding plus the error of the map.
        ASSERT_LE(std::abs(raw_x - at.x()), 0.5 + kStep);
        ASSERT_LE(std::abs(raw_y - at.y()), 0.5 + kStep);
        ASSERT_TRUE(raw_x >= 0 && raw_y >= 0 && raw_x < kBentWidth && raw_y < kBentHeight);
      }
  }
}

TEST(Undistortion, RepeatsTheNearestBorderOutsideTheRawImage) {
  GrayImage raw(kBentWidth, kBentHeight);
  raw.paint([](int x, int y) { return 128 + 50 * std::sin(0.14 * x) + 50 * std::cos(0.13 * y + 0.05 * x); });
  const CameraModel camera = camera_with(kPincushion);
  const Map owned(camera);
  GrayImage ideal(kBentWidth, kBentHeight);
  owned.map.undistort(raw.view(), ideal.view());
  int outside = 0;
  for (int y = 0; y < kBentHeight; ++y)
    for (int x = 0; x < kBentWidth; ++x) {
      const Vector2 at = distort_pixel(camera, Vector2(x, y));
      if (seen(at)) continue;
      ++outside;
      const Vector2 border(std::clamp(at.x(), 0.0, kBentWidth - 1 - kStep),
                           std::clamp(at.y(), 0.0, kBentHeight - 1 - kStep));
      ASSERT_NEAR(ideal.view().at(x, y), bilinear(raw.view(), border), 1.0) << x << " " << y;
    }
  EXPECT_GT(outside, 100);
}

}  // namespace
}  // namespace plvo

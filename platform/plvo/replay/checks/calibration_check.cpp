// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/checks/calibration_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

constexpr double kFarFromMiddle = 0.1;  // of the image's width or height
constexpr double kNearMiddle = 0.05;
constexpr double kLeastAspect = 1 / 1.05, kMostAspect = 1.05;
constexpr double kNarrowest_deg = 15, kWidest_deg = 150;

// Distance of the principal point from the middle, in widths and heights of the image; the larger of the two.
double from_middle(double cx, double cy, int width, int height) {
  return std::max(std::abs((cx + 0.5) / width - 0.5), std::abs((cy + 0.5) / height - 0.5));
}

std::string why_off_centre(const Pinhole& k, int width, int height) {
  if (from_middle(k.cy, k.cx, width, height) < kNearMiddle)
    return "cx and cy look exchanged: cx belongs to the width, cy to the height";
  if (std::min(k.cx, k.cy) < 1) return "a coordinate of 0 was probably never filled in";
  return fmt::format(
      "it is the middle of images of about {:.0f}x{:.0f}: is the calibration of another size? Take that of "
      "this size, or scale fx, fy, cx, cy",
      2 * k.cx + 1, 2 * k.cy + 1);
}

}  // namespace

std::vector<std::string> doubts_about(const CameraModel& camera, int width, int height) {
  const Pinhole& k = camera.pinhole;
  std::vector<std::string> sentences;
  if (from_middle(k.cx, k.cy, width, height) > kFarFromMiddle)
    sentences.push_back(
        fmt::format("the principal point ({:.1f}, {:.1f}) is far from the middle of {}x{} images; {}", k.cx,
                    k.cy, width, height, why_off_centre(k, width, height)));
  if (const double aspect = k.fx / k.fy; aspect < kLeastAspect || aspect > kMostAspect)
    sentences.push_back(fmt::format(
        "fx {:.1f} and fy {:.1f} differ by {:.0f} %, and pixels are nearly always square; give both "
        "as calibrated for {}x{} images",
        k.fx, k.fy, 100 * (std::max(aspect, 1 / aspect) - 1), width, height));
  const bool fisheye = camera.distortion.model == LensModel::kEquidistant;
  const double angle_deg = (fisheye ? width / k.fx : 2 * std::atan(width / (2 * k.fx))) * 180 / kPi;
  if (angle_deg < kNarrowest_deg || (angle_deg > kWidest_deg && !fisheye))
    sentences.push_back(fmt::format(
        "with fx {:.1f} an image {} pixels wide shows {:.1f} degrees, which no usual camera does; are "
        "fx and fy in pixels, and of this size?",
        k.fx, width, angle_deg));
  return sentences;
}

}  // namespace plvo

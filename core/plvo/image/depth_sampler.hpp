// SPDX-License-Identifier: Apache-2.0
// Reads the depth that belongs to a pixel of the undistorted grey image: where that pixel's surface was when
// depth was exposed, and carried back to the moment of the colour pixel (exposure.hpp). On a depth edge a
// keypoint belongs to the nearer surface (it is the nearer surface's outline), but registration and the lens
// leave the edge a pixel or two off: so a small window is looked at, a plane is fitted to the nearer
// surface's depths, and a mixed window says so.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/camera/depth_noise.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/image/undistortion.hpp"

namespace plvo {

struct DepthSample {
  double depth_m = 0;                 // 0: none
  double sigma_m = 0;                 // σ_d of equation (2), widened by what the window showed
  bool on_edge = false;               // the window holds a second surface behind this one
  Vector2 located = Vector2::Zero();  // where the depth image shows it, px
};

class DepthStretch;

class DepthSampler {
 public:
  using Stretch = DepthStretch;  // depth_stretch.hpp

  DepthSampler(const DepthView& depth, const UndistortionMap& map, const DepthNoise& noise,
               const Exposure& exposure = {})
      : depth_(depth), map_(map), noise_(noise), exposure_(exposure) {}

  // The same images, with another idea of how the camera moved while they were exposed.
  DepthSampler with(const Exposure& exposure) const { return {depth_, map_, noise_, exposure}; }

  // Where the depth image shows what the colour image shows at `pixel`; false where it cannot be known. The
  // place itself unless depth is exposed apart. expected_m: how deep that is; kUnknown: it is looked up.
  bool locate(Vector2& pixel, double expected_m) const;
  static constexpr double kUnknown = 0;
  // The same by so many guesses, from where it may be, maybe beside the image, and how deep. False where
  // that is nearer than any sensor sees, or far from the image.
  bool follow(const Vector2& pixel, int guesses, Vector2& located, double& depth_m) const;
  static constexpr int kGuesses = 2;
  static constexpr double kAssumedDepth_m = 2;
  // A depth read at `located`, as it was when colour's row v was exposed.
  double at_colour_time(double v, const Vector2& located, double depth_m) const {
    if (!exposure_.depth_apart()) return depth_m;
    return exposure_
        .from_depth_time(back_project(exposure_.pinhole(), located.x(), located.y(), depth_m), v, located.y())
        .z();
  }

  // Brings the image near, for who is about to read all over it. It mostly comes from another processor, and
  // each reading would wait for memory by itself; read in a row, it is there before it is asked for.
  void fetch() const;

  // Depth at one pixel of the depth image, in metres, 0 where there is none or (x, y) is outside the image.
  double at(int x, int y) const {
    int raw_x = 0;
    int raw_y = 0;
    if (!inside(x, y) || !map_.raw_pixel(x, y, raw_x, raw_y)) return 0;
    return depth_.data[raw_y * depth_.stride + raw_x] * depth_.metres_per_unit;
  }
  // Where at() reads, for who fetches it ahead; nullptr where it reads nothing.
  const std::uint16_t* place_of(int x, int y) const {
    int raw_x = 0;
    int raw_y = 0;
    if (!inside(x, y) || !map_.raw_pixel(x, y, raw_x, raw_y)) return nullptr;
    return depth_.data + raw_y * depth_.stride + raw_x;
  }
  // Where the raw image, before the lens is undone, holds what the depth image shows somewhere: windows are
  // read there, for what lies side by side there is what was measured.
  struct Place {
    Place(const DepthSampler& sampler, const Vector2& located);
    bool inside = false;               // both images; else the rest says nothing
    int x = 0, y = 0;                  // the nearest pixel of the raw image
    Vector2 beside = Vector2::Zero();  // how far it is beside that, px
    UndistortionMap::Window map;       // around the nearest pixel of the depth image

   private:
    Place(const DepthSampler& sampler, const Vector2& located, int ideal_x, int ideal_y);
  };
  // Depth at a pixel of the raw image, in its own units; 0: none, or outside.
  std::uint16_t raw_units(int x, int y) const { return holds_raw(x, y) ? *raw(x, y) : std::uint16_t{0}; }
  // The raw image holds the pixel; from there on it goes on by view().stride from row to row.
  bool holds_raw(int x, int y) const { return inside(x, y); }
  const std::uint16_t* raw(int x, int y) const { return depth_.data + y * depth_.stride + x; }
  bool inside(int x, int y) const {
    return static_cast<unsigned>(x) < static_cast<unsigned>(depth_.width) &&
           static_cast<unsigned>(y) < static_cast<unsigned>(depth_.height);
  }
  double metres_per_unit() const { return depth_.metres_per_unit; }

  static constexpr int kMaxRadius = 3;
  // The depth at colour pixel (u, v), inside the image, from a plane fitted to the nearer surface in the
  // window of (2·radius+1)² pixels around it; with radius 0 the one reading there. expected_m as in locate().
  DepthSample sample(double u, double v, int radius, double expected_m = kUnknown) const;

  const DepthNoise& noise() const { return noise_; }
  const Exposure& exposure() const { return exposure_; }
  const DepthView& view() const { return depth_; }
  const UndistortionMap& map() const { return map_; }

 private:
  DepthSample sample_window(const Vector2& located, int radius) const;

  DepthView depth_;
  const UndistortionMap& map_;
  DepthNoise noise_;
  Exposure exposure_;
};

}  // namespace plvo

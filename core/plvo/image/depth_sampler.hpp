// SPDX-License-Identifier: Apache-2.0
// Reads the depth of a pixel of the undistorted grey image. It reads where the surface of that pixel was when
// depth was exposed, and transforms the depth to the exposure time of the colour pixel (exposure.hpp). A
// keypoint on a depth edge belongs to the nearer surface, whose outline it is. Registration and distortion
// shift the edge by a pixel or two. The sampler therefore reads a small window, fits a plane to the depths of
// the nearer surface, and reports a window with two surfaces.
#pragma once

#include <cstdint>
#include <span>

#include "plvo/camera/depth_noise.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/image/undistortion.hpp"

namespace plvo {

struct DepthSample {
  double depth_m = 0;                 // 0: no depth
  double sigma_m = 0;                 // σ_d of equation (2), increased by slope and mixed windows
  bool on_edge = false;               // the window contains a second surface behind this one
  Vector2 located = Vector2::Zero();  // position in the depth image, px
};

class DepthStretch;

class DepthSampler {
 public:
  using Stretch = DepthStretch;  // depth_stretch.hpp

  DepthSampler(const DepthView& depth, const UndistortionMap& map, const DepthNoise& noise,
               const Exposure& exposure = {})
      : depth_(depth), map_(map), noise_(noise), exposure_(exposure) {}

  // Returns a sampler of the same images with another estimate of the camera's motion during exposure.
  DepthSampler with(const Exposure& exposure) const { return {depth_, map_, noise_, exposure}; }

  // Moves `pixel` from its position in the colour image to the position of the same surface point in the
  // depth image. Returns false if that position cannot be determined. `pixel` stays unchanged unless depth is
  // exposed at another time. expected_m: expected depth of the point; kUnknown: the depth is read from the
  // image.
  bool locate(Vector2& pixel, double expected_m) const;
  static constexpr double kUnknown = 0;
  // Does the same in `guesses` iterations. `located` (which may lie outside the image) and `depth_m` are the
  // initial values and receive the result. Returns false if the point is nearer than any sensor sees, or far
  // from the image.
  bool follow(const Vector2& pixel, int guesses, Vector2& located, double& depth_m) const;
  static constexpr int kGuesses = 2;
  static constexpr double kAssumedDepth_m = 2;
  // Transforms a depth read at `located` to the exposure time of colour's row v.
  double at_colour_time(double v, const Vector2& located, double depth_m) const {
    if (!exposure_.depth_apart()) return depth_m;
    return exposure_
        .from_depth_time(back_project(exposure_.pinhole(), located.x(), located.y(), depth_m), v, located.y())
        .z();
  }

  // Loads the depth image into the cache before many scattered reads. The image usually comes from another
  // processor, and each read would wait for memory by itself. Sequential reads allow the processor to
  // prefetch.
  void fetch() const;

  // Depth at one pixel of the depth image, in metres. 0 if there is no depth or (x, y) is outside the image.
  double at(int x, int y) const {
    int raw_x = 0;
    int raw_y = 0;
    if (!inside(x, y) || !map_.raw_pixel(x, y, raw_x, raw_y)) return 0;
    return depth_.data[raw_y * depth_.stride + raw_x] * depth_.metres_per_unit;
  }
  // The same; a missing reading is replaced by sample_between().
  double near(int x, int y) const;
  // Address that at() reads, for prefetching; nullptr if at() reads nothing.
  const std::uint16_t* place_of(int x, int y) const {
    int raw_x = 0;
    int raw_y = 0;
    if (!inside(x, y) || !map_.raw_pixel(x, y, raw_x, raw_y)) return nullptr;
    return depth_.data + raw_y * depth_.stride + raw_x;
  }
  // Position in the raw depth image (before undistortion) of a position in the undistorted image. Windows are
  // read in the raw image, because its adjacent pixels are adjacent measurements.
  struct Place {
    Place(const DepthSampler& sampler, const Vector2& located);
    bool inside = false;               // inside both images; otherwise the other members are invalid
    int x = 0, y = 0;                  // nearest pixel of the raw image
    Vector2 beside = Vector2::Zero();  // offset from that pixel, px
    UndistortionMap::Window map;       // the map around the nearest pixel of the depth image

   private:
    Place(const DepthSampler& sampler, const Vector2& located, int ideal_x, int ideal_y);
  };
  // Depth at a pixel of the raw image, in the image's units. 0 if there is no depth or the pixel is outside.
  std::uint16_t raw_units(int x, int y) const { return holds_raw(x, y) ? *raw(x, y) : std::uint16_t{0}; }
  // True if the raw image contains the pixel. Rows are view().stride elements apart.
  bool holds_raw(int x, int y) const { return inside(x, y); }
  const std::uint16_t* raw(int x, int y) const { return depth_.data + y * depth_.stride + x; }
  bool inside(int x, int y) const {
    return static_cast<unsigned>(x) < static_cast<unsigned>(depth_.width) &&
           static_cast<unsigned>(y) < static_cast<unsigned>(depth_.height);
  }
  double metres_per_unit() const { return depth_.metres_per_unit; }

  static constexpr int kMaxRadius = 3;
  // Depth at colour pixel (u, v), which must be inside the image. A plane is fitted to the nearer surface in
  // the window of (2·radius+1)² pixels around it; with radius 0 the single reading is used. If more than half
  // of the window has no depth, the result is sample_between(). expected_m as in locate().
  DepthSample sample(double u, double v, int radius, double expected_m = kUnknown) const;

  // Depth at a pixel of the raw image, plus an offset in px, where readings are missing: a plane fitted to
  // the nearer surface in the largest window. Readings of this surface must surround the pixel; otherwise the
  // result is no depth. Beside an edge, in the Kinect's shadow, they do not.
  DepthSample sample_between(int x, int y, const Vector2& beside = Vector2::Zero()) const;

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

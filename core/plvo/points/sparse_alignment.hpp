// SPDX-License-Identifier: Apache-2.0
// Sparse image alignment: estimates the motion that maps small windows of one image to another, all windows
// at once (Forster, Pizzoli, Scaramuzza, "SVO: Fast semi-direct monocular visual odometry", ICRA 2014,
// section IV.A). A single window converges from a distance of a pixel or two; a hundred windows that move as
// one rigid scene converge from many pixels. Alignment starts on a coarse pyramid level, because the
// predicted motion may be poor, and continues on the keypoints' own levels. Each window has its own gain and
// offset, because the illumination may change locally. The result predicts where to register the features
// (alignment.hpp); it is not a measurement itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/image/image_mask.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// Columns and rows −4 … 3 around a whole pixel at the keypoint.
inline constexpr int kAlignmentSide = 8;
inline constexpr int kAlignmentPixels = kAlignmentSide * kAlignmentSide;
inline constexpr std::size_t kMostAlignmentWindows = 128;
// A step is trusted if this many windows agree, about three per motion parameter, and if most of the visible
// windows agree. A window disagrees if its part of the scene has changed or its position is wrong.
inline constexpr int kLeastAgreeingWindows = 20;
inline constexpr double kLeastAgreeingShare = 0.5;

struct AlignmentWindow {
  // Grey levels and their derivatives per pixel, in 1/8 of a grey level.
  std::array<std::int16_t, kAlignmentPixels> value, gx, gy;
  int level;
  double sum_value, sum_gx, sum_gy;
  // With gain and offset eliminated: the information matrix of the position, and the correlation of gradients
  // and grey levels, which is the part that the gain takes.
  Matrix2 information;
  Vector2 with_gain;
  double contrast;       // Σ (value − mean)²
  Vector2 centre;        // keypoint relative to the whole pixel, px of the level
  std::size_t keypoint;  // index
};

// Result of one step: the number of windows inside the image, the number of those that agree with their
// appearance in the reference, and the largest component of the step (m or rad).
struct AlignmentStep {
  int seen = 0;
  int agreeing = 0;
  double size = 0;
  bool trusted() const { return agreeing >= kLeastAgreeingWindows && agreeing >= kLeastAgreeingShare * seen; }
};

class SparseAlignment {
 public:
  constexpr void allocate(Arena& memory, int width, int height) {
    for (int level = 0; level < kLevel; ++level) {
      width = (width + 1) / 2;
      height = (height + 1) / 2;
    }
    storage_ = memory.take<std::uint8_t>("image to align with",
                                         static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }
  static constexpr std::span<AlignmentWindow> take_windows(Arena& memory) {
    return memory.take<AlignmentWindow>("alignment windows", kMostAlignmentWindows);
  }

  // Copies the image of the frame with this stamp. Windows are cut from it until the next call.
  void keep(const Pyramid& pyramid, std::int64_t stamp_ns);
  bool holds(std::int64_t stamp_ns) const { return image_.data != nullptr && stamp_ns == stamp_ns_; }

  // Cuts windows around the keypoints of that frame, or around every n-th if they exceed the capacity:
  // cut_coarse from the kept image, cut_fine from the keypoints' patches. Windows at the border, without
  // texture or on masked pixels are left out.
  std::span<AlignmentWindow> cut_coarse(const PointFeatures& features, std::span<AlignmentWindow> capacity,
                                        const ImageMask& mask = {}) const;
  static std::span<AlignmentWindow> cut_fine(const PointFeatures& features,
                                             std::span<AlignmentWindow> capacity);

 private:
  static constexpr int kLevel = 2;
  std::span<std::uint8_t> storage_;
  GrayView image_;
  std::int64_t stamp_ns_ = 0;
};

// One Gauss–Newton step. Replaces T_current_reference by the improved motion. points: those of the keypoints,
// at the reference's mid-exposure. Windows that reach into the mask are not seen. Returns false and leaves T
// unchanged if the visible windows do not determine it.
bool align_step(std::span<const AlignmentWindow> windows, std::span<const Point3d> points,
                const Pinhole& pinhole, const Exposure& exposure, const Pyramid& pyramid,
                Se3& T_current_reference, AlignmentStep& step, const ImageMask& mask = {});

}  // namespace plvo

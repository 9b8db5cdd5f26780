// SPDX-License-Identifier: Apache-2.0
// Sparse image alignment: the motion that takes small windows of one frame's image to where they are in
// another's, all of them at once (Forster, Pizzoli, Scaramuzza, "SVO: Fast semi-direct monocular visual
// odometry", ICRA 2014, section IV.A). One window alone finds its way over a pixel or two; a hundred that
// move as one rigid scene find it over many. First on a coarse level of the pyramid, for the motion may be
// predicted badly, then on the keypoints' own. Each window has a gain and an offset of its own, since the
// light on one place may change while that on another does not. The result says where to register the
// features (alignment.hpp) and is no measurement itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/image/pyramid.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// Columns and rows −4 … 3 about a whole pixel next to a keypoint.
inline constexpr int kAlignmentSide = 8;
inline constexpr int kAlignmentPixels = kAlignmentSide * kAlignmentSide;
inline constexpr std::size_t kMostAlignmentWindows = 128;
// A step is trusted when so many windows, three or so for each of the motion's parameters, look as they did;
// and when most do: what the others show has gone or was never where it seemed to be.
inline constexpr int kLeastAgreeingWindows = 20;
inline constexpr double kLeastAgreeingShare = 0.5;

struct AlignmentWindow {
  // Grey levels and their derivatives per pixel, in 1/8 of a grey level.
  std::array<std::int16_t, kAlignmentPixels> value, gx, gy;
  int level;
  double sum_value, sum_gx, sum_gy;
  // With gain and offset eliminated: the information about the position, and what the gain takes of it.
  Matrix2 information;
  Vector2 with_gain;
  double contrast;       // Σ (value − mean)²
  Vector2 centre;        // the keypoint relative to the whole pixel, px of the level
  std::size_t keypoint;  // index
};

// What a step found: windows inside the image, those of them that look as they did, and the step itself
// (m and rad, the largest component).
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

  // The image that windows are cut from, until the next call: of the frame with this stamp.
  void keep(const Pyramid& pyramid, std::int64_t stamp_ns);
  bool holds(std::int64_t stamp_ns) const { return image_.data != nullptr && stamp_ns == stamp_ns_; }

  // Windows around keypoints of that frame, evenly as many of them as there is capacity for: of that image,
  // or of the keypoints' patches. Those that lie at the border or show nothing are left out.
  std::span<AlignmentWindow> cut_coarse(const PointFeatures& features,
                                        std::span<AlignmentWindow> capacity) const;
  static std::span<AlignmentWindow> cut_fine(const PointFeatures& features,
                                             std::span<AlignmentWindow> capacity);

 private:
  static constexpr int kLevel = 2;
  std::span<std::uint8_t> storage_;
  GrayView image_;
  std::int64_t stamp_ns_ = 0;
};

// One Gauss–Newton step of T_current_reference, which is replaced. points: of the keypoints, at the
// reference's mid-exposure. False, and T is untouched, when the windows that are seen do not determine it.
bool align_step(std::span<const AlignmentWindow> windows, std::span<const Point3d> points,
                const Pinhole& pinhole, const Exposure& exposure, const Pyramid& pyramid,
                Se3& T_current_reference, AlignmentStep& step);

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// The parts of the image that travel with the camera: the robot's own bumper, text burnt into the image, dots
// that the camera's projector throws on the scene. Their features are found again at the same pixels while
// the rest of the image flows. They contradict the motion of the camera, so keypoints there have no 3D point.
//
// The image is divided into cells, and each cell has a vote. A frame that becomes a reference raises the vote
// of a cell in which more features stayed at their pixels than moved along with the scene, and lowers that of
// a cell in which features moved along. A world that is at rest in the image changes no vote. All votes fall
// slowly: no points are searched in carried cells, so they are tried again from time to time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "plvo/math/types.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// A rectangle of pixels: columns left … right − 1 and rows top … bottom − 1.
struct PixelBounds {
  int left = 0, top = 0, right = 0, bottom = 0;
};

class CarriedCells {
 public:
  static constexpr int kColumns = 16;
  static constexpr int kRows = 12;
  static constexpr std::size_t kCells = static_cast<std::size_t>(kColumns) * kRows;
  // Numbers of features of one frame, by cell.
  using Counts = std::array<std::uint16_t, kCells>;

  // For images of this size, in pixels; no cell is carried.
  void init(int width, int height);
  void forget();

  // Takes in a frame. stayed: features that are found at the same pixels, although the camera's motion moves
  // them; moved: features that are found where that motion puts them.
  void vote(const Counts& stayed, const Counts& moved);
  // Takes in a frame that alone is certain: the cells with features that stayed, and the cells beside them,
  // are carried at once. is_light: what stayed is light that the camera throws on the scene.
  void mark_carried(const Counts& stayed, bool is_light);
  // Whether light was found: carried cells may then show the scene as well.
  bool has_light() const { return has_light_; }

  // The cell of a pixel; of one outside the image, the nearest cell.
  std::size_t cell_of(const Vector2& pixel) const;
  std::size_t cell_of(const Keypoint& keypoint) const {
    return cell_of(Vector2(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v)));
  }
  bool is_carried(const Vector2& pixel) const { return count_ > 0 && votes_[cell_of(pixel)] >= kCarried; }
  bool is_carried(const Keypoint& keypoint) const {
    return count_ > 0 && votes_[cell_of(keypoint)] >= kCarried;
  }
  // Number of carried cells, and the smallest rectangle that contains them.
  int count() const { return count_; }
  PixelBounds bounds() const;
  // True when carried cells are found, and again when there are more than twice as many as the last time.
  bool take_news();

  // Removes the 3D points of the keypoints in carried cells.
  void remove_points(PointFeatures& points) const;

 private:
  // A cell is carried when its vote reaches kCarried: three references agree. After kMemory references all
  // votes fall by one.
  static constexpr std::uint8_t kCarried = 3;
  static constexpr std::uint8_t kMost = 12;
  static constexpr int kMemory = 30;

  void count_carried();

  std::array<std::uint8_t, kCells> votes_{};
  int count_ = 0;
  int told_ = 0;        // count_ when take_news() last returned true
  int references_ = 0;  // since the votes fell
  int width_ = 1, height_ = 1;
  bool has_light_ = false;
};

}  // namespace plvo

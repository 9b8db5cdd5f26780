// SPDX-License-Identifier: Apache-2.0
// A deterministic RGB-D sequence without files: a camera moves and rotates inside a box-shaped room whose
// walls carry textured tiles (corners) and dark strips (lines). Only + − × ÷ and integer hashes, so every
// machine renders the same bytes; through the same lens that its camera() states. Depth in millimetres with
// steps, noise and holes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plvo/base/arena.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

// Renders into memory that the caller owns: for boards without a heap.
class ProceduralRenderer {
 public:
  // Bytes that init needs for images of this size.
  static constexpr std::size_t required_bytes(int width, int height) {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return array_bytes(pixels, sizeof(Vector3)) + array_bytes(3 * pixels, 1) + array_bytes(pixels, 2) +
           kArenaAlignment;
  }

  // False when the memory is too small.
  bool init(int width, int height, std::span<std::byte> memory);

  const CameraModel& camera() const { return camera_; }
  // Exact pose of frame i: about 13 mm and 0.7° from the frame before.
  static Se3 T_world_camera(int i);
  static std::int64_t stamp_ns(int i) { return 1'000'000'000 + i * 33'333'333LL; }

  static constexpr double kNoMirror = 1e9;

  // Frame i, or a frame in which there is nothing to see (black, no depth). Valid until the next call; takes
  // no memory. mirror_m: an invisible pane stands across the room, at this z in m. Depth is that of the pane,
  // colour what lies behind it, as in a mirror.
  RgbdFrame render(int i, double mirror_m = kNoMirror);
  RgbdFrame render_dark(int i);

 private:
  RgbdFrame frame(int i) const;

  CameraModel camera_;
  std::span<Vector3> rays_;  // of the pixels' centres, camera frame, z = 1
  std::span<std::uint8_t> colour_;
  std::span<std::uint16_t> depth_;
};

// The same with memory of its own.
class ProceduralSequence : public ProceduralRenderer {
 public:
  ProceduralSequence(int width, int height) : memory_(required_bytes(width, height)) {
    (void)init(width, height, memory_);
  }
  ProceduralSequence(const ProceduralSequence&) = delete;
  ProceduralSequence& operator=(const ProceduralSequence&) = delete;

 private:
  std::vector<std::byte> memory_;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// A deterministic RGB-D sequence without files: a camera walks and turns inside a box-shaped room whose walls
// carry textured tiles (corners) and dark strips (lines). Only + − × ÷ and integer hashes, so every machine
// renders the same bytes; through the same lens that its camera() states. Depth in millimetres with steps,
// noise and holes.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/camera/camera_model.hpp"
#include "plvo/image/frame.hpp"
#include "plvo/math/se3.hpp"

namespace plvo {

class ProceduralSequence {
 public:
  ProceduralSequence(int width, int height);

  const CameraModel& camera() const { return camera_; }
  // Exact pose of frame i: about 13 mm and 0.7° from the frame before.
  static Se3 T_world_camera(int i);
  static std::int64_t stamp_ns(int i) { return 1'000'000'000 + i * 33'333'333LL; }

  // Frame i, or a frame in which there is nothing to see (black, no depth). Valid until the next call; takes
  // no memory.
  RgbdFrame render(int i);
  RgbdFrame render_dark(int i);

 private:
  RgbdFrame frame(int i) const;

  CameraModel camera_;
  std::vector<Vector3> rays_;  // of the pixels' centres, camera frame, z = 1
  std::vector<std::uint8_t> colour_;
  std::vector<std::uint16_t> depth_;
};

}  // namespace plvo

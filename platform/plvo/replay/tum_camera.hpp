// SPDX-License-Identifier: Apache-2.0
// A recorded TUM folder as a camera. Every buffer is made by open(): one colour image, one depth image, and
// the bytes of the largest file; the views in a frame point into them. Pacing is PacedCamera's work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/calibration.hpp"
#include "plvo/replay/image_decoder.hpp"
#include "plvo/replay/tum_index.hpp"

namespace plvo {

struct TumOptions {
  std::int64_t tolerance_ns = 20'000'000;  // largest difference of the stamps in a pair
  std::filesystem::path associations;      // instead of rgb.txt and depth.txt
  std::size_t first_frame = 0;             // of the pairs: [first_frame, end_frame)
  std::size_t end_frame = std::numeric_limits<std::size_t>::max();
};

class TumCamera final : public RgbdCamera {
 public:
  // Reads the lists, checks the first readable pair (sizes, bits) and the calibration against it. All of what
  // read_tum_index returns, and kInvalidArgument for an empty frame range, images of different sizes, 8-bit
  // depth, or a calibration that does not fit.
  Status open(const std::filesystem::path& folder, const Calibration& calibration,
              const TumOptions& options = {});

  CameraModel model() const override { return model_; }
  // kDamaged, with the file and why, for a pair that cannot be decoded; the next call goes on after it.
  Status next(RgbdFrame& frame) override;

  std::size_t frame_count() const { return index_.pairs.size(); }  // in the chosen range
  const TumIndex& index() const { return index_; }
  double depth_units_per_metre() const { return depth_units_per_metre_; }

 private:
  Status choose_range(const TumOptions& options);
  Status find_image_size();
  void allocate();

  std::filesystem::path folder_;
  TumIndex index_;
  CameraModel model_;
  double depth_units_per_metre_ = kTumDepthUnitsPerMetre;
  ImageDecoder decoder_;
  std::vector<std::uint8_t> colour_;
  std::vector<std::uint16_t> depth_;
  std::size_t next_ = 0;
};

}  // namespace plvo

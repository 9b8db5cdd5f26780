// SPDX-License-Identifier: Apache-2.0
// A recorded folder as a camera. Every buffer is made by open(): the images as they are in the files and as
// they are given, and the bytes of the largest file; the views in a frame point into them. Images that are
// larger than the core takes, or that one asks for smaller, are scaled down (image_reduction.hpp). Pacing is
// PacedCamera's work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/calibration.hpp"
#include "plvo/replay/image_decoder.hpp"
#include "plvo/replay/image_reduction.hpp"
#include "plvo/replay/sequence_index.hpp"

namespace plvo {

class RecordedCamera final : public RgbdCamera {
 public:
  // Finds the frames, checks the first readable pair (sizes, bits) and the calibration against it. What the
  // calibration leaves unsaid, the layout says: numbered frames have depth in millimetres. All of what
  // read_sequence_index returns, and kInvalidArgument for an empty frame range, depth of which nobody says
  // how it goes with colour, 8-bit depth, a calibration that does not fit (the images in the files), or a
  // scale_down that does not.
  Status open(const std::filesystem::path& folder, const Calibration& calibration,
              const SequenceOptions& options = {});

  CameraModel model() const override { return calibration_.camera; }
  // kDamaged, with the file and why, for a pair that cannot be decoded; the next call goes on after it.
  Status next(RgbdFrame& frame) override;

  std::size_t frame_count() const { return index_.pairs.size(); }  // in the chosen range
  const SequenceIndex& index() const { return index_; }
  const Calibration& calibration() const { return calibration_; }  // in force; with the size of the frames
  // Of the colour images in the files; after an open() that failed without a word on scale_down, of width 0.
  const WholeImage& whole_image() const { return whole_; }
  // "… are scaled down …", where nobody asked for it; else empty.
  const std::string& remark() const { return remark_; }

 private:
  Status choose_range(const SequenceOptions& options);
  Status find_image_sizes(ImageInfo& colour, ImageInfo& depth);
  Status choose_scale(const ImageInfo& colour, int scale_down);
  // Depth of its own size or camera; refused where the calibration does not say how it goes with colour.
  Status choose_registration(const ImageInfo& colour, const ImageInfo& depth);
  void allocate();

  std::filesystem::path folder_;
  SequenceIndex index_;
  Calibration calibration_;
  ImageDecoder decoder_;
  WholeImage whole_;
  std::string remark_;
  std::vector<std::uint8_t> whole_colour_;  // where it is scaled down
  std::vector<std::uint8_t> colour_;
  std::vector<std::uint16_t> depth_;
  int depth_width_ = 0, depth_height_ = 0;  // of the files
  bool registers_ = false;
  DepthRegistration registration_;
  std::vector<std::uint16_t> raw_depth_;  // where it registers
  std::size_t next_ = 0;
};

}  // namespace plvo

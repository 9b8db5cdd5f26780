// SPDX-License-Identifier: Apache-2.0
// A recorded folder as a camera. open() allocates every buffer: the pixels (images/frame_fit.hpp) and the
// bytes of the largest file; the views in a frame point into them. PacedCamera controls the pace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/images/frame_fit.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/index/sequence_index.hpp"

namespace plvo {

class RecordedCamera final : public RgbdCamera {
 public:
  // Finds the frames and checks the first readable pair (sizes, bits) and the calibration against it. Where
  // the calibration has no depth scale, the layout determines it: numbered frames have depth in millimetres.
  // Returns the errors of read_sequence_index, and kInvalidArgument for an empty frame range, depth without a
  // specified relation to colour, 8-bit depth, a calibration that does not fit the images in the files, or a
  // scale_down that does not fit.
  Status open(const std::filesystem::path& folder, const Calibration& calibration,
              const SequenceOptions& options = {});

  CameraModel model() const override { return calibration().camera; }
  // Returns kDamaged, with the file and the reason, for a pair that cannot be decoded; the next call
  // continues after it.
  Status next(RgbdFrame& frame) override;

  std::size_t frame_count() const { return index_.pairs.size(); }  // in the chosen range
  const SequenceIndex& index() const { return index_; }
  // See FrameFit for these three.
  const Calibration& calibration() const { return fit_.calibration(); }
  const WholeImage& whole_image() const { return fit_.whole_image(); }
  const std::string& remark() const { return fit_.remark(); }

 private:
  Status choose_range(const SequenceOptions& options);
  Status find_image_sizes(ImageInfo& colour, ImageInfo& depth);
  void warm_up();

  std::filesystem::path folder_;
  SequenceIndex index_;
  ImageDecoder decoder_;
  FrameFit fit_;
  ImageSize depth_size_;  // of the files
  std::size_t next_ = 0;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/recorded_camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace plvo {

namespace fs = std::filesystem;

constexpr std::uint16_t kNoDepthInMillimetres = 65535;  // in 7-Scenes

Status RecordedCamera::open(const fs::path& folder, const Calibration& calibration,
                            const SequenceOptions& options) {
  folder_ = folder;
  next_ = 0;
  if (Status status = read_sequence_index(folder, options, index_); !status.ok()) return status;
  if (Status status = choose_range(options); !status.ok()) return status;
  int width = 0;
  int height = 0;
  if (Status status = find_image_size(width, height); !status.ok()) return status;
  if (Status status = calibration.validate(width, height); !status.ok()) return status;
  calibration_ = calibration;
  calibration_.camera.width = width;
  calibration_.camera.height = height;
  calibration_.has_size = true;
  if (index_.numbered && !calibration.depth_scale_given) {
    calibration_.depth_units_per_metre = 1000;
    calibration_.depth_scale_given = true;
  }
  allocate();
  return {};
}

Status RecordedCamera::choose_range(const SequenceOptions& options) {
  const std::size_t end = std::min(options.end_frame, index_.pairs.size());
  if (options.first_frame >= end) {
    return {StatusCode::kInvalidArgument, fmt::format("the frame range is empty; {} has frames 0:{}",
                                                      folder_.string(), index_.pairs.size())};
  }
  index_.pairs.resize(end);
  index_.pairs.erase(index_.pairs.begin(),
                     index_.pairs.begin() + static_cast<std::ptrdiff_t>(options.first_frame));
  return {};
}

// The first pair whose two headers can be read decides. A single damaged file must not stop a sequence; a
// sequence that is wrong throughout must be refused before anything is written.
Status RecordedCamera::find_image_size(int& width, int& height) {
  Status first_failure;
  for (const ImagePair& pair : index_.pairs) {
    ImageInfo colour, depth;
    Status status = decoder_.read_header(folder_ / pair.colour.file, colour);
    if (status.ok()) status = decoder_.read_header(folder_ / pair.depth.file, depth);
    if (status.ok()) {
      if (colour.bits == 16 && colour.grey && depth.bits == 8) {
        return {
            StatusCode::kInvalidArgument,
            fmt::format("{} is depth and {} is colour: the associations name depth first; write each line as "
                        "'stamp rgb stamp depth'",
                        pair.colour.file, pair.depth.file)};
      }
      if (depth.bits != 16 || !depth.grey) {
        return {StatusCode::kInvalidArgument,
                fmt::format(
                    "{} has {} bits per channel{}; depth must be a 16-bit grey PNG (export it again without "
                    "converting to 8 bits or to colour)",
                    pair.depth.file, depth.bits, depth.grey ? "" : " and colour")};
      }
      if (colour.width != depth.width || colour.height != depth.height) {
        return {
            StatusCode::kInvalidArgument,
            fmt::format(
                "colour is {}x{} but depth is {}x{} ({}); depth must be registered to colour and have its "
                "size (ScanNet: export colour at the size of depth)",
                colour.width, colour.height, depth.width, depth.height, pair.depth.file)};
      }
      width = colour.width;
      height = colour.height;
      return {};
    }
    if (first_failure.ok()) first_failure = status;
  }
  const bool too_large = first_failure.code() == StatusCode::kInvalidArgument;
  return Status(too_large ? StatusCode::kInvalidArgument : StatusCode::kDamaged,
                "no image of the sequence can be read; ")
      .append(first_failure.message());
}

void RecordedCamera::allocate() {
  std::uintmax_t largest = 0;
  for (const ImagePair& pair : index_.pairs) {
    for (const std::string& file : {pair.colour.file, pair.depth.file}) {
      std::error_code error;
      const std::uintmax_t bytes = fs::file_size(folder_ / file, error);
      if (!error && bytes <= kMaxImageBytes) largest = std::max(largest, bytes);
    }
  }
  decoder_.reserve(largest);
  const std::size_t pixels =
      static_cast<std::size_t>(model().width) * static_cast<std::size_t>(model().height);
  colour_.assign(pixels * 3, 0);
  depth_.assign(pixels, 0);
  // One decoding beforehand lets the image libraries take, here and not in the first frame, what they take.
  RgbdFrame first;
  [[maybe_unused]] const Status told_again_by_the_first_call = next(first);
  next_ = 0;
}

Status RecordedCamera::next(RgbdFrame& frame) {
  if (next_ >= index_.pairs.size()) return {StatusCode::kEndOfStream, "the sequence ends here"};
  const ImagePair& pair = index_.pairs[next_++];
  frame.stamp_ns = pair.colour.stamp_ns;  // also of a frame that turns out to be damaged
  frame.depth_stamp_ns = pair.depth.stamp_ns;
  const auto [width, height] = std::pair(model().width, model().height);
  Status status = decoder_.decode_rgb(folder_ / pair.colour.file, width, height, colour_);
  if (status.ok()) status = decoder_.decode_depth(folder_ / pair.depth.file, width, height, depth_);
  if (!status.ok()) return {StatusCode::kDamaged, status.message()};

  if (index_.numbered) std::replace(depth_.begin(), depth_.end(), kNoDepthInMillimetres, std::uint16_t{0});
  frame.colour = {colour_.data(), width, height, width * std::ptrdiff_t{3}, PixelFormat::kRgb8};
  frame.depth = {depth_.data(), width, height, width, 1.0 / calibration_.depth_units_per_metre};
  return {};
}

}  // namespace plvo

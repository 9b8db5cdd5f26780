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
  whole_ = {};
  if (Status status = read_sequence_index(folder, options, index_); !status.ok()) return status;
  if (Status status = choose_range(options); !status.ok()) return status;
  ImageInfo colour, depth;
  if (Status status = find_image_sizes(colour, depth); !status.ok()) return status;
  calibration_ = calibration;
  if (Status status = choose_registration(colour, depth); !status.ok()) return status;
  if (Status status = calibration.validate(colour.width, colour.height); !status.ok()) return status;
  calibration_.camera.width = colour.width;
  calibration_.camera.height = colour.height;
  if (Status status = choose_scale(colour, options.scale_down); !status.ok()) return status;
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
Status RecordedCamera::find_image_sizes(ImageInfo& colour, ImageInfo& depth) {
  Status first_failure;
  for (const ImagePair& pair : index_.pairs) {
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
      return {};
    }
    if (first_failure.ok()) first_failure = status;
  }
  const bool too_large = first_failure.code() == StatusCode::kInvalidArgument;
  return Status(too_large ? StatusCode::kInvalidArgument : StatusCode::kDamaged,
                "no image of the sequence can be read; ")
      .append(first_failure.message());
}

Status RecordedCamera::choose_registration(const ImageInfo& colour, const ImageInfo& depth) {
  depth_width_ = depth.width;
  depth_height_ = depth.height;
  const bool same_size = colour.width == depth.width && colour.height == depth.height;
  registers_ = calibration_.depth_camera.known || !same_size;
  if (same_size || calibration_.depth_camera.known) return {};
  // The calibration must be known to be colour's: that of a smaller depth image would be read without a word.
  if (calibration_.has_size &&
      DepthRegistration::same_view(colour.width, colour.height, depth.width, depth.height))
    return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("colour is {}x{} but depth is {}x{}; export colour at the size of depth, or say in the "
                      "calibration width and height of colour, where both have one view, or depth's camera: "
                      "depth_fx depth_fy depth_cx depth_cy (docs/formats.md)",
                      colour.width, colour.height, depth.width, depth.height)};
}

Status RecordedCamera::choose_scale(const ImageInfo& colour, int scale_down) {
  const int factor = scale_down != 0 ? scale_down : least_reduction(colour.width, colour.height);
  whole_ = {factor, colour.width, colour.height};
  if (Status status = check_reduction(factor, colour.width, colour.height); !status.ok()) return status;
  calibration_.camera = reduced(calibration_.camera, factor);
  registers_ |= factor > 1;
  remark_.clear();
  if (scale_down == 0 && factor > 1)
    remark_ = fmt::format(
        "the images of {}x{} are larger than plvo takes: they are scaled down by {}, to {}x{}, and the "
        "calibration with them",
        colour.width, colour.height, factor, model().width, model().height);
  return {};
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
  if (whole_.factor > 1)
    whole_colour_.assign(3 * static_cast<std::size_t>(whole_.width) * static_cast<std::size_t>(whole_.height),
                         0);
  depth_.assign(pixels, 0);
  if (registers_) {
    raw_depth_.assign(static_cast<std::size_t>(depth_width_) * static_cast<std::size_t>(depth_height_), 0);
    registration_.init(model(), whole_, calibration_.depth_camera, depth_width_, depth_height_,
                       1 / calibration_.depth_units_per_metre);
  }
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
  std::vector<std::uint8_t>& colour = whole_.factor > 1 ? whole_colour_ : colour_;
  Status status = decoder_.decode_rgb(folder_ / pair.colour.file, whole_.width, whole_.height, colour);
  std::vector<std::uint16_t>& depth = registers_ ? raw_depth_ : depth_;
  if (status.ok())
    status = decoder_.decode_depth(folder_ / pair.depth.file, depth_width_, depth_height_, depth);
  if (!status.ok()) return {StatusCode::kDamaged, status.message()};

  if (index_.numbered) std::replace(depth.begin(), depth.end(), kNoDepthInMillimetres, std::uint16_t{0});
  if (whole_.factor > 1)
    reduce_rgb(whole_colour_.data(), whole_.width, whole_.factor, width, height, colour_.data());
  if (registers_) registration_.warp(raw_depth_.data(), depth_.data());
  frame.colour = {colour_.data(), width, height, width * std::ptrdiff_t{3}, PixelFormat::kRgb8};
  frame.depth = {depth_.data(), width, height, width, 1.0 / calibration_.depth_units_per_metre};
  return {};
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/tum_camera.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace plvo {

namespace fs = std::filesystem;

Status TumCamera::open(const fs::path& folder, const Calibration& calibration, const TumOptions& options) {
  folder_ = folder;
  next_ = 0;
  if (Status status = read_tum_index(folder, options.associations, options.tolerance_ns, index_);
      !status.ok())
    return status;
  if (Status status = choose_range(options); !status.ok()) return status;
  if (Status status = find_image_size(); !status.ok()) return status;
  if (Status status = calibration.validate(model_.width, model_.height); !status.ok()) return status;
  const int width = model_.width;
  const int height = model_.height;
  model_ = calibration.camera;
  model_.width = width;
  model_.height = height;
  depth_units_per_metre_ = calibration.depth_units_per_metre;
  allocate();
  return {};
}

Status TumCamera::choose_range(const TumOptions& options) {
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
Status TumCamera::find_image_size() {
  Status first_failure;
  for (const TumPair& pair : index_.pairs) {
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
                "size",
                colour.width, colour.height, depth.width, depth.height, pair.depth.file)};
      }
      model_.width = colour.width;
      model_.height = colour.height;
      return {};
    }
    if (first_failure.ok()) first_failure = status;
  }
  const bool too_large = first_failure.code() == StatusCode::kInvalidArgument;
  return Status(too_large ? StatusCode::kInvalidArgument : StatusCode::kDamaged,
                "no image of the sequence can be read; ")
      .append(first_failure.message());
}

void TumCamera::allocate() {
  std::uintmax_t largest = 0;
  for (const TumPair& pair : index_.pairs) {
    for (const std::string& file : {pair.colour.file, pair.depth.file}) {
      std::error_code error;
      const std::uintmax_t bytes = fs::file_size(folder_ / file, error);
      if (!error && bytes <= kMaxImageBytes) largest = std::max(largest, bytes);
    }
  }
  decoder_.reserve(largest);
  const std::size_t pixels = static_cast<std::size_t>(model_.width) * static_cast<std::size_t>(model_.height);
  colour_.assign(pixels * 3, 0);
  depth_.assign(pixels, 0);
  // One decoding beforehand lets the image libraries take, here and not in the first frame, what they take.
  RgbdFrame first;
  [[maybe_unused]] const Status told_again_by_the_first_call = next(first);
  next_ = 0;
}

Status TumCamera::next(RgbdFrame& frame) {
  if (next_ >= index_.pairs.size()) return {StatusCode::kEndOfStream, "the sequence ends here"};
  const TumPair& pair = index_.pairs[next_++];
  frame.stamp_ns = pair.colour.stamp_ns;  // also of a frame that turns out to be damaged
  frame.depth_stamp_ns = pair.depth.stamp_ns;
  Status status = decoder_.decode_rgb(folder_ / pair.colour.file, model_.width, model_.height, colour_);
  if (status.ok())
    status = decoder_.decode_depth(folder_ / pair.depth.file, model_.width, model_.height, depth_);
  if (!status.ok()) return {StatusCode::kDamaged, status.message()};

  frame.colour = {colour_.data(), model_.width, model_.height, model_.width * std::ptrdiff_t{3},
                  PixelFormat::kRgb8};
  frame.depth = {depth_.data(), model_.width, model_.height, model_.width, 1.0 / depth_units_per_metre_};
  return {};
}

}  // namespace plvo

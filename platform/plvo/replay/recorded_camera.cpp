// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/recorded_camera.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace plvo {

namespace fs = std::filesystem;

Status RecordedCamera::open(const fs::path& folder, const Calibration& calibration,
                            const SequenceOptions& options) {
  folder_ = folder;
  next_ = 0;
  fit_ = {};
  if (Status status = read_sequence_index(folder, options, index_); !status.ok()) return status;
  if (Status status = choose_range(options); !status.ok()) return status;
  ImageInfo colour, depth;
  if (Status status = find_image_sizes(colour, depth); !status.ok()) return status;
  depth_size_ = {depth.width, depth.height};
  Calibration known = calibration;
  if (index_.numbered && !calibration.depth_scale_given) {
    known.depth_units_per_metre = kMillimetresPerMetre;
    known.depth_scale_given = index_.in_millimetres;
  }
  if (Status status = fit_.init(known, {colour.width, colour.height}, depth_size_, options.scale_down);
      !status.ok())
    return status;
  warm_up();
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

// Takes the sizes of the first pair whose two headers can be read. A single damaged file must not stop a
// sequence; a sequence that is wrong throughout must be refused before anything is written.
Status RecordedCamera::find_image_sizes(ImageInfo& colour, ImageInfo& depth) {
  Status first_failure;
  for (const ImagePair& pair : index_.pairs) {
    Status status = decoder_.read_header(folder_ / pair.colour.file, colour);
    if (status.ok()) status = decoder_.read_header(folder_ / pair.depth.file, depth);
    if (status.ok()) {
      if (colour.bits == 16 && colour.grey && depth.bits == 8) {
        const char* remedy =
            index_.joint_list
                ? "the associations name depth first; write each line as 'stamp rgb stamp depth'"
                : "the two lists are exchanged: rename rgb.txt to depth.txt, and depth.txt to "
                  "rgb.txt";
        return {StatusCode::kInvalidArgument,
                fmt::format("{} is depth and {} is colour: {}", pair.colour.file, pair.depth.file, remedy)};
      }
      if (pair.colour.file == pair.depth.file)
        return {StatusCode::kInvalidArgument,
                fmt::format(
                    "{} is listed as colour and as depth; list the colour images in rgb.txt and the depth "
                    "images in depth.txt",
                    pair.colour.file)};
      if (Status kind = depth.check_is_depth(pair.depth.file); !kind.ok()) return kind;
      return {};
    }
    if (first_failure.ok()) first_failure = status;
  }
  const bool too_large = first_failure.code() == StatusCode::kInvalidArgument;
  return Status(too_large ? StatusCode::kInvalidArgument : StatusCode::kDamaged,
                "no image of the sequence can be read; ")
      .append(first_failure.message());
}

void RecordedCamera::warm_up() {
  std::uintmax_t largest = 0;
  for (const ImagePair& pair : index_.pairs) {
    for (const std::string& file : {pair.colour.file, pair.depth.file}) {
      std::error_code error;
      const std::uintmax_t bytes = fs::file_size(folder_ / file, error);
      if (!error && bytes <= kMaxImageBytes) largest = std::max(largest, bytes);
    }
  }
  decoder_.reserve(static_cast<std::size_t>(largest));
  // Decodes one pair beforehand: the image libraries then allocate their memory here and not in the first
  // frame.
  RgbdFrame first;
  [[maybe_unused]] const Status reported_again_by_next = next(first);
  next_ = 0;
}

Status RecordedCamera::next(RgbdFrame& frame) {
  if (next_ >= index_.pairs.size()) return {StatusCode::kEndOfStream, "the sequence ends here"};
  const ImagePair& pair = index_.pairs[next_++];
  frame.stamp_ns = pair.colour.stamp_ns;  // also for a damaged frame
  frame.depth_stamp_ns = pair.depth.stamp_ns;
  const WholeImage& whole = fit_.whole_image();
  Status status = decoder_.decode_rgb(folder_ / pair.colour.file, whole.width, whole.height, fit_.colour());
  if (status.ok())
    status =
        decoder_.decode_depth(folder_ / pair.depth.file, depth_size_.width, depth_size_.height, fit_.depth());
  if (!status.ok()) return {StatusCode::kDamaged, status.message()};
  fit_.fit(frame);
  return {};
}

}  // namespace plvo

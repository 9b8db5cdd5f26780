// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_camera.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/replay/index/stamp_order.hpp"
#include "plvo/replay/index/stamp_pairs.hpp"
#include "plvo/rosbag/containers/open_container.hpp"
#include "plvo/rosbag/listing.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
Status BagCamera::index(const std::filesystem::path& path, const BagTopicNames& names) {
  Status status = open_messages(path, bag_);
  if (status.ok()) status = topics_.choose(*bag_, names, conversion_);
  if (status.ok()) depth_setup_ = find_depth_setup(*bag_, topics_);
  return status;
}

Status BagCamera::read_image(std::size_t topic, const BagMessage& message, ImageMessage& image) {
  const Status status = bag_->read(message, bytes_);
  const BagTopic& of = bag_->topics()[topic];
  return status.ok() ? conversion_.parse(of.type, of.wire, bytes_, image) : status;
}

Status BagCamera::own_calibration(Calibration& calibration) {
  const std::optional<std::size_t> info = topics_.colour_info();
  if (!info || bag_->messages(*info).empty()) {
    const std::vector<std::string> others = topics_.names_of(kCameraInfoType);
    if (others.empty()) return {StatusCode::kNotFound, "the bag has no camera_info: give a calibration"};
    return topics_.refused(StatusCode::kInvalidArgument,
                           fmt::format("the bag has no {} beside colour: give a calibration, or choose with "
                                       "--info-topic or topics.camera_info: ",
                                       topics_.info_beside_colour()),
                           others);
  }
  Status status = bag_->read(bag_->messages(*info).front(), bytes_);
  if (status.ok()) status = parse_camera_info(bag_->topics()[*info].wire, bytes_, calibration);
  return status.ok() ? status : of_topic(*info, status);
}

Status BagCamera::of_topic(std::size_t topic, const Status& status) const {
  return Status(status.code(), bag_->topics()[topic].name).append(": ").append(status.message());
}

Status BagCamera::in_order(std::size_t topic, Messages& messages) {
  messages = bag_->messages(topic);
  const std::size_t repeated = keep_first_of_each_stamp(messages);
  if (repeated > 0 && messages.size() == 1)
    return not_stamped("images", repeated + 1, bag_->topics()[topic].name, messages.front().stamp_ns);
  repeated_ += repeated;
  return {};
}

// A topic is in the order of its file unless its clock was set back; then sorting would mix images from
// before and after.
Status BagCamera::check_clock(std::size_t topic) const {
  std::vector<std::int64_t> stamps;
  for (const BagMessage& message : bag_->messages(topic))
    if (stamps.empty() || message.stamp_ns != stamps.back()) stamps.push_back(message.stamp_ns);
  const std::optional<StampFault> fault = find_stamp_fault(stamps);
  if (!fault || fault->kind != StampFault::Kind::kClockStep) return {};
  return {StatusCode::kDamaged,
          fmt::format("{}: the clock steps back by {:.3f} s, to {}; split the recording there, because the "
                      "images before and after have the same stamps",
                      bag_->topics()[topic].name, static_cast<double>(fault->step_ns) * 1e-9,
                      format_stamp(stamps[fault->at]))};
}

Status BagCamera::pair_up(const SequenceOptions& options) {
  for (const std::size_t topic : {topics_.colour(), topics_.depth()})
    if (Status status = check_clock(topic); !status.ok()) return status;
  repeated_ = 0;
  Messages colour, depth;
  Status status = in_order(topics_.colour(), colour);
  if (status.ok()) status = in_order(topics_.depth(), depth);
  if (!status.ok()) return status;
  const auto stamps = [](const Messages& messages) {
    std::vector<std::int64_t> result;
    result.reserve(messages.size());
    for (const BagMessage& message : messages) result.push_back(message.stamp_ns);
    return result;
  };
  pairs_.clear();
  pairs_.reserve(std::min(colour.size(), depth.size()));
  clock_remark_.clear();
  const std::vector<std::int64_t> colour_stamps = stamps(colour), depth_stamps = stamps(depth);
  for (const auto& [c, d] : associate(colour_stamps, depth_stamps, options.tolerance_ns))
    pairs_.emplace_back(colour[c], depth[d]);
  unpaired_colour_ = colour.size() - pairs_.size();
  if (pairs_.empty()) {
    std::string why;
    if (!colour.empty() && !depth.empty()) why = "; " + why_no_pair(colour_stamps, depth_stamps);
    return {
        StatusCode::kInvalidArgument,
        fmt::format(
            "of {} images on {} and {} on {} no two are within {:.3f} s (a larger --tolerance pairs more){}",
            colour.size(), bag_->topics()[topics_.colour()].name, depth.size(),
            bag_->topics()[topics_.depth()].name, static_cast<double>(options.tolerance_ns) * 1e-9, why)};
  }
  clock_remark_ = doubt_about_clocks(colour_stamps, depth_stamps);
  const std::size_t end = std::min(options.end_frame, pairs_.size());
  if (options.first_frame >= end)
    return {StatusCode::kInvalidArgument,
            fmt::format("the frame range is empty; the bag has frames 0:{}", pairs_.size())};
  pairs_.resize(end);
  pairs_.erase(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(options.first_frame));
  return {};
}

// Takes the sizes of the first readable pair, as in folders.
Status BagCamera::find_sizes(ImageSize& colour, ImageSize& depth, bool& metres) {
  Status first_failure;
  for (const auto& pair : pairs_) {
    ImageMessage image;
    Status status = read_image(topics_.colour(), pair.first, image);
    if (status.ok() && !is_colour_encoding(image.encoding)) status = conversion_.colour(image, {});
    if (!status.ok()) status = of_topic(topics_.colour(), status);
    colour = {image.width, image.height};
    if (status.ok()) {
      status = read_image(topics_.depth(), pair.second, image);
      if (status.ok() && !is_depth_encoding(image.encoding)) status = conversion_.depth(image, {});
      if (!status.ok()) status = of_topic(topics_.depth(), status);
    }
    depth = {image.width, image.height};
    if (status.ok()) {
      depth_encoding_ = image.encoding;
      metres = depth_encoding_ == "32FC1";
      return {};
    }
    if (first_failure.ok()) first_failure = status;
  }
  return Status(first_failure.code(), "no image of the bag can be read; ").append(first_failure.message());
}

Status BagCamera::open(const Calibration& calibration, const std::optional<double>& units_per_metre,
                       const SequenceOptions& options) {
  next_ = 0;
  fit_ = {};
  if (Status status = pair_up(options); !status.ok()) return status;
  bool metres = false;
  if (Status status = find_sizes(colour_size_, depth_size_, metres); !status.ok()) return status;
  if (metres && units_per_metre)
    return {StatusCode::kInvalidArgument,
            "--depth-scale is for whole units; the depth of this bag is in metres"};
  Calibration known = calibration;
  known.depth_units_per_metre =
      metres ? kFloatDepthUnitsPerMetre
             : units_per_metre.value_or(depth_setup_.units_per_metre.value_or(kMillimetresPerMetre));
  known.depth_scale_given = true;
  if (!known.depth_camera.known) known.depth_camera = depth_setup_.camera;
  return fit_.init(known, colour_size_, depth_size_, options.scale_down);
}

Status BagCamera::read_colour(const BagMessage& message) {
  ImageMessage image;
  Status status = read_image(topics_.colour(), message, image);
  if (status.ok() && (image.width != colour_size_.width || image.height != colour_size_.height))
    status = {StatusCode::kDamaged, fmt::format("{}x{} where {}x{} is expected", image.width, image.height,
                                                colour_size_.width, colour_size_.height)};
  return status.ok() ? conversion_.colour(image, fit_.colour()) : status;
}

Status BagCamera::read_depth(const BagMessage& message) {
  ImageMessage image;
  Status status = read_image(topics_.depth(), message, image);
  if (status.ok() && (image.width != depth_size_.width || image.height != depth_size_.height ||
                      image.encoding != depth_encoding_))
    status = {StatusCode::kDamaged,
              fmt::format("{}x{} {} where {}x{} {} is expected", image.width, image.height, image.encoding,
                          depth_size_.width, depth_size_.height, depth_encoding_)};
  return status.ok() ? conversion_.depth(image, fit_.depth()) : status;
}

Status BagCamera::next(RgbdFrame& frame) {
  if (next_ >= pairs_.size()) return {StatusCode::kEndOfStream, "the bag ends here"};
  const auto& [colour, depth] = pairs_[next_++];
  frame.stamp_ns = colour.stamp_ns;  // also for a damaged frame
  frame.depth_stamp_ns = depth.stamp_ns;
  Status status = read_colour(colour);
  std::size_t topic = topics_.colour();
  if (status.ok()) {
    status = read_depth(depth);
    topic = topics_.depth();
  }
  if (!status.ok()) return of_topic(topic, {StatusCode::kDamaged, status.message()});
  fit_.fit(frame);
  return {};
}

std::vector<std::string> BagCamera::remarks() const {
  std::vector<std::string> sentences;
  if (bag_ != nullptr) sentences.push_back(bag_->remark());
  sentences.insert(sentences.end(), topics_.remarks().begin(), topics_.remarks().end());
  for (const std::string& sentence : {depth_setup_.remark, clock_remark_, fit_.remark()})
    sentences.push_back(sentence);
  std::erase(sentences, std::string());
  if (repeated_ > 0)
    sentences.push_back(
        fmt::format("{} images have the stamp of another on their topic and are left out", repeated_));
  return sentences;
}

}  // namespace plvo

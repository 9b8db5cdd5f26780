// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_camera.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/replay/index/stamp_order.hpp"
#include "plvo/replay/index/stamp_pairs.hpp"
#include "plvo/rosbag/messages.hpp"

namespace plvo {
namespace {

constexpr const char* kCompressedImage = "sensor_msgs/CompressedImage";
constexpr const char* kTumColour = "/camera/rgb/image_color";
constexpr const char* kTumDepth = "/camera/depth/image";

Status compressed(const std::string& topic) {
  return {StatusCode::kUnsupported,
          fmt::format("{} holds compressed images ({}), which are not read; rosrun image_transport republish "
                      "compressed makes raw ones",
                      topic, kCompressedImage)};
}

}  // namespace

Status BagCamera::index(const std::filesystem::path& path, const BagTopicNames& names) {
  if (Status status = bag_.open(path); !status.ok()) return status;
  if (Status status = choose_images(names.colour, false, colour_topic_); !status.ok()) return status;
  if (Status status = choose_images(names.depth, true, depth_topic_); !status.ok()) return status;
  return choose_info(names.camera_info);
}

std::string BagCamera::topics_in_words() const {
  std::vector<std::string> names;
  for (const char* type : {kImageType, kCompressedImage, kCameraInfoType})
    for (const BagTopic& topic : bag_.topics())
      if (topic.type == type) names.push_back(topic.name);
  if (names.empty()) return "the bag has no images";
  constexpr std::size_t kMostLetters = 150;  // a status is short
  std::string text = "the bag has";
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (text.size() + names[i].size() > kMostLetters)
      return text + fmt::format(" and {} more", names.size() - i);
    text += (i == 0 ? " " : ", ") + names[i];
  }
  return text;
}

Status BagCamera::read_image(const BagMessage& message, ImageMessage& image) {
  Status status = bag_.read(message, bytes_);
  return status.ok() ? parse_image(bytes_, image) : status;
}

Status BagCamera::encoding_of(std::size_t topic, std::string& encoding) {
  encoding.clear();
  Status failure(StatusCode::kNotFound, "no message");
  for (const BagMessage& message : bag_.messages()) {
    if (message.topic != topic) continue;
    ImageMessage image;
    failure = read_image(message, image);
    if (!failure.ok()) continue;
    encoding = image.encoding;
    return {};
  }
  return failure;
}

Status BagCamera::choose_images(const std::string& wanted, bool depth, std::size_t& chosen) {
  const char* kind = depth ? "depth" : "colour";
  const std::string preferred = depth ? kTumDepth : kTumColour;
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < bag_.topics().size(); ++i) {
    const BagTopic& topic = bag_.topics()[i];
    if (!wanted.empty() && topic.name == wanted && topic.type == kCompressedImage)
      return compressed(topic.name);
    if (topic.type != kImageType) continue;
    if (topic.name == (wanted.empty() ? preferred : wanted)) {
      chosen = i;
      return {};
    }
    std::string encoding;
    if (wanted.empty() && encoding_of(i, encoding).ok() &&
        (depth ? is_depth_encoding(encoding) : is_colour_encoding(encoding)))
      candidates.push_back(i);
  }
  if (!wanted.empty())
    return {StatusCode::kNotFound, fmt::format("there are no images on {}; {}", wanted, topics_in_words())};
  if (candidates.size() > 1)
    return {StatusCode::kInvalidArgument,
            fmt::format("several topics could be {0}: choose with --{0}-topic or topics.{0}; {1}", kind,
                        topics_in_words())};
  if (candidates.empty()) {
    for (const BagTopic& topic : bag_.topics())
      if (topic.type == kCompressedImage && (topic.name.find("depth") != std::string::npos) == depth)
        return compressed(topic.name);
    return {StatusCode::kNotFound,
            fmt::format("no topic has images of {} ({}); {}", kind,
                        depth ? "16UC1 or 32FC1" : "rgb8, bgr8 or mono8", topics_in_words())};
  }
  chosen = candidates.front();
  return {};
}

Status BagCamera::choose_info(const std::string& wanted) {
  const std::string& colour = bag_.topics()[colour_topic_].name;
  const std::string beside = colour.substr(0, colour.rfind('/') + 1) + "camera_info";
  info_topic_.reset();
  for (std::size_t i = 0; i < bag_.topics().size(); ++i) {
    const BagTopic& topic = bag_.topics()[i];
    if (topic.type == kCameraInfoType && topic.name == (wanted.empty() ? beside : wanted)) info_topic_ = i;
  }
  if (wanted.empty() || info_topic_) return {};
  return {StatusCode::kNotFound, fmt::format("there is no camera_info on {}; {}", wanted, topics_in_words())};
}

Status BagCamera::own_calibration(Calibration& calibration) {
  Status failure(StatusCode::kNotFound, "the bag has no camera_info beside colour: give a calibration");
  for (const BagMessage& message : bag_.messages()) {
    if (!info_topic_ || message.topic != *info_topic_) continue;
    failure = bag_.read(message, bytes_);
    if (failure.ok()) failure = parse_camera_info(bytes_, calibration);
    if (failure.ok()) return {};
    return Status(failure.code(), bag_.topics()[*info_topic_].name.c_str())
        .append(": ")
        .append(failure.message());
  }
  return failure;
}

BagCamera::Messages BagCamera::messages_of(std::size_t topic) {
  Messages messages;
  for (const BagMessage& message : bag_.messages())
    if (message.topic == topic) messages.push_back(message);
  std::stable_sort(messages.begin(), messages.end(),
                   [](const BagMessage& a, const BagMessage& b) { return a.stamp_ns < b.stamp_ns; });
  const auto end =
      std::unique(messages.begin(), messages.end(),
                  [](const BagMessage& a, const BagMessage& b) { return a.stamp_ns == b.stamp_ns; });
  repeated_ += static_cast<std::size_t>(messages.end() - end);
  messages.erase(end, messages.end());
  return messages;
}

// A topic is in the order of its file unless its clock was set back; then sorting would mix what was seen
// before and after.
Status BagCamera::check_clock(std::size_t topic) const {
  std::vector<std::int64_t> stamps;
  for (const BagMessage& message : bag_.messages())
    if (message.topic == topic && (stamps.empty() || message.stamp_ns != stamps.back()))
      stamps.push_back(message.stamp_ns);
  const std::optional<StampFault> fault = find_stamp_fault(stamps);
  if (!fault || fault->kind != StampFault::Kind::kClockStep) return {};
  return {
      StatusCode::kDamaged,
      fmt::format("{}: the clock steps back by {:.3f} s, to {}; split the bag there (rosbag filter), for the "
                  "images before and after have the same stamps",
                  bag_.topics()[topic].name, static_cast<double>(fault->step_ns) * 1e-9,
                  format_stamp(stamps[fault->at]))};
}

Status BagCamera::pair_up(const SequenceOptions& options) {
  for (const std::size_t topic : {colour_topic_, depth_topic_})
    if (Status status = check_clock(topic); !status.ok()) return status;
  repeated_ = 0;
  const Messages colour = messages_of(colour_topic_), depth = messages_of(depth_topic_);
  const auto stamps = [](const Messages& messages) {
    std::vector<std::int64_t> result;
    for (const BagMessage& message : messages) result.push_back(message.stamp_ns);
    return result;
  };
  pairs_.clear();
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
            colour.size(), bag_.topics()[colour_topic_].name, depth.size(), bag_.topics()[depth_topic_].name,
            static_cast<double>(options.tolerance_ns) * 1e-9, why)};
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

// The first pair that can be read decides, as in folders.
Status BagCamera::find_sizes(ImageSize& colour, ImageSize& depth, bool& metres) {
  Status first_failure;
  for (const auto& pair : pairs_) {
    ImageMessage image;
    Status status = read_image(pair.first, image);
    if (status.ok() && !is_colour_encoding(image.encoding)) status = colour_pixels(image, {});
    colour = {image.width, image.height};
    if (status.ok()) status = read_image(pair.second, image);
    if (status.ok() && !is_depth_encoding(image.encoding)) status = depth_pixels(image, {});
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
  known.depth_units_per_metre = metres ? kFloatDepthUnitsPerMetre : units_per_metre.value_or(1000);
  known.depth_scale_given = true;
  return fit_.init(known, colour_size_, depth_size_, options.scale_down);
}

Status BagCamera::read_colour(const BagMessage& message) {
  ImageMessage image;
  Status status = read_image(message, image);
  if (status.ok() && (image.width != colour_size_.width || image.height != colour_size_.height))
    status = {StatusCode::kDamaged, fmt::format("{}x{} where {}x{} is expected", image.width, image.height,
                                                colour_size_.width, colour_size_.height)};
  return status.ok() ? colour_pixels(image, fit_.colour()) : status;
}

Status BagCamera::read_depth(const BagMessage& message) {
  ImageMessage image;
  Status status = read_image(message, image);
  if (status.ok() && (image.width != depth_size_.width || image.height != depth_size_.height ||
                      image.encoding != depth_encoding_))
    status = {StatusCode::kDamaged,
              fmt::format("{}x{} {} where {}x{} {} is expected", image.width, image.height, image.encoding,
                          depth_size_.width, depth_size_.height, depth_encoding_)};
  return status.ok() ? depth_pixels(image, fit_.depth()) : status;
}

Status BagCamera::next(RgbdFrame& frame) {
  if (next_ >= pairs_.size()) return {StatusCode::kEndOfStream, "the bag ends here"};
  const auto& [colour, depth] = pairs_[next_++];
  frame.stamp_ns = colour.stamp_ns;  // also of a frame that turns out to be damaged
  frame.depth_stamp_ns = depth.stamp_ns;
  Status status = read_colour(colour);
  std::size_t topic = colour_topic_;
  if (status.ok()) {
    status = read_depth(depth);
    topic = depth_topic_;
  }
  if (!status.ok())
    return Status(StatusCode::kDamaged, bag_.topics()[topic].name.c_str())
        .append(": ")
        .append(status.message());
  fit_.fit(frame);
  return {};
}

std::vector<std::string> BagCamera::remarks() const {
  std::vector<std::string> sentences;
  for (const std::string& sentence : {bag_.remark(), clock_remark_, fit_.remark()})
    if (!sentence.empty()) sentences.push_back(sentence);
  if (repeated_ > 0)
    sentences.push_back(
        fmt::format("{} images have the stamp of another on their topic and are left out", repeated_));
  return sentences;
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/bag_camera.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/replay/index/stamp_order.hpp"
#include "plvo/replay/index/stamp_pairs.hpp"
#include "plvo/rosbag/listing.hpp"
#include "plvo/rosbag/messages.hpp"

namespace plvo {
namespace {

constexpr const char* kCompressedImage = "sensor_msgs/CompressedImage";
constexpr std::size_t kMostOfEncoding = 40;  // letters; the known names are shorter
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
  topics_in_words_.clear();
  if (Status status = bag_.open(path); !status.ok()) return status;
  find_encodings();
  if (Status status = choose_images(names.colour, false, colour_topic_); !status.ok()) return status;
  if (Status status = choose_images(names.depth, true, depth_topic_); !status.ok()) return status;
  return choose_info(names.camera_info);
}

Status BagCamera::refused(StatusCode code, const std::string& sentence,
                          const std::vector<std::string>& names) {
  constexpr std::size_t kAndMore = 20;  // letters
  const std::string all = names.empty() ? "the bag has none" : listed(names);
  if (sentence.size() + all.size() < Status::kCapacity) return {code, sentence + all};
  topics_in_words_ = "the topics are " + all;
  const std::size_t taken = std::min(sentence.size() + kAndMore, Status::kCapacity);
  return {code, sentence + listed(names, Status::kCapacity - taken)};
}

std::vector<std::string> BagCamera::names_of(std::string_view type) const {
  std::vector<std::string> names;
  for (const BagTopic& topic : bag_.topics())
    if (topic.type == type) names.push_back(topic.name);
  return names;
}

std::vector<std::string> BagCamera::image_topics() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < bag_.topics().size(); ++i)
    if (bag_.topics()[i].type == kImageType) names.push_back(with_encoding(i));
  for (const std::string& name : names_of(kCompressedImage)) names.push_back(name + " (compressed)");
  return names;
}

std::string BagCamera::with_encoding(std::size_t topic) const {
  const std::string& encoding = encodings_[topic];
  return fmt::format("{} ({})", bag_.topics()[topic].name,
                     encoding.empty() ? "no image that can be read" : encoding);
}

Status BagCamera::read_image(const BagMessage& message, ImageMessage& image) {
  Status status = bag_.read(message, bytes_);
  return status.ok() ? parse_image(bytes_, image) : status;
}

// Reads the encoding of each topic's first readable image.
void BagCamera::find_encodings() {
  encodings_.assign(bag_.topics().size(), {});
  for (std::size_t i = 0; i < encodings_.size(); ++i)
    for (const BagMessage& message : bag_.messages(i)) {
      ImageMessage image;
      if (bag_.topics()[i].type != kImageType) break;
      if (!read_image(message, image).ok()) continue;
      encodings_[i] = image.encoding.substr(0, kMostOfEncoding);
      break;
    }
}

std::vector<std::size_t> BagCamera::candidates(bool depth) const {
  std::vector<std::size_t> topics, grey;
  for (std::size_t i = 0; i < encodings_.size(); ++i) {
    if (!(depth ? is_depth_encoding(encodings_[i]) : is_colour_encoding(encodings_[i]))) continue;
    // Infrared is recorded as mono16, too: it counts as depth only if there is no other.
    (encodings_[i] == "mono16" ? grey : topics).push_back(i);
  }
  return topics.empty() ? grey : topics;
}

Status BagCamera::choose_images(const std::string& wanted, bool depth, std::size_t& chosen) {
  const char* kind = depth ? "depth" : "colour";
  const std::string preferred = depth ? kTumDepth : kTumColour;
  for (std::size_t i = 0; i < bag_.topics().size(); ++i) {
    const BagTopic& topic = bag_.topics()[i];
    if (!wanted.empty() && topic.name == wanted && topic.type == kCompressedImage)
      return compressed(topic.name);
    if (topic.type != kImageType || topic.name != (wanted.empty() ? preferred : wanted)) continue;
    chosen = i;
    return {};
  }
  if (!wanted.empty())
    return refused(StatusCode::kNotFound, fmt::format("there are no images on {}; images are on: ", wanted),
                   image_topics());
  const std::vector<std::size_t> fitting = candidates(depth);
  if (fitting.size() > 1) {
    std::vector<std::string> names;
    for (const std::size_t topic : fitting) names.push_back(with_encoding(topic));
    return refused(
        StatusCode::kInvalidArgument,
        fmt::format("several topics could be {0}: choose with --{0}-topic or topics.{0} among ", kind),
        names);
  }
  if (fitting.empty()) {
    for (const BagTopic& topic : bag_.topics())
      if (topic.type == kCompressedImage && (topic.name.find("depth") != std::string::npos) == depth)
        return compressed(topic.name);
    return refused(StatusCode::kNotFound,
                   fmt::format("no topic has images of {} ({}); images are on: ", kind,
                               depth ? kDepthEncodings : kColourEncodings),
                   image_topics());
  }
  chosen = fitting.front();
  return {};
}

std::string BagCamera::info_beside_colour() const {
  const std::string& colour = bag_.topics()[colour_topic_].name;
  return colour.substr(0, colour.rfind('/') + 1) + "camera_info";
}

Status BagCamera::choose_info(const std::string& wanted) {
  info_topic_.reset();
  const std::string name = wanted.empty() ? info_beside_colour() : wanted;
  for (std::size_t i = 0; i < bag_.topics().size(); ++i)
    if (bag_.topics()[i].type == kCameraInfoType && bag_.topics()[i].name == name) info_topic_ = i;
  if (wanted.empty() || info_topic_) return {};
  return refused(StatusCode::kNotFound,
                 fmt::format("there is no camera_info on {}; topics of that type: ", wanted),
                 names_of(kCameraInfoType));
}

Status BagCamera::own_calibration(Calibration& calibration) {
  if (!info_topic_ || bag_.messages(*info_topic_).empty()) {
    const std::vector<std::string> others = names_of(kCameraInfoType);
    if (others.empty()) return {StatusCode::kNotFound, "the bag has no camera_info: give a calibration"};
    return refused(StatusCode::kInvalidArgument,
                   fmt::format("the bag has no {} beside colour: give a calibration, or choose with "
                               "--info-topic or topics.camera_info: ",
                               info_beside_colour()),
                   others);
  }
  Status status = bag_.read(bag_.messages(*info_topic_).front(), bytes_);
  if (status.ok()) status = parse_camera_info(bytes_, calibration);
  return status.ok() ? status : of_topic(*info_topic_, status);
}

Status BagCamera::of_topic(std::size_t topic, const Status& status) const {
  return Status(status.code(), bag_.topics()[topic].name).append(": ").append(status.message());
}

Status BagCamera::in_order(std::size_t topic, Messages& messages) {
  messages = bag_.messages(topic);
  std::stable_sort(messages.begin(), messages.end(),
                   [](const BagMessage& a, const BagMessage& b) { return a.stamp_ns < b.stamp_ns; });
  if (messages.size() > 1 && messages.front().stamp_ns == messages.back().stamp_ns)
    return not_stamped("images", messages.size(), bag_.topics()[topic].name, messages.front().stamp_ns);
  const auto end =
      std::unique(messages.begin(), messages.end(),
                  [](const BagMessage& a, const BagMessage& b) { return a.stamp_ns == b.stamp_ns; });
  repeated_ += static_cast<std::size_t>(messages.end() - end);
  messages.erase(end, messages.end());
  return {};
}

// A topic is in the order of its file unless its clock was set back; then sorting would mix images from
// before and after.
Status BagCamera::check_clock(std::size_t topic) const {
  std::vector<std::int64_t> stamps;
  for (const BagMessage& message : bag_.messages(topic))
    if (stamps.empty() || message.stamp_ns != stamps.back()) stamps.push_back(message.stamp_ns);
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
  Messages colour, depth;
  Status status = in_order(colour_topic_, colour);
  if (status.ok()) status = in_order(depth_topic_, depth);
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

// Takes the sizes of the first readable pair, as in folders.
Status BagCamera::find_sizes(ImageSize& colour, ImageSize& depth, bool& metres) {
  Status first_failure;
  for (const auto& pair : pairs_) {
    ImageMessage image;
    Status status = read_image(pair.first, image);
    if (status.ok() && !is_colour_encoding(image.encoding)) status = colour_pixels(image, {});
    if (!status.ok()) status = of_topic(colour_topic_, status);
    colour = {image.width, image.height};
    if (status.ok()) {
      status = read_image(pair.second, image);
      if (status.ok() && !is_depth_encoding(image.encoding)) status = depth_pixels(image, {});
      if (!status.ok()) status = of_topic(depth_topic_, status);
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
  frame.stamp_ns = colour.stamp_ns;  // also for a damaged frame
  frame.depth_stamp_ns = depth.stamp_ns;
  Status status = read_colour(colour);
  std::size_t topic = colour_topic_;
  if (status.ok()) {
    status = read_depth(depth);
    topic = depth_topic_;
  }
  if (!status.ok()) return of_topic(topic, {StatusCode::kDamaged, status.message()});
  fit_.fit(frame);
  return {};
}

std::vector<std::string> BagCamera::remarks() const {
  std::vector<std::string> sentences;
  for (const std::string& sentence : {bag_.remark(), topics_in_words_, clock_remark_, fit_.remark()})
    if (!sentence.empty()) sentences.push_back(sentence);
  if (repeated_ > 0)
    sentences.push_back(
        fmt::format("{} images have the stamp of another on their topic and are left out", repeated_));
  return sentences;
}

}  // namespace plvo

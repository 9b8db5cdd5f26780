// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/topic_choice.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "plvo/rosbag/listing.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

constexpr std::size_t kMostOfEncoding = 40;  // letters; the known names are shorter
constexpr std::size_t kMostUnreadable = 20;  // images of a topic that are tried
constexpr const char* kTumColour = "/camera/rgb/image_color";
constexpr const char* kTumDepth = "/camera/depth/image";

std::string folder_of(const std::string& topic) { return topic.substr(0, topic.rfind('/') + 1); }

// The topic that an image transport published a copy of, or the topic itself.
std::string original_of(const std::string& topic) {
  for (const char* transport : {"/compressed", "/compressedDepth"})
    if (topic.ends_with(transport)) return topic.substr(0, topic.rfind('/'));
  return topic;
}

// The parts of a topic's name that tell cameras apart: the empty one before the first slash, and the next.
constexpr std::size_t kPartsOfACamera = 2;

bool is_named_registered(const std::string& topic) {
  return topic.find("aligned") != std::string::npos || topic.find("registered") != std::string::npos;
}

// Infrared of 16 bits has the encoding of depth, and a picture of the confidence that of a grey image.
bool is_named_no_depth(const std::string& topic) {
  return topic.find("nfra") != std::string::npos || topic.find("/ir/") != std::string::npos ||
         topic.find("onfidence") != std::string::npos;
}

// How many parts of their names two topics have in common from the start on: those of one camera have more.
std::size_t parts_in_common(const std::string& a, const std::string& b) {
  std::size_t parts = 0;
  for (std::size_t i = 0; i < a.size() && i < b.size() && a[i] == b[i]; ++i) parts += a[i] == '/' ? 1 : 0;
  return parts;
}

}  // namespace

Status TopicChoice::choose(MessageFile& bag, const BagTopicNames& names, ImageConversion& conversion) {
  bag_ = &bag;
  remarks_.clear();
  colour_info_.reset();
  depth_info_.reset();
  look_at_images(conversion);
  Status status = choose_images(names.colour, false, colour_);
  if (status.ok()) status = choose_images(names.depth, true, depth_);
  if (status.ok()) status = choose_info(names.camera_info);
  chosen_ = status.ok();
  return status;
}

void TopicChoice::look_at_images(ImageConversion& conversion) {
  images_.assign(bag_->topics().size(), {});
  std::vector<unsigned char> bytes;
  for (const std::size_t topic : image_topics()) {
    std::size_t tried = 0;
    for (const BagMessage& message : bag_->messages(topic)) {
      ImageMessage image;
      Status status = bag_->read(message, bytes);
      if (status.ok()) {
        const BagTopic& of = bag_->topics()[topic];
        status = conversion.parse(of.type, of.wire, bytes, image);
      }
      if (status.ok()) {
        images_[topic] = {std::string(image.encoding.substr(0, kMostOfEncoding)),
                          std::string(image.frame.substr(0, kMostOfEncoding)),
                          image.width,
                          image.height,
                          {}};
        break;
      }
      if (tried == 0) images_[topic].failure = status.message();
      if (++tried == kMostUnreadable) break;
    }
  }
}

Status TopicChoice::refused(StatusCode code, const std::string& sentence,
                            const std::vector<std::string>& names) {
  constexpr std::size_t kAndMore = 20;  // letters
  const std::string all = names.empty() ? "none" : listed(names);
  if (sentence.size() + all.size() < Status::kCapacity) return {code, sentence + all};
  remarks_.push_back("the topics are " + all);
  const std::size_t taken = std::min(sentence.size() + kAndMore, Status::kCapacity);
  return {code, sentence + listed(names, Status::kCapacity - taken)};
}

std::vector<std::string> TopicChoice::names_of(std::string_view type) const {
  std::vector<std::string> names;
  for (const BagTopic& topic : bag_->topics())
    if (topic.type == type) names.push_back(topic.name);
  return names;
}

std::vector<std::size_t> TopicChoice::image_topics() const {
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < bag_->topics().size(); ++i)
    if (is_image_type(bag_->topics()[i].type)) topics.push_back(i);
  return topics;
}

std::string TopicChoice::with_encoding(std::size_t topic) const {
  const Images& images = images_[topic];
  if (!images.encoding.empty()) return fmt::format("{} ({})", name_of(topic), images.encoding);
  return fmt::format("{} ({})", name_of(topic), images.failure.empty() ? "no image" : images.failure);
}

std::vector<std::string> TopicChoice::with_encodings(const std::vector<std::size_t>& topics) const {
  std::vector<std::string> names;
  for (const std::size_t topic : topics) names.push_back(with_encoding(topic));
  return names;
}

bool TopicChoice::is_copy(std::size_t topic, const std::vector<std::size_t>& others) const {
  const std::string original = original_of(name_of(topic));
  return original != name_of(topic) && std::any_of(others.begin(), others.end(), [&](std::size_t other) {
           return other != topic && original_of(name_of(other)) == original &&
                  (name_of(other) == original || other < topic);
         });
}

template <typename Worse>
std::vector<std::size_t> TopicChoice::drop(std::vector<std::size_t>& topics, const Worse& worse) {
  std::vector<std::size_t> better, dropped;
  for (const std::size_t topic : topics) (worse(topic) ? dropped : better).push_back(topic);
  if (better.empty()) return {};
  topics = better;
  return dropped;
}

std::vector<std::size_t> TopicChoice::candidates(bool depth) {
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < images_.size(); ++i)
    if (depth ? is_depth_encoding(images_[i].encoding) : is_colour_encoding(images_[i].encoding))
      topics.push_back(i);
  const std::vector<std::size_t> grey =
      drop(topics, [this](std::size_t topic) { return is_grey_encoding(images_[topic].encoding); });
  if (!depth && topics.size() == 1 && !grey.empty())
    remarks_.push_back(fmt::format("colour is taken from {}, and not from the grey images on {}",
                                   name_of(topics[0]), listed(with_encodings(grey))));
  std::vector<std::size_t> other =
      depth ? drop(topics, [this](std::size_t topic) { return is_named_no_depth(name_of(topic)); })
            : std::vector<std::size_t>();
  const std::vector<std::size_t> all = topics;
  drop(topics, [&](std::size_t topic) { return is_copy(topic, all); });
  if (topics.size() == 1 && !other.empty())
    remarks_.push_back(fmt::format("depth is taken from {}, and not from the infrared images on {}",
                                   name_of(topics[0]), listed(with_encodings(other))));
  if (!depth || topics.size() < 2) return topics;
  std::size_t most = 0;
  for (const std::size_t topic : topics)
    most = std::max(most, parts_in_common(name_of(topic), name_of(colour_)));
  other = drop(topics, [&](std::size_t topic) {
    return parts_in_common(name_of(topic), name_of(colour_)) < std::min<std::size_t>(most, kPartsOfACamera);
  });
  if (topics.size() == 1) {
    remarks_.push_back(
        fmt::format("depth is taken from {}, which is of the camera of colour, and not from {}",
                    name_of(topics[0]), listed(with_encodings(other))));
    return topics;
  }
  const std::string& frame = images_[colour_].frame;
  std::vector<std::size_t> dropped =
      drop(topics, [&](std::size_t topic) { return frame.empty() || images_[topic].frame != frame; });
  if (topics.size() > 1) {
    const std::vector<std::size_t> more =
        drop(topics, [this](std::size_t topic) { return !is_named_registered(name_of(topic)); });
    dropped.insert(dropped.end(), more.begin(), more.end());
  }
  if (topics.size() == 1 && !dropped.empty())
    remarks_.push_back(fmt::format("depth is taken from {}, which is in the view of colour, and not from {}",
                                   name_of(topics[0]), listed(with_encodings(dropped))));
  return topics;
}

Status TopicChoice::choose_images(const std::string& wanted, bool depth, std::size_t& chosen) {
  const char* kind = depth ? "depth" : "colour";
  const std::string preferred = depth ? kTumDepth : kTumColour;
  for (const std::size_t topic : image_topics()) {
    if (name_of(topic) != (wanted.empty() ? preferred : wanted)) continue;
    chosen = topic;
    return {};
  }
  if (!wanted.empty())
    return refused(StatusCode::kNotFound, fmt::format("there are no images on {}; images are on: ", wanted),
                   with_encodings(image_topics()));
  const std::vector<std::size_t> fitting = candidates(depth);
  if (fitting.size() > 1)
    return refused(
        StatusCode::kInvalidArgument,
        fmt::format("several topics could be {0}: choose with --{0}-topic or topics.{0} among ", kind),
        with_encodings(fitting));
  if (fitting.empty())
    return refused(StatusCode::kNotFound,
                   fmt::format("no topic has images of {} ({}); images are on: ", kind,
                               depth ? kDepthEncodings : kColourEncodings),
                   with_encodings(image_topics()));
  chosen = fitting.front();
  return {};
}

std::string TopicChoice::info_beside_colour() const {
  return folder_of(original_of(name_of(colour_))) + "camera_info";
}

std::optional<std::size_t> TopicChoice::info_beside(std::size_t topic) const {
  const std::string folder = folder_of(original_of(name_of(topic)));
  std::vector<std::string> places = {folder + "camera_info"};
  // librealsense: …/Color_0/image/data and …/Color_0/info/camera_info.
  constexpr std::string_view kImage = "/image/";
  if (folder.ends_with(kImage))
    places.push_back(folder.substr(0, folder.size() - kImage.size()) + "/info/camera_info");
  for (const std::string& place : places)
    if (const std::optional<std::size_t> info = bag_->find_topic(place, kCameraInfoType)) return info;
  return {};
}

Status TopicChoice::choose_info(const std::string& wanted) {
  colour_info_ = info_beside(colour_);
  depth_info_ = info_beside(depth_);
  if (wanted.empty()) return {};
  colour_info_ = bag_->find_topic(wanted, kCameraInfoType);
  if (colour_info_) return {};
  return refused(StatusCode::kNotFound,
                 fmt::format("there is no camera_info on {}; topics of that type: ", wanted),
                 names_of(kCameraInfoType));
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Chooses which topics of a recording are colour, depth and their calibrations. A name that the user gives
// comes first, then TUM's topics (/camera/rgb/image_color, /camera/depth/image). Otherwise the candidates are
// the topics with a fitting encoding, without
//   grey images, which may be infrared, if there are others;
//   the compressed copy of a topic that is there, too;
//   topics named infrared or confidence, for depth;
//   depth whose name begins otherwise than that of colour (/front/…, /device_0/…), of another camera;
//   depth in the view of another camera than colour, if there is depth in colour's: by the frame in the
//   headers, or by a name with "aligned" or "registered".
// One candidate has to remain.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plvo/rosbag/bag_topics.hpp"
#include "plvo/rosbag/containers/message_file.hpp"
#include "plvo/rosbag/messages/image_conversion.hpp"

namespace plvo {

class TopicChoice {
 public:
  // Reads the first images of each topic. Returns kNotFound for a missing topic (listing the existing ones),
  // kInvalidArgument if there are several candidates.
  Status choose(MessageFile& bag, const BagTopicNames& names, ImageConversion& conversion);

  std::size_t colour() const { return colour_; }
  std::size_t depth() const { return depth_; }
  // Whether choose() has succeeded.
  bool chosen() const { return chosen_; }
  // The camera_info of colour or depth; empty if there is none.
  std::optional<std::size_t> colour_info() const { return colour_info_; }
  std::optional<std::size_t> depth_info() const { return depth_info_; }
  // Whether the headers of depth name the same frame as those of colour.
  bool same_frame() const { return images_[colour_].frame == images_[depth_].frame; }

  // What an image topic's first readable image says; for others it is empty.
  struct Images {
    std::string encoding, frame;
    int width = 0, height = 0;
    std::string failure;  // why the first image cannot be read, if none can
  };
  const Images& images(std::size_t topic) const { return images_[topic]; }

  // Which of several candidates were left out, in sentences. After a failure they may list the topics.
  const std::vector<std::string>& remarks() const { return remarks_; }

  // Where a camera_info would be looked for first.
  std::string info_beside_colour() const;
  // Makes an error of the sentence and as many names as a status holds. If some do not fit, all of them
  // become a remark.
  Status refused(StatusCode code, const std::string& sentence, const std::vector<std::string>& names);
  std::vector<std::string> names_of(std::string_view type) const;

 private:
  void look_at_images(ImageConversion& conversion);
  std::vector<std::size_t> candidates(bool depth);
  Status choose_images(const std::string& wanted, bool depth, std::size_t& topic);
  Status choose_info(const std::string& wanted);
  std::optional<std::size_t> info_beside(std::size_t topic) const;
  bool is_copy(std::size_t topic, const std::vector<std::size_t>& others) const;
  // Drops the topics for which `worse` holds, if any other is left.
  template <typename Worse>
  static std::vector<std::size_t> drop(std::vector<std::size_t>& topics, const Worse& worse);
  const std::string& name_of(std::size_t topic) const { return bag_->topics()[topic].name; }
  std::string with_encoding(std::size_t topic) const;
  std::vector<std::string> with_encodings(const std::vector<std::size_t>& topics) const;
  std::vector<std::size_t> image_topics() const;

  MessageFile* bag_ = nullptr;
  bool chosen_ = false;
  std::size_t colour_ = 0, depth_ = 0;
  std::optional<std::size_t> colour_info_, depth_info_;
  std::vector<Images> images_;  // of each topic
  std::vector<std::string> remarks_;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// A recording of messages (containers/open_container.hpp) as a camera: images of colour and of depth, paired
// by the stamps in their headers as in TUM folders, and sensor_msgs/CameraInfo as the calibration.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/images/frame_fit.hpp"
#include "plvo/replay/index/sequence_index.hpp"
#include "plvo/rosbag/bag_imu.hpp"
#include "plvo/rosbag/bag_topics.hpp"
#include "plvo/rosbag/containers/message_file.hpp"
#include "plvo/rosbag/depth_setup.hpp"
#include "plvo/rosbag/messages/image_conversion.hpp"
#include "plvo/rosbag/topic_choice.hpp"

namespace plvo {

class BagCamera final : public RgbdCamera {
 public:
  // Reads the recording once and chooses its topics. Returns the errors of open_messages and
  // TopicChoice::choose.
  Status index(const std::filesystem::path& path, const BagTopicNames& names);

  // Calibration from the first camera_info. Returns kNotFound if there is none, kInvalidArgument if there are
  // only others than the one beside colour; else the status of parse_camera_info.
  Status own_calibration(Calibration& calibration);

  // See read_bag_imu; its topics are in `names`.
  Status read_imu(const BagTopicNames& names, ImuRecording& recording) {
    return read_bag_imu(*bag_, names, recording);
  }

  // Call after index(). calibration: of the colour images as recorded; if it has no camera of depth, that of
  // the recording is taken (depth_setup.hpp). Its unit of depth is ignored, because the encoding determines
  // it: metres, or whole units, which are units_per_metre, else what the recording states, else millimetres.
  // Returns the errors of RecordedCamera::open.
  Status open(const Calibration& calibration, const std::optional<double>& units_per_metre,
              const SequenceOptions& options);

  CameraModel model() const override { return fit_.calibration().camera; }
  // Returns kDamaged, with the topic and the reason, for a pair that cannot be read; the next call continues
  // after it.
  Status next(RgbdFrame& frame) override;

  std::size_t frame_count() const { return pairs_.size(); }
  std::size_t unpaired_colour() const { return unpaired_colour_; }
  const Calibration& calibration() const { return fit_.calibration(); }
  const WholeImage& whole_image() const { return fit_.whole_image(); }
  // The recording, and what was found in it, whether its topics could be chosen or not; nullptr if it cannot
  // be read.
  MessageFile* messages() const { return bag_.get(); }
  const TopicChoice& topics() const { return topics_; }
  // Hints for the user, in sentences. After a failure they may list the topics of the bag.
  std::vector<std::string> remarks() const;

 private:
  using Messages = std::vector<BagMessage>;

  Status read_image(std::size_t topic, const BagMessage& message, ImageMessage& image);
  Status of_topic(std::size_t topic, const Status& status) const;
  // Sorts messages by stamp; of equal stamps it keeps the first.
  Status in_order(std::size_t topic, Messages& messages);
  Status check_clock(std::size_t topic) const;
  Status pair_up(const SequenceOptions& options);
  Status find_sizes(ImageSize& colour, ImageSize& depth, bool& metres);
  Status read_colour(const BagMessage& message);
  Status read_depth(const BagMessage& message);

  std::unique_ptr<MessageFile> bag_;
  TopicChoice topics_;
  DepthSetup depth_setup_;
  ImageConversion conversion_;
  std::vector<std::pair<BagMessage, BagMessage>> pairs_;
  std::size_t unpaired_colour_ = 0, repeated_ = 0;
  FrameFit fit_;
  ImageSize colour_size_, depth_size_;
  std::string depth_encoding_, clock_remark_;
  std::vector<unsigned char> bytes_;
  std::size_t next_ = 0;
};

}  // namespace plvo

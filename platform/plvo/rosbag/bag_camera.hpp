// SPDX-License-Identifier: Apache-2.0
// A ROS 1 bag as a camera: sensor_msgs/Image of colour and of depth, paired by the stamps in their headers as
// in TUM folders, and sensor_msgs/CameraInfo as the calibration.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/images/frame_fit.hpp"
#include "plvo/replay/index/sequence_index.hpp"
#include "plvo/rosbag/bag_file.hpp"
#include "plvo/rosbag/bag_imu.hpp"
#include "plvo/rosbag/bag_topics.hpp"
#include "plvo/rosbag/messages.hpp"

namespace plvo {

class BagCamera final : public RgbdCamera {
 public:
  // Reads the bag once and chooses its topics. Returns the errors of BagFile::open; kNotFound for a missing
  // topic (listing the existing ones), kInvalidArgument if there are several candidates, kUnsupported for
  // compressed images.
  Status index(const std::filesystem::path& path, const BagTopicNames& names);

  // Calibration from the first camera_info. Returns kNotFound if there is none, kInvalidArgument if there are
  // only others than the one beside colour; else the status of parse_camera_info.
  Status own_calibration(Calibration& calibration);

  // See read_bag_imu; its topics are in `names`.
  Status read_imu(const BagTopicNames& names, ImuRecording& recording) {
    return read_bag_imu(bag_, names, recording);
  }

  // Call after index(). calibration: of the colour images as recorded. Its unit of depth is ignored, because
  // the encoding determines it: metres, or whole units, which are millimetres unless units_per_metre is
  // given. Returns the errors of RecordedCamera::open.
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
  // Hints for the user, in sentences. After a failure they may list the topics of the bag.
  std::vector<std::string> remarks() const;

 private:
  using Messages = std::vector<BagMessage>;

  void find_encodings();
  // The topics whose images have a fitting encoding.
  std::vector<std::size_t> candidates(bool depth) const;
  Status choose_images(const std::string& wanted, bool depth, std::size_t& topic);
  std::string info_beside_colour() const;
  Status choose_info(const std::string& wanted);
  Status read_image(const BagMessage& message, ImageMessage& image);
  // Appends as many names to the sentence as a status holds. If some do not fit, all of them become a remark.
  Status refused(StatusCode code, const std::string& sentence, const std::vector<std::string>& names);
  Status of_topic(std::size_t topic, const Status& status) const;
  std::vector<std::string> names_of(std::string_view type) const;
  std::vector<std::string> image_topics() const;
  std::string with_encoding(std::size_t topic) const;
  // Sorts messages by stamp; of equal stamps it keeps the first.
  Status in_order(std::size_t topic, Messages& messages);
  Status check_clock(std::size_t topic) const;
  Status pair_up(const SequenceOptions& options);
  Status find_sizes(ImageSize& colour, ImageSize& depth, bool& metres);
  Status read_colour(const BagMessage& message);
  Status read_depth(const BagMessage& message);

  BagFile bag_;
  std::size_t colour_topic_ = 0, depth_topic_ = 0;
  std::optional<std::size_t> info_topic_;
  std::vector<std::string> encodings_;  // of each topic's images
  std::string topics_in_words_;
  std::vector<std::pair<BagMessage, BagMessage>> pairs_;
  std::size_t unpaired_colour_ = 0, repeated_ = 0;
  FrameFit fit_;
  ImageSize colour_size_, depth_size_;
  std::string depth_encoding_, clock_remark_;
  std::vector<unsigned char> bytes_;
  std::size_t next_ = 0;
};

}  // namespace plvo

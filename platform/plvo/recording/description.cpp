// SPDX-License-Identifier: Apache-2.0
#include "plvo/recording/description.hpp"

#include <algorithm>

#include "plvo/recording/foreign_format.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"
#ifdef PLVO_HAVE_ROSBAG
#include "plvo/rosbag/bag_camera.hpp"
#include "plvo/rosbag/bag_poses.hpp"
#include "plvo/rosbag/topic_choice.hpp"
#endif

namespace plvo {
namespace {

namespace fs = std::filesystem;

std::uintmax_t bytes_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    const std::uintmax_t bytes = fs::file_size(path, error);
    return error ? 0 : bytes;
  }
  std::uintmax_t bytes = 0;
  for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) bytes += entry->file_size(ignored);
  }
  return bytes;
}

const char* format_of(const fs::path& path) {
  switch (container_of(path)) {
    case Container::kBag: return "ROS 1 bag";
    case Container::kMcap: return "MCAP file";
    case Container::kSqlite: return "database of rosbag2";
    case Container::kFolder: return "folder of rosbag2";
    case Container::kNone: break;
  }
  return "folder of images";
}

// stamps: at least in part in order.
void describe_stamps(std::vector<std::int64_t> stamps, DescribedTopic& topic) {
  std::sort(stamps.begin(), stamps.end());
  if (stamps.size() < 2 || stamps.front() == stamps.back()) return;
  topic.rate_hz =
      static_cast<double>(stamps.size() - 1) / (static_cast<double>(stamps.back() - stamps.front()) * 1e-9);
  for (std::size_t i = 1; i < stamps.size(); ++i)
    topic.longest_gap_s =
        std::max(topic.longest_gap_s, static_cast<double>(stamps[i] - stamps[i - 1]) * 1e-9);
}

// What `plvo run` would say of it, with the calibration in the recording.
void describe_opening(Recording& recording, RecordingDescription& description) {
  description.remarks = recording.remarks();
  if (!description.opens.ok()) return;
  description.frames = recording.frame_count();
  description.unpaired_colour = recording.unpaired_colour();
  description.calibration = recording.calibration();
  for (const std::string& assumed : recording.calibration().assumptions())
    description.remarks.push_back(assumed);
  description.whole_image = recording.whole_image();
  if (!recording.has_ground_truth()) description.missing.emplace_back("no true poses, to compare with");
  ImuRecording imu;
  const bool read = recording.read_imu(imu).ok();
  if (!read || imu.gyro.empty()) description.missing.emplace_back("no gyro, for --imu");
  if (!read || imu.accelerometer.empty()) description.missing.emplace_back("no accelerometer, for --imu");
}

Status describe_folder(const fs::path& path, const RecordingOptions& options,
                       RecordingDescription& description) {
  SequenceIndex index;
  if (Status status = read_sequence_index(path, options.sequence, index); !status.ok()) return status;
  std::vector<std::int64_t> stamps[2];
  for (const ImagePair& pair : index.pairs) {
    stamps[0].push_back(pair.colour.stamp_ns);
    stamps[1].push_back(pair.depth.stamp_ns);
  }
  const std::size_t unpaired[2] = {index.unpaired_colour, index.unpaired_depth};
  for (const int i : {0, 1}) {
    DescribedTopic topic;
    topic.name = topic.used_as = i == 0 ? "colour" : "depth";
    topic.type = "images";
    topic.messages = index.pairs.size() + unpaired[i];
    describe_stamps(stamps[i], topic);
    description.topics.push_back(std::move(topic));
  }
  if (!stamps[0].empty())
    description.duration_s = static_cast<double>(stamps[0].back() - stamps[0].front()) * 1e-9;
  return {};
}

#ifdef PLVO_HAVE_ROSBAG

void describe_topic(const MessageFile& bag, std::size_t number, DescribedTopic& topic) {
  const BagTopic& of = bag.topics()[number];
  topic.name = of.name;
  topic.type = of.type;
  topic.messages = of.messages;
  if (is_image_type(of.type)) {
    std::vector<std::int64_t> stamps;
    for (const BagMessage& message : bag.messages(number)) stamps.push_back(message.stamp_ns);
    return describe_stamps(std::move(stamps), topic);
  }
  const double duration_s = static_cast<double>(of.last_received_ns - of.first_received_ns) * 1e-9;
  if (of.messages > 1 && duration_s > 0) topic.rate_hz = static_cast<double>(of.messages - 1) / duration_s;
  topic.longest_gap_s = static_cast<double>(of.longest_gap_ns) * 1e-9;
}

Status describe_bag(const Recording& recording, const BagTopicNames& names,
                    RecordingDescription& description) {
  if (recording.bag() == nullptr) return description.opens;
  const MessageFile* bag = recording.bag()->messages();
  const TopicChoice& choice = recording.bag()->topics();
  const bool chosen = choice.chosen();
  std::size_t truth = 0;
  const bool has_truth = choose_bag_poses(*bag, names.truth, truth).ok();
  std::int64_t first_ns = INT64_MAX, last_ns = INT64_MIN;
  for (std::size_t i = 0; i < bag->topics().size(); ++i) {
    DescribedTopic topic;
    describe_topic(*bag, i, topic);
    const TopicChoice::Images& images = choice.images(i);
    topic.encoding = images.encoding;
    topic.width = images.width;
    topic.height = images.height;
    if (chosen && i == choice.colour()) topic.used_as = "colour";
    if (chosen && i == choice.depth()) topic.used_as = "depth";
    if (chosen && choice.colour_info() == i) topic.used_as = "calibration";
    if (chosen && choice.depth_info() == i && choice.depth_info() != choice.colour_info())
      topic.used_as = "calibration of depth";
    if (has_truth && i == truth) topic.used_as = "true poses";
    if (bag->topics()[i].type == kImuType) topic.used_as = "gyro, accelerometer";
    if (topic.messages > 0) {
      first_ns = std::min(first_ns, bag->topics()[i].first_received_ns);
      last_ns = std::max(last_ns, bag->topics()[i].last_received_ns);
    }
    description.topics.push_back(std::move(topic));
  }
  if (last_ns > first_ns) description.duration_s = static_cast<double>(last_ns - first_ns) * 1e-9;
  if (chosen && !choice.colour_info()) description.missing.emplace_back("no camera_info of colour");
  return {};
}

#else

// description.opens says which packages are missing.
Status describe_bag(const Recording&, const BagTopicNames&, RecordingDescription&) { return {}; }

#endif

}  // namespace

Status describe_recording(const fs::path& path, const RecordingOptions& options,
                          RecordingDescription& description) {
  description = {};
  if (Status status = refuse_foreign_format(path); !status.ok()) return status;
  description.format = format_of(path);
  description.bytes = bytes_of(path);
  Recording recording;
  const auto choose = [](const OwnCalibration& own, Calibration& calibration) { return own(calibration); };
  description.opens = recording.open(path, choose, options);
  const Status status = is_bag(path) ? describe_bag(recording, options.topics, description)
                                     : describe_folder(path, options, description);
  if (!status.ok()) return status;
  describe_opening(recording, description);
  return {};
}

}  // namespace plvo

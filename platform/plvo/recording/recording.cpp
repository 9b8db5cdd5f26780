// SPDX-License-Identifier: Apache-2.0
#include "plvo/recording/recording.hpp"

#include <fmt/core.h>

#include <utility>

#include "plvo/recording/foreign_format.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/checks/calibration_check.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "plvo/rosbag/containers/container_kind.hpp"
#ifdef PLVO_HAVE_ROSBAG
#include "plvo/rosbag/bag_camera.hpp"
#include "plvo/rosbag/bag_poses.hpp"
#include "plvo/rosbag/bag_wheels.hpp"
#include "plvo/rosbag/containers/open_container.hpp"
#endif

namespace plvo {

namespace fs = std::filesystem;

namespace {

#ifdef PLVO_HAVE_ROSBAG
Status read_poses_in_bag(const fs::path& bag, const std::string& topic, Trajectory& trajectory) {
  std::unique_ptr<MessageFile> messages;
  const Status status = open_messages(bag, messages);
  return status.ok() ? read_bag_poses(*messages, topic, trajectory) : status;
}
#else
Status without_bags() {
  return {StatusCode::kUnsupported,
          "this plvo was built without recordings of ROS: sudo apt install libbz2-dev liblz4-dev libzstd-dev "
          "libsqlite3-dev, then configure and build again"};
}

Status read_poses_in_bag(const fs::path&, const std::string&, Trajectory&) { return without_bags(); }
#endif

}  // namespace

bool is_bag(const fs::path& path) { return container_of(path) != Container::kNone; }

bool is_recording(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) || is_bag(path) || !refuse_foreign_format(path).ok();
}

fs::path bag_ground_truth_file(const fs::path& bag) {
  const fs::path normal = bag.lexically_normal();
  fs::path file = normal.has_filename() ? normal : normal.parent_path();
  file.replace_filename(file.stem().string() + "-groundtruth.txt");
  return file;
}

Status read_true_poses(const fs::path& recording, const SequenceOptions& options, Trajectory& trajectory,
                       const std::string& topic) {
  if (Status status = refuse_foreign_format(recording); !status.ok()) return status;
  if (!is_bag(recording)) return read_ground_truth(recording, options, trajectory);
  const fs::path file = bag_ground_truth_file(recording);
  std::error_code error;
  if (topic.empty() && fs::exists(file, error)) return read_trajectory({file, {}, {}}, trajectory);
  trajectory = {};
  Status status = read_poses_in_bag(recording, topic, trajectory);
  if (status.code() != StatusCode::kNotFound || !topic.empty()) return status;
  return {StatusCode::kNotFound,
          fmt::format("{} has no poses: put the true ones beside it, as {}, or name a trajectory",
                      recording.filename().string(), file.filename().string())};
}

Status Recording::open(const fs::path& path, const CalibrationChoice& choose,
                       const RecordingOptions& options) {
  *this = Recording();
  if (Status status = refuse_foreign_format(path); !status.ok()) return status;
  return is_bag(path) ? open_bag(path, choose, options) : open_folder(path, choose, options);
}

Status Recording::open_folder(const fs::path& folder, const CalibrationChoice& choose,
                              const RecordingOptions& options) {
  // Reports a folder that is not a sequence before a missing calibration.
  {
    SequenceIndex index;
    if (Status status = read_sequence_index(folder, options.sequence, index); !status.ok()) return status;
  }
  Calibration calibration;
  std::string guess;
  const auto own = [&](Calibration& found) { return sequence_calibration(folder, found, guess); };
  if (Status status = choose(own, calibration); !status.ok()) return status;
  auto camera = std::make_shared<RecordedCamera>();
  const Status status = camera->open(folder, calibration, options.sequence);
  whole_image_ = camera->whole_image();
  if (!status.ok()) return status;
  calibration_ = camera->calibration();
  frame_count_ = camera->frame_count();
  const SequenceIndex& index = camera->index();
  unpaired_colour_ = index.unpaired_colour;
  for (const std::string& sentence :
       {index.remark, guess, missing_of_tum(folder, calibration), camera->remark()})
    if (!sentence.empty()) remarks_.push_back(sentence);
  add_doubts_about(calibration);
  std::error_code error;
  true_poses_source_ = index.poses.empty() ? "groundtruth.txt" : "the poses of the frames";
  if (fs::exists(folder / "groundtruth.txt", error) || !index.poses.empty())
    read_true_poses_ = [folder, sequence = options.sequence](Trajectory& trajectory) {
      return read_ground_truth(folder, sequence, trajectory);
    };
  read_imu_ = [folder](ImuRecording& recording) { return read_imu_files(folder, recording); };
  camera_ = std::move(camera);
  return {};
}

void Recording::add_doubts_about(const Calibration& calibration) {
  for (const std::string& sentence :
       doubts_about(calibration.camera, whole_image_.width, whole_image_.height))
    remarks_.push_back(sentence);
}

#ifdef PLVO_HAVE_ROSBAG

Status Recording::open_bag(const fs::path& path, const CalibrationChoice& choose,
                           const RecordingOptions& options) {
  auto camera = std::make_shared<BagCamera>();
  Status status = camera->index(path, options.topics);
  if (camera->messages() != nullptr) bag_ = camera;
  Calibration calibration;
  const auto own = [&camera](Calibration& found) { return camera->own_calibration(found); };
  if (status.ok()) status = choose(own, calibration);
  if (status.ok()) {
    status = camera->open(calibration, options.depth_units_per_metre, options.sequence);
    whole_image_ = camera->whole_image();
  }
  remarks_ = camera->remarks();
  if (!status.ok()) return status;
  calibration_ = camera->calibration();
  frame_count_ = camera->frame_count();
  unpaired_colour_ = camera->unpaired_colour();
  if (std::string missing = missing_of_tum(path, calibration); !missing.empty())
    remarks_.push_back(std::move(missing));
  add_doubts_about(calibration);
  if (status = find_true_poses_of_bag(path, options.topics.truth); !status.ok()) return status;
  read_imu_ = [camera, topics = options.topics](ImuRecording& recording) {
    return camera->read_imu(topics, recording);
  };
  camera_ = std::move(camera);
  return {};
}

Status Recording::find_true_poses_of_bag(const fs::path& path, const std::string& topic) {
  std::error_code error;
  const fs::path file = bag_ground_truth_file(path);
  if (topic.empty() && fs::exists(file, error)) {
    true_poses_source_ = file.filename().string();
    read_true_poses_ = [file](Trajectory& trajectory) { return read_trajectory({file, {}, {}}, trajectory); };
    return {};
  }
  MessageFile& messages = *bag_->messages();
  std::size_t number = 0;
  const Status found = choose_bag_poses(messages, topic, number);
  if (!found.ok()) {
    if (!topic.empty()) return found;
    if (found.code() != StatusCode::kNotFound) remarks_.emplace_back(found.message());
    return {};
  }
  true_poses_source_ = messages.topics()[number].name;
  read_true_poses_ = [bag = bag_, name = true_poses_source_](Trajectory& trajectory) {
    return read_bag_poses(*bag->messages(), name, trajectory);
  };
  remarks_.push_back(
      fmt::format("the poses on {} are taken as the true poses of the camera", true_poses_source_));
  return {};
}

Status Recording::read_wheels(const std::string& topic, WheelRecording& recording) const {
  if (bag_ == nullptr) return {StatusCode::kUnsupported, "a topic of wheels needs a recording of ROS"};
  return read_bag_wheels(*bag_->messages(), topic, recording);
}

#else

Status Recording::read_wheels(const std::string&, WheelRecording&) const { return without_bags(); }

Status Recording::open_bag(const fs::path&, const CalibrationChoice&, const RecordingOptions&) {
  return without_bags();
}

#endif

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// A recorded sequence of any format: a folder of images (RecordedCamera) or a bag (BagCamera). A bag is any
// recording of messages: a ROS 1 bag, an MCAP file, or rosbag2's FILE.db3 or folder; all are recognised by
// their content and their name. They are supported if plvo was built with the libraries that they need.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/hal/rgbd_camera.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/images/image_reduction.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/index/sequence_index.hpp"
#include "plvo/replay/wheel_files.hpp"
#include "plvo/rosbag/bag_topics.hpp"

namespace plvo {

class BagCamera;

bool is_bag(const std::filesystem::path& path);
// True for a folder, a bag, or a recording that is not read (foreign_format.hpp); false for files of other
// kinds.
bool is_recording(const std::filesystem::path& path);

// File of the true poses of a bag, which come before those in the bag: FILE-groundtruth.txt beside FILE.bag,
// as TUM publishes the two.
std::filesystem::path bag_ground_truth_file(const std::filesystem::path& bag);
// Reads the true poses of a folder or a bag, like read_ground_truth. For a bag they are those of the file
// beside it, or those on a topic of the bag (bag_poses.hpp); topic: its name, may be empty. The message of
// kNotFound names the expected file.
Status read_true_poses(const std::filesystem::path& recording, const SequenceOptions& options,
                       Trajectory& trajectory, const std::string& topic = {});

struct RecordingOptions {
  SequenceOptions sequence;  // for a bag: the tolerance, the scale and the range
  BagTopicNames topics;
  std::optional<double> depth_units_per_metre;  // of a bag's whole units; by default millimetres
};

// Finds the calibration to use. own: reads that of the recording; kNotFound if it has none.
using OwnCalibration = std::function<Status(Calibration& calibration)>;
using CalibrationChoice = std::function<Status(const OwnCalibration& own, Calibration& calibration)>;

class Recording final : public RgbdCamera {
 public:
  // Returns the errors of RecordedCamera or BagCamera, and those of `choose`. Returns kUnsupported for a bag,
  // with the packages to install, if plvo was built without bags; also for a recording that is not read
  // (foreign_format.hpp).
  Status open(const std::filesystem::path& path, const CalibrationChoice& choose,
              const RecordingOptions& options = {});

  CameraModel model() const override { return calibration_.camera; }
  // Returns kDamaged, with the file and the reason, for a pair that cannot be read; the next call continues
  // after it.
  Status next(RgbdFrame& frame) override { return camera_->next(frame); }

  std::size_t frame_count() const { return frame_count_; }  // in the chosen range
  std::size_t unpaired_colour() const { return unpaired_colour_; }
  const Calibration& calibration() const { return calibration_; }  // in force, see FrameFit
  const WholeImage& whole_image() const { return whole_image_; }   // its width is 0 if the size is unknown
  // The true poses: see read_true_poses. true_poses_source: "/truth", or the name of a file.
  bool has_ground_truth() const { return static_cast<bool>(read_true_poses_); }
  Status read_true_poses(Trajectory& trajectory) const { return read_true_poses_(trajectory); }
  const std::string& true_poses_source() const { return true_poses_source_; }
  // The bag, also after open() failed; nullptr for a folder, and for a bag that cannot be read.
  const BagCamera* bag() const { return bag_.get(); }
  // Hints for the user, in sentences, without the assumptions of the calibration; also valid after open()
  // failed.
  const std::vector<std::string>& remarks() const { return remarks_; }

  // Reads the samples of a gyro and an accelerometer, with read_imu_files or read_bag_imu.
  Status read_imu(ImuRecording& recording) { return read_imu_(recording); }
  // Reads wheel odometry of a bag, with read_bag_wheels; kUnsupported for a folder: there the user
  // names the file.
  Status read_wheels(const std::string& topic, WheelRecording& recording) const;

 private:
  Status open_folder(const std::filesystem::path& folder, const CalibrationChoice& choose,
                     const RecordingOptions& options);
  Status open_bag(const std::filesystem::path& path, const CalibrationChoice& choose,
                  const RecordingOptions& options);
  Status find_true_poses_of_bag(const std::filesystem::path& path, const std::string& topic);
  // calibration: of the images as recorded.
  void add_doubts_about(const Calibration& calibration);

  std::shared_ptr<RgbdCamera> camera_;  // not unique: shared_ptr deletes the class that it was created with
  std::shared_ptr<BagCamera> bag_;
  std::function<Status(ImuRecording& recording)> read_imu_;
  std::function<Status(Trajectory& trajectory)> read_true_poses_;
  std::string true_poses_source_;
  Calibration calibration_;
  WholeImage whole_image_;
  std::size_t frame_count_ = 0, unpaired_colour_ = 0;
  std::vector<std::string> remarks_;
};

}  // namespace plvo

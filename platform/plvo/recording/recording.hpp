// SPDX-License-Identifier: Apache-2.0
// A recorded sequence, whatever it lies in: a folder (RecordedCamera) or a ROS 1 bag (BagCamera), which is
// told by its name. Bags are read where plvo was built with libbz2 and liblz4.
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
#include "plvo/rosbag/bag_topics.hpp"

namespace plvo {

bool is_bag_file(const std::filesystem::path& path);  // by its name, .bag
// A folder, a bag, or a recording that is not read (foreign_format.hpp); no file of another kind.
bool is_recording(const std::filesystem::path& path);

// The true poses of a bag, which are not read out of it: FILE-groundtruth.txt beside FILE.bag, as TUM
// publishes the two.
std::filesystem::path bag_ground_truth_file(const std::filesystem::path& bag);
// Of a folder or a bag: as read_ground_truth. kNotFound says where they are looked for.
Status read_true_poses(const std::filesystem::path& recording, const SequenceOptions& options,
                       Trajectory& trajectory);

struct RecordingOptions {
  SequenceOptions sequence;  // of a bag: the tolerance, the scale and the range
  BagTopicNames topics;
  std::optional<double> depth_units_per_metre;  // of a bag's whole units, which are millimetres else
};

// Finds the calibration to use. own: the one that the recording brings; kNotFound where it has none.
using OwnCalibration = std::function<Status(Calibration& calibration)>;
using CalibrationChoice = std::function<Status(const OwnCalibration& own, Calibration& calibration)>;

class Recording final : public RgbdCamera {
 public:
  // All of what RecordedCamera or BagCamera returns, and what `choose` does. kUnsupported, with what to
  // install, for a bag where they are left out, and for a recording that is not read (foreign_format.hpp).
  Status open(const std::filesystem::path& path, const CalibrationChoice& choose,
              const RecordingOptions& options = {});

  CameraModel model() const override { return calibration_.camera; }
  // kDamaged, with what and why, for a pair that cannot be read; the next call goes on after it.
  Status next(RgbdFrame& frame) override { return camera_->next(frame); }

  std::size_t frame_count() const { return frame_count_; }  // in the chosen range
  std::size_t unpaired_colour() const { return unpaired_colour_; }
  const Calibration& calibration() const { return calibration_; }  // in force, as of FrameFit
  const WholeImage& whole_image() const { return whole_image_; }   // of width 0 where that is not known
  bool has_ground_truth() const { return has_ground_truth_; }      // read_true_poses
  // Sentences for whoever runs it, but for what the calibration assumes; also where opening failed.
  const std::vector<std::string>& remarks() const { return remarks_; }

  // What a gyro and an accelerometer recorded beside the images: as read_imu_files, or as read_bag_imu.
  Status read_imu(ImuRecording& recording) { return read_imu_(recording); }

 private:
  Status open_folder(const std::filesystem::path& folder, const CalibrationChoice& choose,
                     const RecordingOptions& options);
  Status open_bag(const std::filesystem::path& path, const CalibrationChoice& choose,
                  const RecordingOptions& options);
  // calibration: of the images as recorded.
  void add_doubts_about(const Calibration& calibration);

  std::shared_ptr<RgbdCamera> camera_;  // not unique: it deletes the class that it was made with
  std::function<Status(ImuRecording& recording)> read_imu_;
  Calibration calibration_;
  WholeImage whole_image_;
  std::size_t frame_count_ = 0, unpaired_colour_ = 0;
  bool has_ground_truth_ = false;
  std::vector<std::string> remarks_;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/bag_recording.hpp"

#include "plvo/cli/common/arguments.hpp"
#ifdef PLVO_HAVE_ROSBAG
#include "plvo/rosbag/bag_camera.hpp"
#endif

namespace plvo::cli {

bool is_bag_file(const std::string& path) { return path.ends_with(".bag"); }

#ifdef PLVO_HAVE_ROSBAG

Status open_bag(const CameraOptions& options, const SequenceOptions& sequence, Log& log,
                OpenedCamera& opened) {
  auto camera = std::make_unique<BagCamera>();
  const BagTopics& topics = options.topics;
  if (Status status = camera->index(options.sequence, {topics.colour, topics.depth, topics.info});
      !status.ok())
    return status;
  Calibration calibration;
  const auto own = [&camera](Calibration& found) { return camera->own_calibration(found); };
  if (Status status = find_calibration(options.calibration, own, calibration); !status.ok()) return status;
  if (Status status = camera->open(calibration, options.calibration.depth_scale, sequence); !status.ok()) {
    refuse_scale(options.scale, camera->whole_image(), status);
    return status;
  }
  for (const std::string& sentence : camera->remarks()) log.write(LogLevel::kWarning, sentence);
  for (const std::string& sentence : camera->calibration().assumptions())
    log.write(LogLevel::kWarning, sentence);
  opened.frame_count = camera->frame_count();
  opened.unpaired_images = camera->unpaired_colour();
  opened.scaled_down_by = camera->whole_image().factor;
  opened.camera = std::move(camera);
  return {};
}

#else

Status open_bag(const CameraOptions&, const SequenceOptions&, Log&, OpenedCamera&) {
  return {StatusCode::kUnsupported,
          "this plvo was built without ROS bags: sudo apt install libbz2-dev liblz4-dev, then configure and "
          "build again"};
}

#endif

}  // namespace plvo::cli

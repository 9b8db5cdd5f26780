// SPDX-License-Identifier: Apache-2.0
// What the nodes of ROS 1 and ROS 2 have in common, which is all but the middleware: parameters, frames that
// wait, and the diagnosis. Valid as C++17, like ros_odometry.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plvo/c/plvo.h"
#include "plvo/ros/ros_odometry.hpp"

namespace plvo {

struct RosNodeSettings {
  std::string base_frame = "base_link", odom_frame = "odom", base_camera, camera_imu;
  bool publish_tf = true, exact_sync = false;
  double max_interval_s = 0.02, imu_wait_s = 0.1;
  int queue_size = 10;
  RosOdometrySettings odometry;

  // Calls read(name, value) for each parameter.
  template <typename Read>
  void for_each(Read&& read) {
    read("base_frame", base_frame);
    read("odom_frame", odom_frame);
    read("base_camera", base_camera);
    read("camera_imu", camera_imu);
    read("publish_tf", publish_tf);
    read("exact_sync", exact_sync);
    read("max_interval_s", max_interval_s);
    read("queue_size", queue_size);
    read("imu", odometry.imu);
    read("imu_wait_s", imu_wait_s);
    read("level", odometry.level);
    read("depth_units_per_metre", odometry.depth_units_per_metre);
    read("stamp_sigma_s", odometry.stamp_sigma_s);
  }
};

enum class RosLevel : std::uint8_t { kOk, kWarn, kError };  // the numbers of diagnostic_msgs/DiagnosticStatus

struct RosDiagnosis {
  RosLevel level = RosLevel::kOk;
  std::string message, hardware_id;
  std::vector<std::pair<std::string, std::string>> values;
};

// The full names of the topics, for messages.
struct RosTopics {
  std::string colour, depth, camera_info, imu;
};

// What the middleware does for a node.
struct RosMiddleware {
  // The latest transform that maps coordinates in source to target, or none if tf does not know it.
  std::function<std::optional<RosPose>(const std::string& target, const std::string& source)> look_up;
  std::function<void(const RosEstimate&)> publish;  // only estimates with a pose
  std::function<void(const RosDiagnosis&)> diagnose;
  std::function<void(RosLevel, const std::string&)> log;
};

// A node calls its functions from one thread.
class RosNode {
 public:
  PLVO_API RosNode(const RosNodeSettings& settings, RosMiddleware middleware);
  PLVO_API ~RosNode();

  // Returns what is wrong with the settings, or nothing. Call it before the functions below.
  PLVO_API std::string start();
  PLVO_API void set_topics(const RosTopics& topics);
  // Messages that wait on a topic: at least one.
  PLVO_API std::uint32_t queue_length() const;

  PLVO_API void add_camera_info(const RosMessage& camera_info);
  PLVO_API void add_camera_info(const RosCameraInfo& camera_info);
  PLVO_API void add_imu(const RosMessage& imu, const std::string& frame);
  PLVO_API void add_imu(const RosImu& imu, const std::string& frame);
  // Two images that belong together, with the stamp and the frame of colour. `track` keeps them, and hands
  // them to RosOdometry::track.
  using Track = std::function<RosEstimate(RosOdometry&)>;
  PLVO_API void add_frame(std::int64_t stamp_ns, const std::string& camera_frame, Track track);

  PLVO_API void poll();      // each 50 ms: frames do not wait forever
  PLVO_API void diagnose();  // each second

  // Returns what the service answers.
  PLVO_API std::string reset();
  PLVO_API void set_pose(const std::string& frame, const RosPose& T_odom_base,
                         const RosCovariance& covariance);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace plvo

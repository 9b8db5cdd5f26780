// SPDX-License-Identifier: Apache-2.0
// Stand-ins for what the node of docs/user/robots.md uses of ROS 2: members and signatures as it calls them,
// and no more. A test puts frames in by hand and takes the messages out.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace builtin_interfaces::msg {
struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
}  // namespace builtin_interfaces::msg

namespace std_msgs::msg {
struct Header {
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace geometry_msgs::msg {
struct Point {
  double x = 0, y = 0, z = 0;
  Point& set__x(double value) { return x = value, *this; }
  Point& set__y(double value) { return y = value, *this; }
  Point& set__z(double value) { return z = value, *this; }
};
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
  Quaternion& set__x(double value) { return x = value, *this; }
  Quaternion& set__y(double value) { return y = value, *this; }
  Quaternion& set__z(double value) { return z = value, *this; }
  Quaternion& set__w(double value) { return w = value, *this; }
};
struct Pose {
  Point position;
  Quaternion orientation;
};
struct PoseWithCovariance {
  Pose pose;
  std::array<double, 36> covariance{};
};
}  // namespace geometry_msgs::msg

namespace nav_msgs::msg {
struct Odometry {
  std_msgs::msg::Header header;
  std::string child_frame_id;
  geometry_msgs::msg::PoseWithCovariance pose;
};
}  // namespace nav_msgs::msg

namespace sensor_msgs::msg {
struct Image {
  using ConstSharedPtr = std::shared_ptr<const Image>;
  std_msgs::msg::Header header;
  std::uint32_t height = 0, width = 0, step = 0;
  std::string encoding;
  std::vector<std::uint8_t> data;
};
struct CameraInfo {
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};
};
}  // namespace sensor_msgs::msg

namespace rclcpp {

class Time {
 public:
  explicit Time(const builtin_interfaces::msg::Time& time)
      : nanoseconds_(std::int64_t{1'000'000'000} * time.sec + time.nanosec) {}
  std::int64_t nanoseconds() const { return nanoseconds_; }

 private:
  std::int64_t nanoseconds_;
};

// What a test puts in and takes out.
struct Wires {
  std::map<std::string, std::vector<double>> parameters;
  std::function<void(const sensor_msgs::msg::CameraInfo&)> camera_info;
  std::function<void(const sensor_msgs::msg::Image::ConstSharedPtr&,
                     const sensor_msgs::msg::Image::ConstSharedPtr&)>
      both_images;
  std::vector<nav_msgs::msg::Odometry> published;
  std::vector<std::string> logged;
};
inline Wires wires;

struct Logger {};
inline void log(const Logger&, const char* format, const char* text = "") {
  char line[512];
  std::snprintf(line, sizeof line, format, text);
  wires.logged.emplace_back(line);
}
#define RCLCPP_WARN(...) rclcpp::log(__VA_ARGS__)
#define RCLCPP_FATAL(...) rclcpp::log(__VA_ARGS__)

template <typename Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
};
template <typename Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const Message& message) { wires.published.push_back(message); }
};

class Node {
 public:
  explicit Node(const std::string&) {}
  template <typename Value>
  Value declare_parameter(const std::string& name, const Value& fallback) {
    const auto found = wires.parameters.find(name);
    return found == wires.parameters.end() ? fallback : found->second;
  }
  template <typename Message>
  typename Publisher<Message>::SharedPtr create_publisher(const std::string&, int) {
    return std::make_shared<Publisher<Message>>();
  }
  template <typename Message, typename Callback>
  typename Subscription<Message>::SharedPtr create_subscription(const std::string&, int, Callback callback) {
    wires.camera_info = callback;
    return std::make_shared<Subscription<Message>>();
  }
  Logger get_logger() const { return {}; }
};

inline std::function<void()> while_spinning;
inline void init(int, char**) {}
inline void spin(const std::shared_ptr<Node>&) { while_spinning(); }
inline bool shutdown() { return true; }

}  // namespace rclcpp

namespace message_filters {

template <typename Message>
struct Subscriber {
  Subscriber(rclcpp::Node*, const std::string&) {}
};
namespace sync_policies {
template <typename First, typename Second>
struct ApproximateTime {
  explicit ApproximateTime(int) {}
};
}  // namespace sync_policies
template <typename Policy>
struct Synchronizer {
  template <typename First, typename Second>
  Synchronizer(const Policy&, First&, Second&) {}
  template <typename Callback>
  void registerCallback(Callback callback) {
    rclcpp::wires.both_images = callback;
  }
};

}  // namespace message_filters

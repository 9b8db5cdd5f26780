// SPDX-License-Identifier: Apache-2.0
// The node for ROS 2: images of colour and depth in, odometry out. docs/user/robots.md describes its topics
// and parameters. C++17, as ROS 2 is.
#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <tf2/exceptions.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <exception>
#include <functional>
#include <geometry_msgs/msg/pose_with_covariance_stamped.hpp>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <memory>
#include <nav_msgs/msg/odometry.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <type_traits>

#include "plvo/ros/ros_messages.hpp"
#include "plvo/ros/ros_node.hpp"

namespace plvo {
namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using geometry_msgs::msg::PoseWithCovarianceStamped, geometry_msgs::msg::TransformStamped;
using nav_msgs::msg::Odometry;
using sensor_msgs::msg::CameraInfo, sensor_msgs::msg::Image, sensor_msgs::msg::Imu;
using std_srvs::srv::Trigger;
using ImagePtr = Image::ConstSharedPtr;

std::int64_t stamp_ns(const std_msgs::msg::Header& header) {
  return rclcpp::Time(header.stamp).nanoseconds();
}

RosImage fields_of(const Image& image) {
  return {stamp_ns(image.header),  image.width, image.height,      image.encoding,
          image.is_bigendian != 0, image.step,  image.data.data(), image.data.size()};
}

RosImu fields_of(const Imu& imu) {
  const auto &w = imu.angular_velocity, &a = imu.linear_acceleration;
  return {stamp_ns(imu.header),
          {w.x, w.y, w.z},
          {a.x, a.y, a.z},
          imu.angular_velocity_covariance[0],
          imu.linear_acceleration_covariance[0]};
}

class OdometryNode : public rclcpp::Node {
 public:
  OdometryNode()
      : Node("plvo"),
        settings_(read_parameters()),
        node_(settings_, middleware()),
        tf_(get_clock()),
        listener_(tf_),
        broadcaster_(*this),
        approximate_(ApproximateTime(node_.queue_length())),
        exact_(ExactTime(node_.queue_length())) {}

  // Returns what is wrong with a parameter, or nothing.
  std::string start() {
    const std::string wrong = node_.start();
    if (!wrong.empty()) return wrong;
    using std::placeholders::_1, std::placeholders::_2;
    const auto add_pair = std::bind(&OdometryNode::add_pair, this, _1, _2);
    approximate_.setMaxIntervalDuration(rclcpp::Duration::from_seconds(settings_.max_interval_s));
    if (settings_.exact_sync) {
      exact_.connectInput(colour_filter_, depth_filter_);
      exact_.registerCallback(add_pair);
    } else {
      approximate_.connectInput(colour_filter_, depth_filter_);
      approximate_.registerCallback(add_pair);
    }
    const std::size_t queue = node_.queue_length();
    odometry_publisher_ = create_publisher<Odometry>("odom", rclcpp::QoS(queue));
    diagnostics_publisher_ = create_publisher<DiagnosticArray>("/diagnostics", rclcpp::QoS(queue));
    reset_service_ = create_service<Trigger>(
        "~/reset", [this](std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
          response->message = node_.reset();
          response->success = true;
        });
    set_pose_subscription_ = create_subscription<PoseWithCovarianceStamped>(
        "~/set_pose", rclcpp::QoS(queue),
        [this](const PoseWithCovarianceStamped& pose) { set_pose_of(pose, node_); });
    // Best effort takes what drivers send of either reliability.
    const auto sensor = [](std::size_t depth) { return rclcpp::SensorDataQoS().keep_last(depth); };
    info_subscription_ = create_subscription<
        CameraInfo>("camera_info", sensor(queue), [this](const CameraInfo& info) {
      node_.add_camera_info(RosCameraInfo{info.width, info.height, info.distortion_model, info.d, info.k});
    });
    if (settings_.odometry.imu)  // several readings a frame
      imu_subscription_ = create_subscription<Imu>("imu", sensor(100 * queue), [this](const Imu& imu) {
        node_.add_imu(fields_of(imu), imu.header.frame_id);
      });
    depth_subscription_ = create_subscription<Image>(
        "depth", sensor(queue), [this](const ImagePtr& image) { depth_filter_.add(image); });
    colour_subscription_ = create_subscription<Image>(
        "colour", sensor(queue), [this](const ImagePtr& image) { colour_filter_.add(image); });
    node_.set_topics({colour_subscription_->get_topic_name(), depth_subscription_->get_topic_name(),
                      info_subscription_->get_topic_name(),
                      imu_subscription_ ? imu_subscription_->get_topic_name() : ""});
    poll_ = create_wall_timer(std::chrono::milliseconds(50), [this] { node_.poll(); });
    diagnosis_ = create_wall_timer(std::chrono::seconds(1), [this] { node_.diagnose(); });
    return "";
  }

 private:
  using ApproximateTime = message_filters::sync_policies::ApproximateTime<Image, Image>;
  using ExactTime = message_filters::sync_policies::ExactTime<Image, Image>;

  RosNodeSettings read_parameters() {
    RosNodeSettings settings;
    settings.for_each([this](const std::string& name, auto& value) {
      value = static_cast<std::decay_t<decltype(value)>>(declare_parameter(name, value));
    });
    return settings;
  }

  RosMiddleware middleware() {
    return {[this](const std::string& target, const std::string& source) { return look_up(target, source); },
            [this](const RosEstimate& estimate) { publish(estimate); },
            [this](const RosDiagnosis& diagnosis) { publish(diagnosis); },
            [this](RosLevel level, const std::string& text) {
              if (level == RosLevel::kOk) RCLCPP_INFO(get_logger(), "%s", text.c_str());
              if (level != RosLevel::kOk) RCLCPP_WARN(get_logger(), "%s", text.c_str());
            }};
  }

  void add_pair(const ImagePtr& colour, const ImagePtr& depth) {
    node_.add_frame(stamp_ns(colour->header), colour->header.frame_id,
                    [colour, depth](RosOdometry& odometry) {
                      return odometry.track(fields_of(*colour), fields_of(*depth));
                    });
  }

  std::optional<RosPose> look_up(const std::string& target, const std::string& source) {
    try {
      const TransformStamped found = tf_.lookupTransform(target, source, tf2::TimePointZero);
      return pose_of(found.transform.translation, found.transform.rotation);
    } catch (const tf2::TransformException&) {
      return std::nullopt;
    }
  }

  void publish(const RosEstimate& estimate) {
    Odometry odometry;
    odometry.header.stamp = rclcpp::Time(estimate.stamp_ns);
    set_odometry(estimate, settings_, odometry);
    if (settings_.publish_tf) broadcaster_.sendTransform(transform_of<TransformStamped>(odometry));
    odometry_publisher_->publish(odometry);
  }

  void publish(const RosDiagnosis& diagnosis) {
    DiagnosticArray array;
    array.header.stamp = now();
    set_diagnosis(diagnosis, get_name(), array);
    diagnostics_publisher_->publish(array);
  }

  RosNodeSettings settings_;
  RosNode node_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener listener_;
  tf2_ros::TransformBroadcaster broadcaster_;
  message_filters::PassThrough<Image> colour_filter_, depth_filter_;
  message_filters::Synchronizer<ApproximateTime> approximate_;
  message_filters::Synchronizer<ExactTime> exact_;
  rclcpp::Subscription<Image>::SharedPtr colour_subscription_, depth_subscription_;
  rclcpp::Subscription<CameraInfo>::SharedPtr info_subscription_;
  rclcpp::Subscription<Imu>::SharedPtr imu_subscription_;
  rclcpp::Subscription<PoseWithCovarianceStamped>::SharedPtr set_pose_subscription_;
  rclcpp::Publisher<Odometry>::SharedPtr odometry_publisher_;
  rclcpp::Publisher<DiagnosticArray>::SharedPtr diagnostics_publisher_;
  rclcpp::Service<Trigger>::SharedPtr reset_service_;
  rclcpp::TimerBase::SharedPtr poll_, diagnosis_;
};

}  // namespace
}  // namespace plvo

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  std::string wrong;
  try {
    const auto node = std::make_shared<plvo::OdometryNode>();
    wrong = node->start();
    if (wrong.empty()) rclcpp::spin(node);
  } catch (const std::exception& error) {  // a parameter of another type
    wrong = error.what();
  }
  rclcpp::shutdown();
  if (!wrong.empty()) std::fprintf(stderr, "plvo: %s\n", wrong.c_str());
  return wrong.empty() ? 0 : 2;
}

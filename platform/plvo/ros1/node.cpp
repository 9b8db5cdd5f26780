// SPDX-License-Identifier: Apache-2.0
// The node for ROS 1: images of colour and depth in, odometry out. docs/user/robots.md describes its topics
// and parameters. C++17, for Debian's message headers do not compile as C++20.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <message_filters/pass_through.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <optional>
#include <string>

#include "plvo/ros/ros_messages.hpp"
#include "plvo/ros/ros_node.hpp"
#include "plvo/ros1/raw_message.hpp"

namespace plvo {
namespace {

using RawPtr = boost::shared_ptr<const RawMessage>;

// The parameters of the node. `wrong` names one that has another type.
RosNodeSettings read_parameters(const ros::NodeHandle& node, std::string& wrong) {
  RosNodeSettings settings;
  settings.for_each([&](const std::string& name, auto& value) {
    if (node.hasParam(name) && !node.getParam(name, value))
      wrong = name + " has a value of another type than share/doc/plvo/user/robots.md names";
  });
  return settings;
}

class Node {
 public:
  Node()
      : settings_(read_parameters(private_, wrong_)),
        node_(settings_, middleware()),
        listener_(tf_),
        approximate_(ApproximateTime(node_.queue_length())),
        exact_(ExactTime(node_.queue_length())) {}

  // Returns false if a parameter is wrong.
  bool start() {
    if (wrong_.empty()) wrong_ = node_.start();
    if (!wrong_.empty()) {
      ROS_FATAL("~%s", wrong_.c_str());
      return false;
    }
    approximate_.setMaxIntervalDuration(ros::Duration(settings_.max_interval_s));
    if (settings_.exact_sync) {
      exact_.connectInput(colour_filter_, depth_filter_);
      exact_.registerCallback(&Node::add_pair, this);
    } else {
      approximate_.connectInput(colour_filter_, depth_filter_);
      approximate_.registerCallback(&Node::add_pair, this);
    }
    const std::uint32_t queue = node_.queue_length();
    odometry_publisher_ = public_.advertise<nav_msgs::Odometry>("odom", queue);
    diagnostics_publisher_ = public_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", queue);
    reset_server_ = private_.advertiseService("reset", &Node::reset, this);
    set_pose_subscriber_ = private_.subscribe("set_pose", queue, &Node::set_pose, this);
    info_subscriber_ = public_.subscribe("camera_info", queue, &Node::on_camera_info, this);
    if (settings_.odometry.imu)  // several readings a frame
      imu_subscriber_ = public_.subscribe("imu", 100 * queue, &Node::on_imu, this);
    depth_subscriber_ = public_.subscribe("depth", queue, &Node::on_depth, this);
    colour_subscriber_ = public_.subscribe("colour", queue, &Node::on_colour, this);
    node_.set_topics({colour_subscriber_.getTopic(), depth_subscriber_.getTopic(),
                      info_subscriber_.getTopic(), imu_subscriber_.getTopic()});
    // The time of the wall: that of a simulation may stand still.
    poll_ = private_.createWallTimer(ros::WallDuration(0.05), &Node::poll, this);
    diagnosis_ = private_.createWallTimer(ros::WallDuration(1), &Node::diagnose_again, this);
    return true;
  }

 private:
  using ApproximateTime = message_filters::sync_policies::ApproximateTime<RawMessage, RawMessage>;
  using ExactTime = message_filters::sync_policies::ExactTime<RawMessage, RawMessage>;

  RosMiddleware middleware() {
    return {[this](const std::string& target, const std::string& source) { return look_up(target, source); },
            [this](const RosEstimate& estimate) { publish(estimate); },
            [this](const RosDiagnosis& diagnosis) { publish(diagnosis); },
            [](RosLevel level, const std::string& text) {
              if (level == RosLevel::kOk) ROS_INFO("%s", text.c_str());
              if (level != RosLevel::kOk) ROS_WARN("%s", text.c_str());
            }};
  }

  void on_colour(const RawPtr& image) { colour_filter_.add(image); }
  void on_depth(const RawPtr& image) { depth_filter_.add(image); }
  void on_camera_info(const RawPtr& info) { node_.add_camera_info(info->message); }
  void on_imu(const RawPtr& imu) { node_.add_imu(imu->message, imu->header.frame_id); }
  void add_pair(const RawPtr& colour, const RawPtr& depth) {
    node_.add_frame(
        static_cast<std::int64_t>(colour->header.stamp.toNSec()), colour->header.frame_id,
        [colour, depth](RosOdometry& odometry) { return odometry.track(colour->message, depth->message); });
  }
  void poll(const ros::WallTimerEvent&) { node_.poll(); }
  void diagnose_again(const ros::WallTimerEvent&) { node_.diagnose(); }

  std::optional<RosPose> look_up(const std::string& target, const std::string& source) {
    try {
      const geometry_msgs::Transform found = tf_.lookupTransform(target, source, ros::Time(0)).transform;
      return pose_of(found.translation, found.rotation);
    } catch (const tf2::TransformException&) {
      return std::nullopt;
    }
  }

  void publish(const RosEstimate& estimate) {
    nav_msgs::Odometry odometry;
    odometry.header.stamp.fromNSec(static_cast<std::uint64_t>(estimate.stamp_ns));
    set_odometry(estimate, settings_, odometry);
    if (settings_.publish_tf)
      broadcaster_.sendTransform(transform_of<geometry_msgs::TransformStamped>(odometry));
    odometry_publisher_.publish(odometry);
  }

  void publish(const RosDiagnosis& diagnosis) {
    diagnostic_msgs::DiagnosticArray array;
    array.header.stamp = ros::Time::now();
    set_diagnosis(diagnosis, ros::this_node::getName().substr(1), array);
    diagnostics_publisher_.publish(array);
  }

  bool reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    response.message = node_.reset();
    response.success = true;
    return true;
  }

  void set_pose(const geometry_msgs::PoseWithCovarianceStamped& message) { set_pose_of(message, node_); }

  ros::NodeHandle public_, private_{"~"};
  std::string wrong_;
  RosNodeSettings settings_;
  RosNode node_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener listener_;
  tf2_ros::TransformBroadcaster broadcaster_;
  message_filters::PassThrough<RawMessage> colour_filter_, depth_filter_;
  message_filters::Synchronizer<ApproximateTime> approximate_;
  message_filters::Synchronizer<ExactTime> exact_;
  ros::Subscriber colour_subscriber_, depth_subscriber_, info_subscriber_, imu_subscriber_,
      set_pose_subscriber_;
  ros::Publisher odometry_publisher_, diagnostics_publisher_;
  ros::ServiceServer reset_server_;
  ros::WallTimer poll_, diagnosis_;
};

}  // namespace
}  // namespace plvo

int main(int argc, char** argv) {
  ros::init(argc, argv, "plvo");
  plvo::Node node;
  if (!node.start()) return 2;
  ros::spin();
  return 0;
}

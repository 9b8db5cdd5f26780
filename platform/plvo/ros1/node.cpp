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

#include <algorithm>
#include <deque>
#include <optional>
#include <sstream>
#include <string>

#include "plvo/ros1/raw_message.hpp"

namespace plvo {
namespace {

using RawPtr = boost::shared_ptr<const RawMessage>;
constexpr double kComplaintPeriod_s = 5;
constexpr double kSilence_s = 2;  // without images, until the diagnosis says so

struct Parameters {
  explicit Parameters(const ros::NodeHandle& node) {
    read(node, "base_frame", base_frame);
    read(node, "odom_frame", odom_frame);
    read(node, "base_camera", base_camera);
    read(node, "camera_imu", camera_imu);
    read(node, "publish_tf", publish_tf);
    read(node, "exact_sync", exact_sync);
    read(node, "max_interval_s", max_interval_s);
    read(node, "queue_size", queue_size);
    read(node, "imu", odometry.imu);
    read(node, "imu_wait_s", imu_wait_s);
    read(node, "level", odometry.level);
    read(node, "depth_units_per_metre", odometry.depth_units_per_metre);
    read(node, "stamp_sigma_s", odometry.stamp_sigma_s);
  }

  std::string base_frame = "base_link", odom_frame = "odom", base_camera, camera_imu;
  bool publish_tf = true, exact_sync = false;
  double max_interval_s = 0.02, imu_wait_s = 0.1;
  int queue_size = 10;
  RosOdometrySettings odometry;
  std::string wrong;  // a parameter of another type

 private:
  template <typename Value>
  void read(const ros::NodeHandle& node, const std::string& name, Value& value) {
    if (node.hasParam(name) && !node.getParam(name, value))
      wrong = "~" + name + " has a value of another type than share/doc/plvo/user/robots.md names";
  }
};

// `count` numbers with spaces between them, and nothing else.
std::optional<std::vector<double>> numbers_of(const std::string& text, std::size_t count) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  if (!stream.eof() || numbers.size() != count) return std::nullopt;
  return numbers;
}

RosPose pose_of(const geometry_msgs::Transform& transform) {
  const auto& t = transform.translation;
  const auto& q = transform.rotation;
  return {{t.x, t.y, t.z}, {q.x, q.y, q.z, q.w}};
}

// plvo's reasons of a loss begin with the state.
std::string sentence(const std::string& state, const std::string& reason) {
  if (reason.empty()) return state;
  return reason.compare(0, state.size() + 1, state + ":") == 0 ? reason : state + ": " + reason;
}

class Node {
 public:
  Node()
      : parameters_(private_),
        odometry_(parameters_.odometry),
        listener_(tf_),
        approximate_(ApproximateTime(queue_length())),
        exact_(ExactTime(queue_length())) {}

  // Returns false if a parameter is wrong.
  bool start() {
    if (!check_parameters()) return false;
    approximate_.setMaxIntervalDuration(ros::Duration(parameters_.max_interval_s));
    if (parameters_.exact_sync) {
      exact_.connectInput(colour_filter_, depth_filter_);
      exact_.registerCallback(&Node::add_pair, this);
    } else {
      approximate_.connectInput(colour_filter_, depth_filter_);
      approximate_.registerCallback(&Node::add_pair, this);
    }
    odometry_publisher_ = public_.advertise<nav_msgs::Odometry>("odom", queue_length());
    diagnostics_publisher_ =
        public_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", queue_length());
    reset_server_ = private_.advertiseService("reset", &Node::reset, this);
    set_pose_subscriber_ = private_.subscribe("set_pose", queue_length(), &Node::set_pose, this);
    info_subscriber_ = public_.subscribe("camera_info", queue_length(), &Node::on_camera_info, this);
    if (parameters_.odometry.imu)  // several readings a frame
      imu_subscriber_ = public_.subscribe("imu", 100 * queue_length(), &Node::on_imu, this);
    depth_subscriber_ = public_.subscribe("depth", queue_length(), &Node::on_depth, this);
    colour_subscriber_ = public_.subscribe("colour", queue_length(), &Node::on_colour, this);
    camera_wanted_ = "images wait for camera_info on " + info_subscriber_.getTopic();
    waits_for_ = "no images with stamps that belong together have come on " + colour_subscriber_.getTopic() +
                 " and " + depth_subscriber_.getTopic();
    // The time of the wall: that of a simulation may stand still.
    poll_ = private_.createWallTimer(ros::WallDuration(0.05), &Node::poll, this);
    diagnosis_ = private_.createWallTimer(ros::WallDuration(1), &Node::diagnose_again, this);
    return true;
  }

 private:
  using ApproximateTime = message_filters::sync_policies::ApproximateTime<RawMessage, RawMessage>;
  using ExactTime = message_filters::sync_policies::ExactTime<RawMessage, RawMessage>;
  struct Pair {
    RawPtr colour, depth;
    ros::WallTime arrival;
  };

  std::uint32_t queue_length() const {
    return static_cast<std::uint32_t>(std::max(1, parameters_.queue_size));
  }

  bool check_parameters() {
    if (!parameters_.wrong.empty()) return refuse(parameters_.wrong);
    if (!parameters_.base_camera.empty()) {
      const auto n = numbers_of(parameters_.base_camera, 7);
      if (!n) return refuse("~base_camera must be seven numbers: tx ty tz qx qy qz qw");
      const auto& v = *n;
      const std::string wrong = odometry_.set_base_camera({{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}});
      if (!wrong.empty()) return refuse("~base_camera: " + wrong);
      base_is_known_ = true;
    }
    if (!parameters_.camera_imu.empty()) {
      const auto q = numbers_of(parameters_.camera_imu, 4);
      if (!q) return refuse("~camera_imu must be four numbers: qx qy qz qw");
      const std::string wrong = odometry_.set_imu_axes({(*q)[0], (*q)[1], (*q)[2], (*q)[3]});
      if (!wrong.empty()) return refuse("~camera_imu: " + wrong);
      imu_axes_are_known_ = true;
    }
    if (parameters_.odometry.level && !parameters_.odometry.imu)
      return refuse("~level is by the accelerometer of ~imu: set that, too");
    if (!(parameters_.max_interval_s >= 0)) return refuse("~max_interval_s must not be negative");
    return true;
  }
  static bool refuse(const std::string& why) {
    ROS_FATAL("%s", why.c_str());
    return false;
  }

  void on_colour(const RawPtr& image) { colour_filter_.add(image); }
  void on_depth(const RawPtr& image) { depth_filter_.add(image); }
  void on_camera_info(const RawPtr& info) {
    const std::string wrong = odometry_.set_camera(info->message);
    complain(wrong);
    if (!wrong.empty() && !odometry_.has_camera()) waits_for_ = camera_wanted_ = wrong;
    track_waiting();
  }

  void on_imu(const RawPtr& imu) {
    imu_frame_ = imu->header.frame_id;
    std::int64_t stamp_ns = 0;
    complain(odometry_.add_imu(imu->message, stamp_ns));
    last_imu_ns_ = std::max(last_imu_ns_, stamp_ns);
    track_waiting();
  }

  void add_pair(const RawPtr& colour, const RawPtr& depth) {
    camera_frame_ = colour->header.frame_id;
    last_pair_ = ros::WallTime::now();
    waiting_.push_back({colour, depth, last_pair_});
    track_waiting();
    if (waiting_.size() <= queue_length()) return;
    waiting_.pop_front();
    ++dropped_;
  }

  void poll(const ros::WallTimerEvent&) { track_waiting(); }

  // Frames wait for camera_info, for the place of the camera, and for a reading of the IMU that is later.
  void track_waiting() {
    while (!waiting_.empty() && can_track(waiting_.front())) {
      const Pair pair = waiting_.front();
      waiting_.pop_front();
      publish(odometry_.track(pair.colour->message, pair.depth->message), pair.colour->header.stamp);
    }
  }

  bool can_track(const Pair& pair) {
    if (!odometry_.has_camera()) return wait_for(camera_wanted_);
    if (!base_is_known_) {
      const auto place = look_up(parameters_.base_frame, pair.colour->header.frame_id, "~base_camera");
      if (!place) return false;
      complain(odometry_.set_base_camera(*place));
      base_is_known_ = true;
    }
    if (parameters_.odometry.imu && !imu_axes_are_known_) {
      if (imu_frame_.empty())
        return wait_for("images wait for a reading of the IMU on " + imu_subscriber_.getTopic());
      const auto turn = look_up(pair.colour->header.frame_id, imu_frame_, "~camera_imu");
      if (!turn) return false;
      complain(odometry_.set_imu_axes(turn->orientation));
      imu_axes_are_known_ = true;
    }
    waits_for_.clear();
    const auto stamp_ns = static_cast<std::int64_t>(pair.colour->header.stamp.toNSec());
    return !parameters_.odometry.imu || last_imu_ns_ > stamp_ns ||
           (ros::WallTime::now() - pair.arrival).toSec() > parameters_.imu_wait_s;
  }

  bool wait_for(const std::string& what) {
    waits_for_ = what;
    complain(what);
    return false;
  }

  std::optional<RosPose> look_up(const std::string& target, const std::string& source,
                                 const char* parameter) {
    try {
      return pose_of(tf_.lookupTransform(target, source, ros::Time(0)).transform);
    } catch (const tf2::TransformException&) {
      wait_for("images wait for a transform from " + source + " to " + target +
               ": publish it, or set the parameter " + parameter);
      return std::nullopt;
    }
  }

  void publish(const RosEstimate& estimate, const ros::Time& stamp) {
    ++frames_;
    if (!estimate.has_pose) ++without_pose_;
    const bool news = estimate.state != estimate_.state;
    estimate_ = estimate;
    const std::string text = sentence(estimate.state, estimate.reason);
    if (news && estimate.reason.empty()) ROS_INFO("%s", text.c_str());
    if (news && !estimate.reason.empty()) ROS_WARN("%s", text.c_str());
    if (news) diagnose();
    if (!estimate.has_pose) return;

    nav_msgs::Odometry odometry;
    odometry.header.stamp = stamp;
    odometry.header.frame_id = parameters_.odom_frame;
    odometry.child_frame_id = parameters_.base_frame;
    const auto& t = estimate.pose.position;
    const auto& q = estimate.pose.orientation;
    odometry.pose.pose.position.x = t[0];
    odometry.pose.pose.position.y = t[1];
    odometry.pose.pose.position.z = t[2];
    odometry.pose.pose.orientation.x = q[0];
    odometry.pose.pose.orientation.y = q[1];
    odometry.pose.pose.orientation.z = q[2];
    odometry.pose.pose.orientation.w = q[3];
    std::copy(estimate.pose_covariance.begin(), estimate.pose_covariance.end(),
              odometry.pose.covariance.begin());
    const auto& v = estimate.twist;
    odometry.twist.twist.linear.x = v[0];
    odometry.twist.twist.linear.y = v[1];
    odometry.twist.twist.linear.z = v[2];
    odometry.twist.twist.angular.x = v[3];
    odometry.twist.twist.angular.y = v[4];
    odometry.twist.twist.angular.z = v[5];
    std::copy(estimate.twist_covariance.begin(), estimate.twist_covariance.end(),
              odometry.twist.covariance.begin());
    if (parameters_.publish_tf) {
      geometry_msgs::TransformStamped transform;
      transform.header = odometry.header;
      transform.child_frame_id = odometry.child_frame_id;
      transform.transform.translation.x = t[0];
      transform.transform.translation.y = t[1];
      transform.transform.translation.z = t[2];
      transform.transform.rotation = odometry.pose.pose.orientation;
      broadcaster_.sendTransform(transform);
    }
    odometry_publisher_.publish(odometry);
  }

  void diagnose_again(const ros::WallTimerEvent&) { diagnose(); }
  void diagnose() {
    using diagnostic_msgs::DiagnosticStatus;
    DiagnosticStatus status;
    status.name = ros::this_node::getName().substr(1) + ": odometry";
    status.hardware_id = camera_frame_;
    const double silence_s = last_pair_.isZero() ? 0 : (ros::WallTime::now() - last_pair_).toSec();
    if (silence_s > kSilence_s)
      waits_for_ = "no images have come for " + std::to_string(static_cast<int>(silence_s)) + " s";
    const bool waits = !waits_for_.empty();
    const std::string state = waits ? "waiting" : estimate_.state;
    const std::string reason = waits ? waits_for_ : estimate_.reason;
    status.message = sentence(state, reason);
    status.level = DiagnosticStatus::OK;
    if (waits || !estimate_.has_pose || state == "predicted") status.level = DiagnosticStatus::WARN;
    if (state == "error") status.level = DiagnosticStatus::ERROR;
    const auto add = [&status](const char* key, const std::string& value) {
      diagnostic_msgs::KeyValue pair;
      pair.key = key;
      pair.value = value;
      status.values.push_back(pair);
    };
    add("state", state);
    add("reason", reason);
    add("frames", std::to_string(frames_));
    add("frames without a pose", std::to_string(without_pose_));
    add("frames dropped while they waited", std::to_string(dropped_));
    add("inliers, points", std::to_string(estimate_.points));
    add("inliers, lines", std::to_string(estimate_.lines));
    add("poses set", std::to_string(poses_set_));
    diagnostic_msgs::DiagnosticArray array;
    array.header.stamp = ros::Time::now();
    array.status.push_back(status);
    diagnostics_publisher_.publish(array);
  }

  bool reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    odometry_.reset();
    waiting_.clear();
    last_imu_ns_ = 0;
    response.success = true;
    response.message = "the next frame is the first one";
    return true;
  }

  void set_pose(const geometry_msgs::PoseWithCovarianceStamped& message) {
    if (!message.header.frame_id.empty() && message.header.frame_id != parameters_.odom_frame) {
      complain("set_pose: the pose is in " + message.header.frame_id + ", not in " + parameters_.odom_frame);
      return;
    }
    const auto& p = message.pose.pose.position;
    const auto& q = message.pose.pose.orientation;
    RosCovariance covariance;
    std::copy(message.pose.covariance.begin(), message.pose.covariance.end(), covariance.begin());
    const std::string wrong = odometry_.set_pose({{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}}, covariance);
    complain(wrong);
    if (wrong.empty()) ++poses_set_;
    diagnose();
  }

  // A message that may come again with every frame: logged when it is new, and then every few seconds.
  void complain(const std::string& text) {
    if (text.empty()) return;
    const ros::WallTime now = ros::WallTime::now();
    if (text == complaint_ && (now - complained_).toSec() < kComplaintPeriod_s) return;
    complaint_ = text;
    complained_ = now;
    ROS_WARN("%s", text.c_str());
  }

  ros::NodeHandle public_, private_{"~"};
  Parameters parameters_;
  RosOdometry odometry_;
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

  std::deque<Pair> waiting_;
  std::string camera_frame_, imu_frame_;
  bool base_is_known_ = false, imu_axes_are_known_ = false;
  std::int64_t last_imu_ns_ = 0;
  RosEstimate estimate_;
  std::uint64_t frames_ = 0, without_pose_ = 0, dropped_ = 0, poses_set_ = 0;
  std::string waits_for_, camera_wanted_, complaint_;
  ros::WallTime complained_, last_pair_;
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

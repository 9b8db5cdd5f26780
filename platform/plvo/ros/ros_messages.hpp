// SPDX-License-Identifier: Apache-2.0
// Messages of nav_msgs, geometry_msgs and diagnostic_msgs. Their fields have the same names in ROS 1 and in
// ROS 2, so that both nodes fill and read them here. Valid as C++17; stamps are the caller's, since their
// types differ.
#pragma once

#include <algorithm>

#include "plvo/ros/ros_node.hpp"

namespace plvo {

// p: three numbers, of a Point or Vector3.
template <typename Vector>
void set_vector(const double* p, Vector& message) {
  message.x = p[0];
  message.y = p[1];
  message.z = p[2];
}

// Makes a pose of a point or a translation, and a quaternion.
template <typename Vector, typename Quaternion>
RosPose pose_of(const Vector& t, const Quaternion& q) {
  return {{t.x, t.y, t.z}, {q.x, q.y, q.z, q.w}};
}

// All of nav_msgs/Odometry but its stamp.
template <typename Odometry>
void set_odometry(const RosEstimate& estimate, const RosNodeSettings& settings, Odometry& message) {
  message.header.frame_id = settings.odom_frame;
  message.child_frame_id = settings.base_frame;
  set_vector(estimate.pose.position.data(), message.pose.pose.position);
  const auto& q = estimate.pose.orientation;
  auto& orientation = message.pose.pose.orientation;
  orientation.x = q[0];
  orientation.y = q[1];
  orientation.z = q[2];
  orientation.w = q[3];
  std::copy(estimate.pose_covariance.begin(), estimate.pose_covariance.end(),
            message.pose.covariance.begin());
  set_vector(estimate.twist.data(), message.twist.twist.linear);
  set_vector(estimate.twist.data() + 3, message.twist.twist.angular);
  std::copy(estimate.twist_covariance.begin(), estimate.twist_covariance.end(),
            message.twist.covariance.begin());
}

// The transform of tf that nav_msgs/Odometry states.
template <typename TransformStamped, typename Odometry>
TransformStamped transform_of(const Odometry& odometry) {
  TransformStamped message;
  message.header = odometry.header;
  message.child_frame_id = odometry.child_frame_id;
  const auto& p = odometry.pose.pose.position;
  const double t[3] = {p.x, p.y, p.z};
  set_vector(t, message.transform.translation);
  message.transform.rotation = odometry.pose.pose.orientation;
  return message;
}

// All of diagnostic_msgs/DiagnosticArray but its stamp. node: its name.
template <typename DiagnosticArray>
void set_diagnosis(const RosDiagnosis& diagnosis, const std::string& node, DiagnosticArray& message) {
  message.status.emplace_back();
  auto& status = message.status.back();
  status.name = node + ": odometry";
  status.hardware_id = diagnosis.hardware_id;
  status.message = diagnosis.message;
  status.level = static_cast<decltype(status.level)>(diagnosis.level);
  for (const auto& [key, value] : diagnosis.values) {
    status.values.emplace_back();
    status.values.back().key = key;
    status.values.back().value = value;
  }
}

// Hands a geometry_msgs/PoseWithCovarianceStamped to a node.
template <typename PoseWithCovarianceStamped>
void set_pose_of(const PoseWithCovarianceStamped& message, RosNode& node) {
  RosCovariance covariance;
  std::copy(message.pose.covariance.begin(), message.pose.covariance.end(), covariance.begin());
  node.set_pose(message.header.frame_id, pose_of(message.pose.pose.position, message.pose.pose.orientation),
                covariance);
}

}  // namespace plvo

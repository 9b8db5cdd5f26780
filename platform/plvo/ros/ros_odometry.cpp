// SPDX-License-Identifier: Apache-2.0
#include "plvo/ros/ros_odometry.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/host/motion_twist.hpp"
#include "plvo/host/robot_base.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/images/frame_fit.hpp"
#include "plvo/rosbag/messages/image_conversion.hpp"
#include "plvo/rosbag/messages/messages.hpp"

namespace plvo {
namespace {

constexpr std::size_t kWaitingSamples = 4096;  // ten seconds at 400 Hz between two frames
constexpr double kLengthTolerance = 0.01;      // of a quaternion that was typed

std::string words(const Status& status) { return status.ok() ? std::string() : status.message(); }

Status pose_of(const RosPose& ros, Se3& pose) {
  const auto& q = ros.orientation;
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) <= kLengthTolerance))
    return {StatusCode::kInvalidArgument,
            fmt::format("the quaternion x y z w must have the length 1, not {:.4g}", length)};
  pose = {to_rotation({q[0], q[1], q[2], q[3]}), {ros.position[0], ros.position[1], ros.position[2]}};
  if (!pose.is_finite()) return {StatusCode::kInvalidArgument, "the position must be finite"};
  return {};
}

RosPose ros_pose(const Se3& pose) {
  const Quaternion q = to_quaternion(pose.R);
  return {{pose.t.x(), pose.t.y(), pose.t.z()}, {q.x, q.y, q.z, q.w}};
}

RosCovariance ros_covariance(const Matrix6& covariance) {
  RosCovariance rows;
  for (int i = 0; i < 36; ++i) rows[static_cast<std::size_t>(i)] = covariance(i / 6, i % 6);
  return rows;
}

bool same_camera(const CameraModel& a, const CameraModel& b) {
  const Distortion &d = a.distortion, &e = b.distortion;
  return a.width == b.width && a.height == b.height && a.pinhole.fx == b.pinhole.fx &&
         a.pinhole.fy == b.pinhole.fy && a.pinhole.cx == b.pinhole.cx && a.pinhole.cy == b.pinhole.cy &&
         d.model == e.model && d.k1 == e.k1 && d.k2 == e.k2 && d.p1 == e.p1 && d.p2 == e.p2 && d.k3 == e.k3 &&
         d.k4 == e.k4 && d.k5 == e.k5 && d.k6 == e.k6;
}

}  // namespace

struct RosOdometry::State {
  std::string set_camera(const Calibration& calibration);
  std::string add_imu(const ImuMessage& message);
  Status init(const ImageMessage& colour, const ImageMessage& depth);
  Status read(const RosMessage& message, ImageMessage& image);
  Status read(const RosImage& message, ImageMessage& image);
  Status make_frame(const ImageMessage& colour, const ImageMessage& depth, RgbdFrame& frame);
  template <typename Image>
  RosEstimate track(const Image& colour, const Image& depth);
  Status start_imu();
  struct PoseWithCovariance {
    Se3 T_odom_base;
    Matrix6 covariance;
  };
  Status set_pose(const PoseWithCovariance& base);
  void report(const TrackResult& result, RosEstimate& estimate);

  RosOdometrySettings settings;
  std::optional<Calibration> first_camera, latest_camera;
  Se3 T_base_camera, T_odom_world;
  bool started = false;                          // a frame has a pose
  bool level_is_due = true;                      // T_odom_world follows from the next frame with a pose
  std::uint32_t first_world = 0;                 // number of the odometry's first world
  std::uint32_t world = 0;                       // of the last result
  std::optional<PoseWithCovariance> early_pose;  // set before there were images

  ImageConversion conversion;
  FrameFit fit;
  ImageSize colour_size, depth_size;
  std::string depth_encoding;
  std::vector<std::byte> memory;
  std::optional<Odometry> odometry;  // for images like the first ones
  MotionTwist twist;

  ImuConfig imu_config;
  std::vector<ImuSample> gyro, accelerometer;
  ImuIntegrator imu;
};

RosOdometry::RosOdometry(const RosOdometrySettings& settings) : state_(std::make_unique<State>()) {
  state_->settings = settings;
  state_->gyro.resize(kWaitingSamples);
  state_->accelerometer.resize(kWaitingSamples);
  (void)state_->start_imu();  // the default axes are valid
}
RosOdometry::~RosOdometry() = default;

Status RosOdometry::State::start_imu() { return imu.init(gyro, accelerometer, imu_config); }

std::string RosOdometry::set_camera(const RosMessage& camera_info) {
  if (camera_info.type != kCameraInfoType)
    return fmt::format("camera_info is of the type {}, not {}", camera_info.type, kCameraInfoType);
  Calibration calibration;
  if (const Status status = parse_camera_info(WireFormat::kRos1, camera_info.bytes, calibration);
      !status.ok())
    return fmt::format("camera_info: {}", status.message());
  return state_->set_camera(calibration);
}

std::string RosOdometry::set_camera(const RosCameraInfo& camera_info) {
  Calibration calibration;
  if (const Status status = calibration_of(
          {camera_info.width, camera_info.height, camera_info.distortion_model, camera_info.D, camera_info.K},
          calibration);
      !status.ok())
    return fmt::format("camera_info: {}", status.message());
  return state_->set_camera(calibration);
}

std::string RosOdometry::State::set_camera(const Calibration& calibration) {
  const bool changed = latest_camera && !same_camera(latest_camera->camera, calibration.camera);
  latest_camera = calibration;
  if (!first_camera) first_camera = calibration;
  return changed ? "camera_info has changed; frames are tracked with the first one until reset is called"
                 : "";
}

bool RosOdometry::has_camera() const { return state_->first_camera.has_value(); }

std::string RosOdometry::set_base_camera(const RosPose& T_base_camera) {
  State& state = *state_;
  const Status status = pose_of(T_base_camera, state.T_base_camera);
  if (status.ok()) state.T_odom_world = state.T_base_camera;
  return words(status);
}

std::string RosOdometry::set_imu_axes(const std::array<double, 4>& q_camera_imu) {
  Se3 turn;
  Status status = pose_of({{}, q_camera_imu}, turn);
  if (!status.ok()) return words(status);
  state_->imu_config.R_camera_imu = turn.R;
  return words(state_->start_imu());
}

std::string RosOdometry::add_imu(const RosMessage& imu, std::int64_t& stamp_ns) {
  if (imu.type != kImuType) return fmt::format("imu is of the type {}, not {}", imu.type, kImuType);
  ImuMessage message;
  if (const Status status = parse_imu(WireFormat::kRos1, imu.bytes, message); !status.ok())
    return fmt::format("imu: {}", status.message());
  stamp_ns = message.stamp_ns;
  return state_->add_imu(message);
}

std::string RosOdometry::add_imu(const RosImu& imu) {
  ImuMessage message;
  message.stamp_ns = imu.stamp_ns;
  const auto &rate = imu.angular_velocity, &force = imu.linear_acceleration;
  if (imu.angular_velocity_variance != -1) message.rate = Vector3(rate[0], rate[1], rate[2]);
  if (imu.linear_acceleration_variance != -1) message.force = Vector3(force[0], force[1], force[2]);
  return state_->add_imu(message);
}

std::string RosOdometry::State::add_imu(const ImuMessage& message) {
  bool taken = true;
  if (message.rate) taken = imu.add_gyro({message.stamp_ns, *message.rate});
  if (message.force) taken = imu.add_acceleration({message.stamp_ns, *message.force}) && taken;
  return taken ? "" : "imu: a reading is not finite, or not later than the one before; it is left out";
}

// Prepares for images like these.
Status RosOdometry::State::init(const ImageMessage& colour, const ImageMessage& depth) {
  Calibration calibration = *first_camera;
  calibration.depth_units_per_metre =
      depth.encoding == "32FC1" ? kFloatDepthUnitsPerMetre : settings.depth_units_per_metre;
  calibration.depth_scale_given = true;
  calibration.camera.stamp_sigma_s = settings.stamp_sigma_s;
  colour_size = {colour.width, colour.height};
  depth_size = {depth.width, depth.height};
  depth_encoding = depth.encoding;
  fit = {};
  if (Status status = fit.init(calibration, colour_size, depth_size, 0); !status.ok()) return status;
  const CameraModel& camera = fit.calibration().camera;
  Limits limits;
  limits.width = camera.width;
  limits.height = camera.height;
  Config config;
  config.level_world = settings.level;
  memory.resize(required_bytes(limits));
  Status status = odometry.emplace().init(memory, camera, config, limits);
  if (!status.ok()) odometry.reset();
  if (!status.ok() || !early_pose) return status;
  const PoseWithCovariance early = *early_pose;
  early_pose.reset();
  return set_pose(early);
}

Status RosOdometry::State::set_pose(const PoseWithCovariance& base) {
  if (!started && settings.level) T_odom_world = {rotation_body_optical(), Vector3::Zero()};
  const Matrix6 exact = Matrix6::Zero();
  const Se3 T_world_odom = T_odom_world.inverse(), T_world_base = T_world_odom * base.T_odom_base;
  const Matrix6 C_world_base = compose_covariance(T_world_odom, exact, base.T_odom_base, base.covariance);
  const Status status = odometry->set_pose(
      T_world_base * T_base_camera, compose_covariance(T_world_base, C_world_base, T_base_camera, exact));
  if (!status.ok()) return status;
  level_is_due = false;
  twist.move_to(base.T_odom_base);
  return status;
}

Status RosOdometry::State::read(const RosMessage& message, ImageMessage& image) {
  if (!is_image_type(message.type))
    return {StatusCode::kInvalidArgument, fmt::format("a message of the type {}, not {} or {}", message.type,
                                                      kImageType, kCompressedImageType)};
  return conversion.parse(message.type, WireFormat::kRos1, message.bytes, image);
}

Status RosOdometry::State::read(const RosImage& message, ImageMessage& image) {
  image.stamp_ns = message.stamp_ns;
  image.encoding = message.encoding;
  image.big_endian = message.big_endian;
  image.step = message.step;
  image.data = {message.data, message.bytes};
  return set_size(message.width, message.height, image);
}

Status RosOdometry::State::make_frame(const ImageMessage& colour_image, const ImageMessage& depth_image,
                                      RgbdFrame& frame) {
  Status status;
  if (!is_colour_encoding(colour_image.encoding)) status = conversion.colour(colour_image, {});
  if (status.ok() && !is_depth_encoding(depth_image.encoding)) status = conversion.depth(depth_image, {});
  if (status.ok() && !odometry) status = init(colour_image, depth_image);
  if (!status.ok()) return status;
  if (colour_image.width != colour_size.width || colour_image.height != colour_size.height)
    return {StatusCode::kDamaged,
            fmt::format("a colour image is {}x{}, those before are {}x{}: reset takes the new ones",
                        colour_image.width, colour_image.height, colour_size.width, colour_size.height)};
  if (depth_image.width != depth_size.width || depth_image.height != depth_size.height ||
      depth_image.encoding != depth_encoding)
    return {StatusCode::kDamaged,
            fmt::format("a depth image is {}x{} {}, those before are {}x{} {}: reset takes the new ones",
                        depth_image.width, depth_image.height, depth_image.encoding, depth_size.width,
                        depth_size.height, depth_encoding)};
  frame.stamp_ns = colour_image.stamp_ns;
  frame.depth_stamp_ns = depth_image.stamp_ns;
  status = conversion.colour(colour_image, fit.colour());
  if (status.ok()) status = conversion.depth(depth_image, fit.depth());
  if (status.ok()) fit.fit(frame);
  return status;
}

template <typename Image>
RosEstimate RosOdometry::State::track(const Image& colour, const Image& depth) {
  RosEstimate estimate;
  estimate.state = "error";
  if (!first_camera) {
    estimate.reason = "no camera_info has come yet";
    return estimate;
  }
  ImageMessage colour_image, depth_image;
  if (const Status status = read(colour, colour_image); !status.ok()) {
    estimate.reason = fmt::format("colour: {}", status.message());
    return estimate;
  }
  if (const Status status = read(depth, depth_image); !status.ok()) {
    estimate.reason = fmt::format("depth: {}", status.message());
    return estimate;
  }
  RgbdFrame frame;
  if (const Status status = make_frame(colour_image, depth_image, frame); !status.ok()) {
    estimate.reason = status.message();
    return estimate;
  }
  report(settings.imu ? odometry->track(frame, imu) : odometry->track(frame), estimate);
  return estimate;
}

RosEstimate RosOdometry::track(const RosMessage& colour, const RosMessage& depth) {
  return state_->track(colour, depth);
}

RosEstimate RosOdometry::track(const RosImage& colour, const RosImage& depth) {
  return state_->track(colour, depth);
}

void RosOdometry::State::report(const TrackResult& result, RosEstimate& estimate) {
  estimate.stamp_ns = result.stamp_ns;
  estimate.state = to_string(result.state);
  estimate.reason = result.status.message();
  estimate.points = result.points.inliers;
  estimate.lines = result.lines.inliers;
  estimate.world = first_world + result.world;
  level_is_due = level_is_due || estimate.world != world;
  world = estimate.world;
  estimate.has_pose = has_pose(result);
  if (!estimate.has_pose) return;
  if (settings.level && level_is_due) T_odom_world = level_odom(result.T_world_camera, T_base_camera);
  level_is_due = false;
  started = true;
  const TrackResult base = result_of_base(result, T_base_camera, T_odom_world);
  estimate.pose = ros_pose(base.T_world_camera);
  estimate.pose_covariance = ros_covariance(base.pose_covariance);
  Twist measured;
  measured.covariance = kUnknownTwistVariance * Matrix6::Identity();
  measured = twist.of(base).value_or(measured);
  for (int i = 0; i < 6; ++i) estimate.twist[static_cast<std::size_t>(i)] = measured.velocity[i];
  estimate.twist_covariance = ros_covariance(measured.covariance);
}

void RosOdometry::reset() {
  State& state = *state_;
  state.first_camera = state.latest_camera;
  if (state.started) state.first_world = ++state.world;
  state.started = false;
  state.level_is_due = true;
  state.odometry.reset();  // the next images make one
  state.early_pose.reset();
  state.T_odom_world = state.T_base_camera;
  state.twist.forget();
  (void)state.start_imu();  // its config has been valid before
}

std::string RosOdometry::set_pose(const RosPose& T_odom_base, const RosCovariance& covariance) {
  State& state = *state_;
  State::PoseWithCovariance base;
  const Status status = pose_of(T_odom_base, base.T_odom_base);
  if (!status.ok()) return fmt::format("set_pose: {}", status.message());
  for (int i = 0; i < 36; ++i) base.covariance(i / 6, i % 6) = covariance[static_cast<std::size_t>(i)];
  if (state.odometry) return words(state.set_pose(base));
  state.early_pose = base;
  return "";
}

}  // namespace plvo

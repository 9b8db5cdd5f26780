// SPDX-License-Identifier: Apache-2.0
// The node for ROS 2, compiled against the headers that rosidl makes of ROS's messages and against stand-ins
// for rclcpp, message_filters and tf2, publishes where the robot's base is.
#include <gtest/gtest.h>

#include <cmath>

#include "plvo/math/se3.hpp"
#include "procedural_sequence.hpp"
#define main node_main
#include "plvo/ros2/node.cpp"
#undef main

namespace plvo {
namespace {

using diagnostic_msgs::msg::DiagnosticStatus;

constexpr int kFrames = 8;
constexpr const char* kAhead = "0.2 -0.1 0.5 -0.5 0.5 -0.5 0.5";  // the camera looks ahead

Se3 T_base_camera() {
  Se3 T;
  T.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T.t = {0.2, -0.1, 0.5};
  return T;
}

std_msgs::msg::Header header(std::int64_t ns, const char* frame = "camera_color_optical_frame") {
  std_msgs::msg::Header made;
  made.stamp = rclcpp::Time(ns);
  made.frame_id = frame;
  return made;
}

template <typename Message>
void send(const char* topic, const Message& message) {
  rclcpp::wires.subscriptions.at(topic)(std::make_shared<const Message>(message));
}

template <typename Message>
std::vector<Message> published(const char* topic) {
  std::vector<Message> messages;
  for (const std::any& message : rclcpp::wires.published[topic])
    messages.push_back(std::any_cast<const Message&>(message));
  return messages;
}

Se3 pose_of(const Odometry& odometry) {
  const auto& p = odometry.pose.pose.position;
  const auto& q = odometry.pose.pose.orientation;
  return {to_rotation({q.x, q.y, q.z, q.w}), {p.x, p.y, p.z}};
}

Matrix6 matrix(const std::array<double, 36>& covariance) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance.data());
}

void expect_near(const Se3& a, const Se3& b, double metres, double radians, int frame) {
  EXPECT_LT((a.t - b.t).norm(), metres) << "frame " << frame;
  EXPECT_LT(rotation_log(a.R.transpose() * b.R).norm(), radians) << "frame " << frame;
}

struct Ros2Node : testing::Test {
  void SetUp() override {
    rclcpp::wires = {};
    rclcpp::wires.parameters["base_camera"] = std::string(kAhead);
  }

  // Runs the node's main, which gets what `messages` sends while it spins.
  template <typename Messages>
  int run(Messages messages) {
    rclcpp::while_spinning = messages;
    const int code = node_main(0, nullptr);
    rclcpp::while_spinning = nullptr;
    return code;
  }

  void send_info(double scale = 1) {
    const CameraModel& camera = sequence.camera();
    CameraInfo info;
    info.width = static_cast<std::uint32_t>(camera.width);
    info.height = static_cast<std::uint32_t>(camera.height);
    info.k = {scale * camera.pinhole.fx,
              0,
              camera.pinhole.cx,
              0,
              scale * camera.pinhole.fy,
              camera.pinhole.cy,
              0,
              0,
              1};
    const Distortion& lens = camera.distortion;
    info.d = {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
    info.distortion_model = model;
    send("camera_info", info);
  }

  Image image(std::int64_t ns, const char* encoding, const void* data, int pixel_bytes) const {
    const CameraModel& camera = sequence.camera();
    Image made;
    made.header = header(ns);
    made.encoding = encoding;
    made.width = static_cast<std::uint32_t>(camera.width);
    made.height = static_cast<std::uint32_t>(camera.height);
    made.step = made.width * static_cast<std::uint32_t>(pixel_bytes);
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    made.data.assign(bytes, bytes + std::size_t{made.step} * made.height);
    return made;
  }

  void send_frame(int i, bool dark = false, bool metres = false) {
    const RgbdFrame frame = dark ? sequence.render_dark(i) : sequence.render(i);
    ASSERT_EQ(frame.depth.metres_per_unit, 0.001);
    send("colour", image(frame.stamp_ns, "rgb8", frame.colour.data, 3));
    if (!metres) {
      send("depth", image(frame.stamp_ns, "16UC1", frame.depth.data, 2));
      return;
    }
    std::vector<float> depth;
    const std::size_t pixels = std::size_t{320} * 240;
    for (std::size_t k = 0; k < pixels; ++k)
      depth.push_back(frame.depth.data[k] == 0 ? NAN : 0.001F * static_cast<float>(frame.depth.data[k]));
    send("depth", image(frame.stamp_ns, "32FC1", depth.data(), 4));
  }

  // The readings of an ideal gyro up to frame i and a little later, in axes that are the camera's.
  void send_gyro_around(int i) {
    const std::int64_t from = ProceduralSequence::stamp_ns(i), to = ProceduralSequence::stamp_ns(i + 1);
    const Matrix3 turn =
        ProceduralSequence::T_world_camera(i).R.transpose() * ProceduralSequence::T_world_camera(i + 1).R;
    const Vector3 rate = rotation_log(turn) / (1e-9 * static_cast<double>(to - from));
    constexpr int kReadings = 8;
    for (int k = 0; k < kReadings; ++k) {
      Imu imu;
      imu.header = header(from + (to - from) * (2 * k + 1) / (2 * kReadings), "imu");
      imu.angular_velocity.set__x(rate.x()).set__y(rate.y()).set__z(rate.z());
      imu.linear_acceleration_covariance[0] = -1;  // it has no accelerometer
      send("imu", imu);
    }
  }

  DiagnosticStatus diagnosis() const {
    for (const auto& timer : rclcpp::wires.timers) timer();
    const auto arrays = published<DiagnosticArray>("/diagnostics");
    EXPECT_FALSE(arrays.empty());
    return arrays.empty() ? DiagnosticStatus() : arrays.back().status.at(0);
  }

  ProceduralSequence sequence{320, 240};
  std::string model = "plumb_bob";
};

TEST_F(Ros2Node, PublishesTheBaseInOdom) {
  EXPECT_EQ(run([this] {
              send_info();
              for (int i = 0; i < kFrames; ++i) send_frame(i);
              const DiagnosticStatus status = diagnosis();
              EXPECT_EQ(status.level, DiagnosticStatus::OK);
              EXPECT_EQ(status.name, "plvo: odometry");
              EXPECT_EQ(status.message, "tracking");
              EXPECT_EQ(status.hardware_id, "camera_color_optical_frame");
            }),
            0);
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), static_cast<std::size_t>(kFrames));
  ASSERT_EQ(rclcpp::wires.sent_transforms.size(), odometries.size());
  const Se3 T_world_first = ProceduralSequence::T_world_camera(0);
  for (int i = 0; i < kFrames; ++i) {
    const auto& message = odometries[static_cast<std::size_t>(i)];
    EXPECT_EQ(message.header.frame_id, "odom");
    EXPECT_EQ(message.child_frame_id, "base_link");
    EXPECT_EQ(stamp_ns(message.header), ProceduralSequence::stamp_ns(i));
    const Se3 truth = T_base_camera() * (T_world_first.inverse() * ProceduralSequence::T_world_camera(i)) *
                      T_base_camera().inverse();
    expect_near(pose_of(message), truth, 0.01, 0.01, i);

    const TransformStamped& transform = rclcpp::wires.sent_transforms[static_cast<std::size_t>(i)];
    EXPECT_EQ(transform.header, message.header);
    EXPECT_EQ(transform.child_frame_id, "base_link");
    EXPECT_EQ(transform.transform.translation.x, message.pose.pose.position.x);
    EXPECT_EQ(transform.transform.rotation, message.pose.pose.orientation);
  }
  EXPECT_GT(std::abs(odometries.back().pose.pose.position.x), 0.03) << "the camera moves";
  const Matrix6 covariance = matrix(odometries.back().pose.covariance);
  EXPECT_GT(covariance.diagonal().minCoeff(), 0);
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-12);
}

TEST_F(Ros2Node, TheTwistIsTheVelocityInTheAxesOfTheBase) {
  run([this] {
    send_info();
    for (int i = 0; i < kFrames; ++i) send_frame(i);
  });
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(matrix(odometries[0].twist.covariance), 1e6 * Matrix6::Identity()) << "of the first frame";
  for (std::size_t i = 1; i < odometries.size(); ++i) {
    const double seconds =
        1e-9 * static_cast<double>(stamp_ns(odometries[i].header) - stamp_ns(odometries[i - 1].header));
    const Se3 T_now_before = pose_of(odometries[i]).inverse() * pose_of(odometries[i - 1]);
    const auto &linear = odometries[i].twist.twist.linear, &angular = odometries[i].twist.twist.angular;
    const Vector3 moved = -T_now_before.t / seconds, turned = -rotation_log(T_now_before.R) / seconds;
    EXPECT_LT((Vector3(linear.x, linear.y, linear.z) - moved).norm(), 1e-3);
    EXPECT_LT((Vector3(angular.x, angular.y, angular.z) - turned).norm(), 1e-3);
    EXPECT_GT(matrix(odometries[i].twist.covariance).diagonal().minCoeff(), 0);
  }
}

TEST_F(Ros2Node, MetresGiveThePosesOfMillimetres) {
  std::vector<Odometry> of_millimetres;
  for (const bool metres : {false, true}) {
    run([this, metres] {
      send_info();
      for (int i = 0; i < kFrames; ++i) send_frame(i, false, metres);
    });
    if (!metres) of_millimetres = published<Odometry>("odom");
    if (!metres) rclcpp::wires.published.clear();
  }
  const auto of_metres = published<Odometry>("odom");
  ASSERT_EQ(of_metres.size(), static_cast<std::size_t>(kFrames));
  for (std::size_t i = 0; i < of_metres.size(); ++i)
    expect_near(pose_of(of_metres[i]), pose_of(of_millimetres[i]), 1e-6, 1e-6, static_cast<int>(i));
}

std::string value_of(const DiagnosticStatus& status, const std::string& key) {
  for (const auto& pair : status.values)
    if (pair.key == key) return pair.value;
  return "no value " + key;
}

TEST_F(Ros2Node, PublishesNothingWhileLostAndSaysWhy) {
  run([this] {
    send_info();
    for (int i = 0; i < kFrames; ++i) {
      send_frame(i, i == 4);
      if (i != 4) continue;
      const DiagnosticStatus status = diagnosis();
      EXPECT_EQ(status.level, DiagnosticStatus::WARN);
      EXPECT_EQ(status.message.find("lost: hardly anything to see"), 0U) << status.message;
      EXPECT_EQ(value_of(status, "state"), "lost");
      EXPECT_EQ(value_of(status, "world"), "0");
      EXPECT_EQ(value_of(status, "frames without a pose"), "1");
    }
  });
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), static_cast<std::size_t>(kFrames - 1));
  EXPECT_EQ(rclcpp::wires.sent_transforms.size(), odometries.size());
  for (const Odometry& odometry : odometries)
    EXPECT_NE(stamp_ns(odometry.header), ProceduralSequence::stamp_ns(4));
}

TEST_F(Ros2Node, AGyroKeepsTheAngleWhileThereIsNothingToSee) {
  rclcpp::wires.parameters["imu"] = true;
  rclcpp::wires.parameters["camera_imu"] = std::string("0 0 0 1");
  rclcpp::wires.parameters["imu_wait_s"] = 60.0;
  run([this] {
    EXPECT_EQ(rclcpp::wires.depths.at("imu"), 1000U);
    send_info();
    send_gyro_around(-1);
    for (int i = 0; i < kFrames; ++i) {
      send_frame(i, i >= 4);
      EXPECT_EQ(published<Odometry>("odom").size(), static_cast<std::size_t>(i)) << "it waits for the gyro";
      send_gyro_around(i);
      EXPECT_EQ(published<Odometry>("odom").size(), static_cast<std::size_t>(i) + 1);
    }
    EXPECT_EQ(diagnosis().level, DiagnosticStatus::WARN);
    EXPECT_EQ(diagnosis().values.at(0).value, "predicted");
  });
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), static_cast<std::size_t>(kFrames));
  const Se3 truth =
      T_base_camera() *
      (ProceduralSequence::T_world_camera(0).inverse() * ProceduralSequence::T_world_camera(kFrames - 1)) *
      T_base_camera().inverse();
  EXPECT_LT(rotation_log(pose_of(odometries.back()).R.transpose() * truth.R).norm(), 0.01);
}

TEST_F(Ros2Node, ResetStartsAnew) {
  run([this] {
    send_info();
    for (int i = 0; i < 3; ++i) send_frame(i);
    const auto response = std::make_shared<Trigger::Response>();
    rclcpp::wires.services.at("~/reset")(response);
    EXPECT_TRUE(response->success);
    EXPECT_EQ(response->message, "the next frame is the first one");
    for (int i = 0; i < 3; ++i) send_frame(i);  // of the same stamps
  });
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), 6U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(odometries[i], odometries[i + 3]);
}

TEST_F(Ros2Node, SetPoseMovesTheBase) {
  const Se3 wanted{rotation_exp(Vector3(0, 0, 1)), Vector3(3, -2, 0.1)};
  run([this, &wanted] {
    send_info();
    send_frame(0);
    send_frame(1);
    PoseWithCovarianceStamped message;
    message.header = header(ProceduralSequence::stamp_ns(1), "map");
    message.pose.pose.position.set__x(3).set__y(-2).set__z(0.1);
    const Quaternion q = to_quaternion(wanted.R);
    message.pose.pose.orientation.set__x(q.x).set__y(q.y).set__z(q.z).set__w(q.w);
    for (std::size_t i = 0; i < 6; ++i) message.pose.covariance[7 * i] = 0.01;
    send("~/set_pose", message);
    EXPECT_EQ(rclcpp::wires.logged.back(), "set_pose: the pose is in map, not in odom");
    message.header.frame_id = "odom";
    send("~/set_pose", message);
    EXPECT_EQ(diagnosis().values.back().value, "1");
    send_frame(2);
  });
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), 3U);
  const Se3 T_first_second =
      T_base_camera() *
      (ProceduralSequence::T_world_camera(1).inverse() * ProceduralSequence::T_world_camera(2)) *
      T_base_camera().inverse();
  expect_near(pose_of(odometries[2]), wanted * T_first_second, 0.01, 0.01, 2);
  EXPECT_GT(odometries[2].pose.covariance[0], 0.01);
  EXPECT_LT(std::abs(odometries[2].twist.twist.linear.x), 1) << "the jump is not a velocity";
}

TEST_F(Ros2Node, TakesThePlaceOfTheCameraFromTf) {
  rclcpp::wires.parameters.erase("base_camera");
  rclcpp::wires.parameters["publish_tf"] = false;
  run([this] {
    send_info();
    send_frame(0);
    EXPECT_EQ(diagnosis().message,
              "waiting: images wait for a transform from camera_color_optical_frame to base_link: publish "
              "it, or set "
              "the parameter base_camera");
    EXPECT_TRUE(published<Odometry>("odom").empty());
    TransformStamped place;
    place.transform.translation.set__x(0.2).set__y(-0.1).set__z(0.5);
    place.transform.rotation.set__x(-0.5).set__y(0.5).set__z(-0.5).set__w(0.5);
    rclcpp::wires.transforms[{"base_link", "camera_color_optical_frame"}] = place;
    for (int i = 1; i < kFrames; ++i) send_frame(i);
  });
  const auto odometries = published<Odometry>("odom");
  ASSERT_EQ(odometries.size(), static_cast<std::size_t>(kFrames));
  EXPECT_NEAR(odometries[0].pose.pose.position.x, 0, 1e-9) << "odom is the base at the first frame";
  EXPECT_TRUE(rclcpp::wires.sent_transforms.empty()) << "tf is switched off";
}

TEST_F(Ros2Node, PairsOnlyEqualStampsWhenItIsTold) {
  rclcpp::wires.parameters["exact_sync"] = true;
  run([this] {
    send_info();
    const RgbdFrame frame = sequence.render(0);
    send("colour", image(frame.stamp_ns, "rgb8", frame.colour.data, 3));
    send("depth", image(frame.stamp_ns + 1, "16UC1", frame.depth.data, 2));
    EXPECT_TRUE(published<Odometry>("odom").empty());
    send("depth", image(frame.stamp_ns, "16UC1", frame.depth.data, 2));
  });
  EXPECT_EQ(published<Odometry>("odom").size(), 1U);
}

TEST_F(Ros2Node, NamesWhatCannotBeTracked) {
  run([this] {
    EXPECT_TRUE(rclcpp::wires.best_effort.at("colour") && rclcpp::wires.best_effort.at("depth"));
    model = "omnidirectional";
    send_info();
    EXPECT_NE(diagnosis().message.find("'omnidirectional' is not supported"), std::string::npos);
    model = "plumb_bob";
    send_info();
    const RgbdFrame frame = sequence.render(0);
    send("colour", image(frame.stamp_ns, "rgb8", frame.colour.data, 3));
    send("depth", image(frame.stamp_ns, "rgb8", frame.colour.data, 3));
    EXPECT_NE(diagnosis().message.find("error: the encoding 'rgb8' is not read there"), std::string::npos);
    EXPECT_EQ(diagnosis().level, DiagnosticStatus::ERROR);
    Image cut = image(frame.stamp_ns, "16UC1", frame.depth.data, 2);
    cut.data.pop_back();
    send("colour", image(frame.stamp_ns, "rgb8", frame.colour.data, 3));
    send("depth", cut);
    EXPECT_NE(diagnosis().message.find("depth: an image of 320x240 has 153599 bytes"), std::string::npos)
        << diagnosis().message;
    send_frame(1);
    send_info(2);
    EXPECT_EQ(rclcpp::wires.logged.back().find("camera_info has changed"), 0U) << rclcpp::wires.logged.back();
    send_frame(2);
  });
  EXPECT_EQ(published<Odometry>("odom").size(), 2U);
}

TEST_F(Ros2Node, AWrongParameterEndsIt) {
  struct {
    const char* name;
    std::any value;
    const char* words;
  } const cases[] = {
      {"base_camera", std::string("0 0 0"), "plvo: base_camera must be seven numbers: tx ty tz qx qy qz qw"},
      {"base_camera", std::string("0 0 0 0 0 0 2"),
       "base_camera: the quaternion x y z w must have the length 1, not 2"},
      {"camera_imu", std::string("1"), "camera_imu must be four numbers: qx qy qz qw"},
      {"level", true, "level is by the accelerometer of imu: set that, too"},
      {"max_interval_s", -1.0, "max_interval_s must not be negative"},
      {"imu", std::int64_t{1}, "parameter 'imu' has invalid type"},
  };
  for (const auto& one : cases) {
    SetUp();
    rclcpp::wires.parameters[one.name] = one.value;
    testing::internal::CaptureStderr();
    EXPECT_EQ(run([] { ADD_FAILURE() << "it spins"; }), 2);
    EXPECT_NE(testing::internal::GetCapturedStderr().find(one.words), std::string::npos) << one.words;
  }
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// The node of docs/user/robots.md, compiled against stand-ins for ROS 2, publishes where the robot's base is.
#include <gtest/gtest.h>

#include <cmath>

#include "procedural_sequence.hpp"
#define main node_main
#include "plvo_node.cpp"  // made of the page
#undef main

namespace plvo {
namespace {

constexpr int kFrames = 8;

builtin_interfaces::msg::Time time_of(std::int64_t stamp_ns) {
  return {static_cast<std::int32_t>(stamp_ns / 1'000'000'000),
          static_cast<std::uint32_t>(stamp_ns % 1'000'000'000)};
}

Image::ConstSharedPtr image(std::int64_t stamp_ns, const char* encoding, const void* data, int width,
                            int height, int pixel_bytes) {
  auto made = std::make_shared<Image>();
  made->header.stamp = time_of(stamp_ns);
  made->encoding = encoding;
  made->width = static_cast<std::uint32_t>(width);
  made->height = static_cast<std::uint32_t>(height);
  made->step = static_cast<std::uint32_t>(width * pixel_bytes);
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  made->data.assign(bytes,
                    bytes + static_cast<std::size_t>(width) * static_cast<std::size_t>(height * pixel_bytes));
  return made;
}

struct RosNode : testing::Test {
  void SetUp() override { rclcpp::wires = {}; }

  // Runs the node's main, which gets the camera and the frames while it spins.
  void run(const char* depth_encoding = "16UC1") {
    rclcpp::while_spinning = [this, depth_encoding] {
      const CameraModel& camera = sequence.camera();
      CameraInfo info;
      info.width = static_cast<std::uint32_t>(camera.width);
      info.height = static_cast<std::uint32_t>(camera.height);
      info.k = {camera.pinhole.fx, 0, camera.pinhole.cx, 0, camera.pinhole.fy, camera.pinhole.cy, 0, 0, 1};
      const Distortion& lens = camera.distortion;
      info.d = {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
      if (!coefficients.empty()) info.d = coefficients;
      info.distortion_model = model;
      rclcpp::wires.camera_info(info);
      for (int i = 0; i < kFrames; ++i) {
        const RgbdFrame frame = i == dark ? sequence.render_dark(i) : sequence.render(i);
        ASSERT_EQ(frame.depth.metres_per_unit, 0.001);
        rclcpp::wires.both_images(
            image(frame.stamp_ns, "rgb8", frame.colour.data, camera.width, camera.height, 3),
            image(frame.stamp_ns, depth_encoding, frame.depth.data, camera.width, camera.height, 2));
      }
    };
    EXPECT_EQ(node_main(0, nullptr), 0);
  }

  ProceduralSequence sequence{320, 240};
  int dark = -1;
  std::string model = "plumb_bob";
  std::vector<double> coefficients;  // none: the sequence's
};

TEST_F(RosNode, PublishesTheBaseInOdom) {
  rclcpp::wires.parameters["base_camera_xyz"] = {0.2, -0.1, 0.5};
  rclcpp::wires.parameters["base_camera_rpy"] = {0, 0.3, 0.1};  // looks down and to the left
  run();
  const auto& published = rclcpp::wires.published;
  ASSERT_EQ(published.size(), static_cast<std::size_t>(kFrames));

  // The base's axes in the camera's: written out by hand, not by the formula of the page.
  const double down = 0.3, left = 0.1;
  const Vector3 ahead(std::cos(left) * std::cos(down), std::sin(left) * std::cos(down), -std::sin(down));
  Se3 T_base_camera;
  T_base_camera.R.col(2) = ahead;
  T_base_camera.R.col(0) = Vector3(std::sin(left), -std::cos(left), 0);
  T_base_camera.R.col(1) = skew(ahead) * T_base_camera.R.col(0);
  T_base_camera.t = {0.2, -0.1, 0.5};
  const Se3 T_world_first = ProceduralSequence::T_world_camera(0);
  for (int i = 0; i < kFrames; ++i) {
    const auto& message = published[static_cast<std::size_t>(i)];
    EXPECT_EQ(message.header.frame_id, "odom");
    EXPECT_EQ(message.child_frame_id, "base_link");
    EXPECT_EQ(rclcpp::Time(message.header.stamp).nanoseconds(), ProceduralSequence::stamp_ns(i));
    const Se3 truth = T_base_camera * (T_world_first.inverse() * ProceduralSequence::T_world_camera(i)) *
                      T_base_camera.inverse();
    const auto& position = message.pose.pose.position;
    EXPECT_LT((Vector3(position.x, position.y, position.z) - truth.t).norm(), 0.01) << "frame " << i;
    const auto& q = message.pose.pose.orientation;
    EXPECT_LT(rotation_log(to_rotation({q.x, q.y, q.z, q.w}).transpose() * truth.R).norm(), 0.01)
        << "frame " << i;
  }
  EXPECT_GT(std::abs(published.back().pose.pose.position.x), 0.03) << "the walk goes somewhere";

  // A covariance: symmetric, and no direction of a moved base is exact.
  const auto& covariance = published.back().pose.covariance;
  for (int i = 0; i < 6; ++i) {
    EXPECT_GT(covariance[static_cast<std::size_t>(7 * i)], 0);
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(covariance[static_cast<std::size_t>(6 * i + j)],
                  covariance[static_cast<std::size_t>(6 * j + i)], 1e-12);
  }
  EXPECT_TRUE(rclcpp::wires.logged.empty());
}

TEST_F(RosNode, TakesTheLensByItsName) {
  model = "rational_polynomial";
  coefficients = {0.05, -0.12, 0.0008, -0.0005, 0.06, 0, 0, 0};  // the sequence's, which is plumb_bob
  run();
  EXPECT_EQ(rclcpp::wires.published.size(), static_cast<std::size_t>(kFrames));
  EXPECT_TRUE(rclcpp::wires.logged.empty());
}

TEST_F(RosNode, SaysWhichLensItDoesNotKnow) {
  model = "omnidirectional";
  run();
  EXPECT_TRUE(rclcpp::wires.published.empty());
  ASSERT_FALSE(rclcpp::wires.logged.empty());
  EXPECT_NE(rclcpp::wires.logged.front().find("'omnidirectional' is not supported"), std::string::npos)
      << rclcpp::wires.logged.front();
}

TEST_F(RosNode, PublishesNothingWhileLost) {
  dark = 4;
  run();
  EXPECT_EQ(rclcpp::wires.published.size(), static_cast<std::size_t>(kFrames - 1));
  ASSERT_EQ(rclcpp::wires.logged.size(), 1U);
  EXPECT_NE(rclcpp::wires.logged[0].find("lost"), std::string::npos) << rclcpp::wires.logged[0];
}

TEST_F(RosNode, SaysWhatDepthItWants) {
  run("32FC1");
  EXPECT_TRUE(rclcpp::wires.published.empty());
  EXPECT_NE(rclcpp::wires.logged.at(0).find("16UC1"), std::string::npos);
}

}  // namespace
}  // namespace plvo

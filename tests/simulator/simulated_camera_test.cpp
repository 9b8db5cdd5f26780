// SPDX-License-Identifier: Apache-2.0
// What the simulated camera promises as an RgbdCamera: bytes that depend on the seed alone, stamps, the
// closed trajectory, and plain words for options that cannot be.
#include <cstring>
#include <limits>

#include "simulator_support.hpp"

namespace plvo {
namespace {

using test::shoot;
using test::Shot;
using test::small_options;

TEST(SimulatedCamera, SameSeedSameBytesWhateverTheThreads) {
  for (const LightName light : {LightName::kConstant, LightName::kVarying}) {
    SimulatorOptions options = small_options(SceneName::kDesk, light);
    options.threads = 1;
    const std::vector<Shot> one = shoot(options);
    options.threads = 3;
    const std::vector<Shot> three = shoot(options);
    ASSERT_EQ(one.size(), three.size());
    for (std::size_t k = 0; k < one.size(); ++k) {
      EXPECT_EQ(one[k].colour, three[k].colour);
      EXPECT_EQ(one[k].depth, three[k].depth);
      EXPECT_EQ(one[k].exact, three[k].exact);
    }
  }
}

TEST(SimulatedCamera, AnotherSeedGivesAnotherRoomAndTrajectory) {
  SimulatorOptions options = small_options(SceneName::kBare);
  const std::vector<Shot> a = shoot(options);
  options.seed = 2;
  const std::vector<Shot> b = shoot(options);
  EXPECT_NE(a[0].colour, b[0].colour);
  EXPECT_GT((a[1].T_world_camera.t - b[1].T_world_camera.t).norm(), 1e-4);
}

// What is printed, grown and worn differs, and nothing else.
TEST(SimulatedCamera, AnotherStoreyIsTheSameRoomWithOtherTextures) {
  for (const SceneName scene : {SceneName::kCorridor, SceneName::kDesk, SceneName::kHall}) {
    SimulatorOptions options = test::small_options(scene);
    options.noise = false;
    const std::vector<test::Shot> ground = test::shoot(options);
    options.storey = 1;
    const std::vector<test::Shot> upper = test::shoot(options);
    ASSERT_EQ(ground.size(), upper.size());
    EXPECT_EQ(ground[3].T_world_camera.t, upper[3].T_world_camera.t);
    EXPECT_EQ(ground[3].exact, upper[3].exact);
    EXPECT_NE(ground[3].colour, upper[3].colour);
    double difference = 0;
    for (std::size_t i = 0; i < ground[3].exact.size(); ++i)
      difference +=
          std::abs(ground[3].gray(i) - upper[3].gray(i)) / static_cast<double>(ground[3].exact.size());
    EXPECT_GT(difference, 0.5) << to_string(scene);
    EXPECT_LT(difference, 20) << to_string(scene);
  }
}

TEST(SimulatedCamera, StampsIncreaseAndTheStreamEnds) {
  SimulatorOptions options = small_options(SceneName::kBare);
  options.fps = 29.97;
  options.frames = 5;
  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());
  EXPECT_EQ(camera->frames(), 5);
  RgbdFrame frame;
  std::int64_t last = 0;
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(camera->next(frame).ok());
    EXPECT_GT(frame.stamp_ns, last);
    EXPECT_EQ(frame.stamp_ns, camera->stamp_ns(k));
    EXPECT_EQ(frame.stamp_ns % 1000, 0);
    EXPECT_EQ(frame.depth_stamp_ns, frame.stamp_ns);
    EXPECT_NEAR(static_cast<double>(frame.stamp_ns - camera->stamp_ns(0)) * 1e-9, k / 29.97, 1e-6);
    last = frame.stamp_ns;
  }
  EXPECT_EQ(camera->next(frame).code(), StatusCode::kEndOfStream);
  EXPECT_EQ(camera->next(frame).code(), StatusCode::kEndOfStream);
}

TEST(SimulatedCamera, TheTrajectoryIsClosedAndMovesLikeAHand) {
  for (const int frames : {2, 90, 1200}) {
    SimulatorOptions options = small_options(SceneName::kBare);
    options.frames = frames;
    std::unique_ptr<SimulatedCamera> camera;
    ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());
    const Se3 first = camera->pose(0);
    const Se3 last = camera->pose(frames - 1);
    EXPECT_EQ(first.t, last.t);
    EXPECT_EQ(first.R, last.R);
    double path_m = 0;
    double farthest_m = 0;
    double widest_rad = 0;
    for (int k = 1; k < frames; ++k) {
      const Vector6 step = boxminus(camera->pose(k), camera->pose(k - 1));
      path_m += step.head<3>().norm();
      widest_rad = std::max(widest_rad, step.tail<3>().norm());
      farthest_m = std::max(farthest_m, step.head<3>().norm());
      // The trajectory is continuous, also at its end.
      const Vector6 half =
          boxminus(camera->ground_truth(camera->stamp_ns(k) - 16'666'000), camera->pose(k - 1));
      EXPECT_LT(half.head<3>().norm(), 0.04);
    }
    EXPECT_LT(farthest_m, 0.06) << frames;  // 1.8 m/s
    EXPECT_LT(widest_rad, 0.06) << frames;  // 100 °/s
    if (frames > 2) {
      EXPECT_GT(path_m / (frames / 30.0), 0.15);  // the camera moves on
    }
  }
}

TEST(SimulatedCamera, RefusesInvalidOptions) {
  std::unique_ptr<SimulatedCamera> camera;
  const auto code = [&](auto change) {
    SimulatorOptions options = small_options(SceneName::kBare);
    change(options);
    const Status status = SimulatedCamera::create(options, camera);
    EXPECT_TRUE(status.ok() || std::strlen(status.message()) > 10U);
    return status.code();
  };
  EXPECT_EQ(code([](SimulatorOptions&) {}), StatusCode::kOk);
  EXPECT_EQ(code([](SimulatorOptions& o) { o.frames = 0; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](SimulatorOptions& o) { o.fps = 0; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](SimulatorOptions& o) { o.threads = 0; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](SimulatorOptions& o) { o.camera.pinhole.fx = std::numeric_limits<double>::quiet_NaN(); }),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](SimulatorOptions& o) { o.depth.max_range_m = 0.1; }), StatusCode::kInvalidArgument);
  EXPECT_EQ(code([](SimulatorOptions& o) { o.trajectory_file = "no/such/file.txt"; }), StatusCode::kNotFound);
  SceneName scene{};
  EXPECT_EQ(parse_scene("desk", scene).code(), StatusCode::kOk);
  EXPECT_EQ(scene, SceneName::kDesk);
  const Status unknown = parse_scene("moon", scene);
  EXPECT_EQ(unknown.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(std::strstr(unknown.message(), "corridor"), nullptr);
  LightName light{};
  EXPECT_EQ(parse_light("varying", light).code(), StatusCode::kOk);
  EXPECT_EQ(light, LightName::kVarying);
  EXPECT_EQ(parse_light("dark", light).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace plvo

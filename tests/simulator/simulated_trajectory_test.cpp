// SPDX-License-Identifier: Apache-2.0
// A recorded trajectory as the driver: its rotations and the shape of its path survive, it stays inside the
// room's free space, and files that are no trajectories are refused in plain words.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "plvo/math/trigonometry.hpp"
#include "plvo/simulator/motion/trajectory.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

using sim::Trajectory;

class RecordedTrajectory : public testing::Test {
 protected:
  void SetUp() override {
    path_ =
        (std::filesystem::temp_directory_path() / ("plvo_trajectory_" + std::to_string(std::rand()) + ".txt"))
            .string();
    scene_ = sim::build_scene(SceneName::kBare, 1);
  }
  void TearDown() override { std::filesystem::remove(path_); }

  // A hand that circles with radius 1.5 m and swings, looking about horizontally: T(t) of the recording.
  static Se3 truth(double t) {
    Matrix3 R_world_optical;  // z forward = world x, x right = world −y
    R_world_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return {rotation_exp(Vector3(0, 0, 2.0 + 0.3 * sin(1.1 * t))) * R_world_optical *
                rotation_exp(Vector3(0.1 * sin(2.3 * t), 0, 0.05 * sin(1.7 * t))),
            Vector3(4 + 1.5 * cos(0.8 * t), -2 + 1.5 * sin(0.8 * t), 1.3 + 0.1 * sin(t))};
  }
  void record(double gap_begin, double gap_end) const {
    std::ofstream file(path_);
    file << "# a comment\n";
    for (int i = 0; i < 800; ++i) {
      const double t = i * 0.01;
      if (t > gap_begin && t < gap_end) continue;
      const Se3 T = truth(t);
      const Quaternion q = to_quaternion(T.R);
      char line[200];
      // Tenths of a millimetre, as motion capture gives them.
      std::snprintf(line, sizeof line, "%.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f\n", 1305031098.6659 + t,
                    T.t.x(), T.t.y(), T.t.z(), q.x, q.y, q.z, q.w);
      file << line;
    }
  }
  Status load(Trajectory& trajectory) const { return Trajectory::from_tum(path_, *scene_, trajectory); }
  void write(const char* text) const { std::ofstream(path_) << text; }

  std::string path_;
  std::unique_ptr<sim::Scene> scene_;
};

TEST_F(RecordedTrajectory, MovesAsRecordedInsideTheRoom) {
  record(3.0, 3.2);
  Trajectory trajectory;
  const Status status = load(trajectory);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_NEAR(trajectory.duration_s(), 7.99, 0.011);
  EXPECT_LE(trajectory.scale(), 1.0);
  EXPECT_GT(trajectory.scale(), 0.5);
  for (double t = 0.1; t < 7.8; t += 0.033) {
    const Se3 T = trajectory.at(t);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(T.t(axis), static_cast<double>(scene_->free_lo[axis]) - 0.01);
      EXPECT_LT(T.t(axis), static_cast<double>(scene_->free_hi[axis]) + 0.01);
    }
    // The motion over a third of a second, in the camera's own axes, is the recorded one, scaled.
    const double later = t + 0.3;
    if (later > 2.9 && t < 3.3) continue;  // the gap is bridged, not known
    if (later > 7.8) break;
    const Se3 moved = T.inverse() * trajectory.at(later);
    const Se3 expected = truth(t).inverse() * truth(later);
    EXPECT_LT(rotation_log(moved.R.transpose() * expected.R).norm(), 1.5e-3) << t;
    EXPECT_LT((moved.t - trajectory.scale() * expected.t).norm(), 2e-3) << t;
  }
  // Smooth: no steps of the 0.1 mm grid are left in the second difference (real acceleration: < 1.5 m/s²).
  for (double t = 0.2; t < 2.8; t += 0.01) {
    const Vector3 second = trajectory.at(t + 0.01).t - 2 * trajectory.at(t).t + trajectory.at(t - 0.01).t;
    EXPECT_LT(second.norm(), 3 * 1.5e-4) << t;
  }
  // It begins with the heading of the generated trajectory.
  const Vector3 forward = trajectory.at(0).R.col(2);
  EXPECT_NEAR(plvo::atan2(forward.y(), forward.x()), static_cast<double>(scene_->stroll.front().yaw), 1e-6);
}

TEST_F(RecordedTrajectory, DrivesACameraUntilItsEnd) {
  record(100, 101);
  SimulatorOptions options = test::small_options(SceneName::kBare);
  options.trajectory_file = path_;
  options.frames = 100000;
  std::unique_ptr<SimulatedCamera> camera;
  ASSERT_TRUE(SimulatedCamera::create(options, camera).ok());
  EXPECT_EQ(camera->frames(), 240);  // 7.99 s at 30 Hz, and the first
  RgbdFrame frame;
  EXPECT_TRUE(camera->next(frame).ok());
}

TEST_F(RecordedTrajectory, RefusesInvalidTrajectories) {
  Trajectory trajectory;
  EXPECT_EQ(load(trajectory).code(), StatusCode::kNotFound);
  write("# nothing\n");
  EXPECT_EQ(load(trajectory).code(), StatusCode::kInvalidArgument);
  write("1 0 0 0 0 0 0 1\n2 0 0 zero 0 0 0 1\n");
  const Status status = load(trajectory);
  EXPECT_EQ(status.code(), StatusCode::kDamaged);
  EXPECT_NE(std::strstr(status.message(), "line 2"), nullptr) << status.message();
  write("1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n");
  EXPECT_EQ(load(trajectory).code(), StatusCode::kDamaged);
  write("2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n");
  EXPECT_EQ(load(trajectory).code(), StatusCode::kDamaged);
  write("1 0 0 0 0 0 0 0\n2 0 0 0 0 0 0 1\n");
  EXPECT_EQ(load(trajectory).code(), StatusCode::kDamaged);
  write("1 0 0 0 0 0 0 1\n1e9 0 0 0 0 0 0 1\n");
  EXPECT_EQ(load(trajectory).code(), StatusCode::kDamaged);
}

TEST(HandHeldTrajectory, KeepsClearOfAllSolids) {
  for (const SceneName name :
       {SceneName::kCorridor, SceneName::kStaircase, SceneName::kHall, SceneName::kDesk, SceneName::kBare}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const std::unique_ptr<sim::Scene> scene = sim::build_scene(name, seed);
      for (const double duration_s : {5.0, 120.0}) {  // the stroll, and the round where there is one
        const Trajectory trajectory = Trajectory::hand_held(*scene, seed, duration_s);
        for (double t = 0; t < duration_s; t += 0.25) {
          const Vector3 p = trajectory.at(t).t;
          const sim::Float3 eye{static_cast<float>(p.x()), static_cast<float>(p.y()),
                                static_cast<float>(p.z())};
          for (const sim::Solid& solid : scene->solids) {
            const sim::Float3 local = solid.to_local(eye);
            const auto outside = [](float x, float half) { return std::max(std::abs(x) - half, 0.0F); };
            const sim::Float3 gap{outside(local.x, solid.half.x), outside(local.y, solid.half.y),
                                  outside(local.z, solid.half.z)};
            ASSERT_GT(norm(gap), 0.2F)
                << to_string(name) << " seed " << seed << " at " << t << " of " << duration_s;
          }
        }
      }
    }
  }
}

TEST_F(RecordedTrajectory, AcceptsRecordedTrajectories) {
  const char* shared = std::getenv("PLVO_SHARED");
  const std::filesystem::path folder =
      std::filesystem::path(shared != nullptr ? shared : "") / "data/tum_groundtruth";
  if (shared == nullptr || !std::filesystem::exists(folder))
    GTEST_SKIP() << "the recorded ground truth is not here: set PLVO_SHARED to the folder that holds data/";
  int taken = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++taken;
    Trajectory trajectory;
    const Status status = Trajectory::from_tum(entry.path().string(), *scene_, trajectory);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_GT(trajectory.duration_s(), 15) << entry.path();
    for (double t = 0; t + 0.034 < trajectory.duration_s(); t += 0.5) {
      EXPECT_TRUE(trajectory.at(t).is_finite());
      EXPECT_LT(boxminus(trajectory.at(t + 0.033), trajectory.at(t)).norm(), 0.25)
          << entry.path() << " " << t;
    }
  }
  EXPECT_GT(taken, 0) << folder;
}

}  // namespace
}  // namespace plvo

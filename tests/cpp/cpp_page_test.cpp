// SPDX-License-Identifier: Apache-2.0
// The programs of docs/user/cpp.md and README.md give the poses and covariances of `plvo run` on the same
// images; the functions of docs/user/cpp.md do what the page says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "command.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/tum_writer.hpp"
#include "procedural_sequence.hpp"

namespace {

std::int64_t clock_ns = 0;
std::int64_t now_ns() { return clock_ns += 1'000'000; }

#include "function_2_of_page.inc"
#include "function_3_of_page.inc"
#include "function_4_of_page.inc"
#include "function_5_of_page.inc"
#include "function_6_of_page.inc"
#include "function_7_of_page.inc"

}  // namespace

namespace plvo {
namespace {

constexpr int kFrames = 6;
constexpr int kDark = 3;  // a frame in which there is nothing to see: it is lost

using Rows = std::vector<std::vector<double>>;

Rows rows_of(const std::string& text) {
  Rows rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    rows.emplace_back();
    for (double value; words >> value;) rows.back().push_back(value);
  }
  return rows;
}

// The same images as a recorded folder and as the stream that the programs read, and what plvo run says.
class PageProgram : public testing::Test {
 protected:
  void SetUp() override {
    ProceduralSequence rendered(640, 480);
    TumWriter writer;
    ASSERT_TRUE(writer.open(folder_ / "sequence", rendered.camera(), 1000).ok());
    std::ofstream raw(folder_ / "raw", std::ios::binary);
    for (int i = 0; i < kFrames; ++i) {
      const RgbdFrame frame = i == kDark ? rendered.render_dark(i) : rendered.render(i);
      ASSERT_TRUE(writer.write(frame).ok());
      raw.write(reinterpret_cast<const char*>(&frame.stamp_ns), sizeof frame.stamp_ns);
      raw.write(reinterpret_cast<const char*>(frame.colour.data), 3 * 640 * 480);
      raw.write(reinterpret_cast<const char*>(frame.depth.data), 2 * 640 * 480);
    }
    const std::string sequence = (folder_ / "sequence").string();
    const test::CommandResult run = test::run_command(std::string(PLVO_BINARY) + " run " + sequence +
                                                      " --quiet --out - --covariance " + sequence + "/cov");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    poses_ = rows_of(run.out);
    covariances_ = rows_of(test::read_file(folder_ / "sequence" / "cov"));
    ASSERT_EQ(poses_.size(), kFrames - 1U);
    ASSERT_EQ(covariances_.size(), poses_.size());
  }

  test::CommandResult run_on_raw_frames(const std::string& program) const {
    return test::run_command("(" + program + " <" + (folder_ / "raw").string() + ")");
  }

  test::TemporaryFolder folder_;
  Rows poses_, covariances_;
};

TEST_F(PageProgram, OfCppMdGivesThePosesAndCovariancesOfPlvoRun) {
  const test::CommandResult own = run_on_raw_frames(PLVO_CPP_EXAMPLE);
  ASSERT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(own.err.rfind("lost: ", 0), 0U) << own.err;
  const Rows rows = rows_of(own.out);
  ASSERT_EQ(rows.size(), poses_.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 8U + 6U);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(rows[i][k], poses_[i][k]) << i << ' ' << k;
    for (std::size_t k = 0; k < 6; ++k) {
      const double sigma = std::sqrt(covariances_[i][1 + 7 * k]);
      EXPECT_NEAR(rows[i][8 + k], sigma, 1e-3 * sigma) << i << ' ' << k;
    }
  }
}

TEST_F(PageProgram, OfTheReadmeGivesThePositionsAndCovariancesOfPlvoRun) {
  const test::CommandResult own = run_on_raw_frames(PLVO_README_EXAMPLE);
  ASSERT_EQ(own.exit_code, 0) << own.err;
  EXPECT_EQ(own.err.rfind("lost: ", 0), 0U) << own.err;
  const Rows rows = rows_of(own.out);
  ASSERT_EQ(rows.size(), poses_.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 7U);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(rows[i][k], poses_[i][k], 1e-6) << i << ' ' << k;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(rows[i][4 + k], std::sqrt(covariances_[i][1 + 7 * k]), 1e-6) << i << ' ' << k;
  }
}

// An odometry in the page's static memory, and the frames for it.
class PageFunctions : public testing::Test {
 protected:
  void start(const Config& config = {}) {
    ASSERT_TRUE(odometry_.init(memory, rendered_.camera(), config, kLimits).ok());
  }
  ProceduralSequence rendered_{320, 240};
  Odometry odometry_;
};

TEST_F(PageFunctions, TrackAFrameWhenStartedInStaticMemory) {
  EXPECT_TRUE(start_in_static_memory(odometry_, rendered_.camera()).ok());
  EXPECT_TRUE(pose_is_new(odometry_.track(rendered_.render(0))));
}

TEST_F(PageFunctions, WheelsCarryThePoseThroughADarkFrame) {
  start();
  Se3 T_base_camera;
  T_base_camera.t = {0.2, 0, 0.5};
  T_base_camera.R = rotation_exp({0, 0.3, 0});
  const auto T_odom_base = [&](int i) { return rendered_.T_world_camera(i) * T_base_camera.inverse(); };
  EXPECT_TRUE(pose_is_new(odometry_.track(rendered_.render(0))));
  for (int i = 1; i < 4; ++i) {
    const MotionPrior prior = prior_of_wheels(T_odom_base(i - 1), T_odom_base(i), T_base_camera, 1e-3, 1e-3);
    ASSERT_TRUE(prior.validate().ok());
    const TrackResult result =
        odometry_.track(i == 2 ? rendered_.render_dark(i) : rendered_.render(i), prior);
    EXPECT_EQ(result.state, i == 2 ? TrackState::kPredicted : TrackState::kTracking);
    EXPECT_TRUE(pose_is_new(result));
    const Se3 truth = rendered_.T_world_camera(0).inverse() * rendered_.T_world_camera(i);
    EXPECT_LT((result.T_world_camera.t - truth.t).norm(), 0.005) << i;
  }
  EXPECT_FALSE(pose_is_new(odometry_.track(rendered_.render_dark(4)))) << "without a prior it is lost";
}

TEST_F(PageFunctions, ThePoseThatIsSetIsThatOfTheFirstFrame) {
  start();
  ASSERT_TRUE(place_camera(odometry_, 0.4).ok());
  EXPECT_EQ(odometry_.track(rendered_.render(0)).T_world_camera.t.y(), -0.4);
  odometry_.reset();
  EXPECT_EQ(odometry_.track(rendered_.render(1)).T_world_camera.t.y(), 0);
}

TEST_F(PageFunctions, TheBudgetTakesFeaturesAwayAndTheStagesHaveTimes) {
  Config config = with_stage_clock({});
  config.budget.frame_ns = 1;  // now_ns() advances by 1 ms with each call
  start(config);
  int step = 0;
  for (int i = 0; i < 3; ++i) {
    const TrackResult result = track_in_time(odometry_, rendered_.render(i));
    EXPECT_GE(result.feature_step, step);
    step = result.feature_step;
    if (i == 2) {
      testing::internal::CaptureStdout();
      print_stages(result);
      EXPECT_EQ(testing::internal::GetCapturedStdout().rfind("image ", 0), 0U);
      EXPECT_GT(result.stage_ns[0], 0);
    }
  }
  EXPECT_GT(step, 0);
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// The wheels of a sensor, whose clock nobody outside knows: stamps of the lines are this computer's time.
#include "plvo/cli/live/live_wheels.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "plvo/host/posix_clock.hpp"
#include "temporary_folder.hpp"

namespace plvo::cli {
namespace {

constexpr std::int64_t kStampOfNow = 5'000'000'000;  // the sensor's clock at the first frame
constexpr std::int64_t kArrival = 33'000'000;        // after its stamp

double since_1970_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class LiveWheelsOfASensor : public ::testing::Test {
 protected:
  void start() {
    test::write_file(folder_ / "lines", "");
    BaseOption base;
    base.T_base_camera = Se3();
    WheelOptions options;
    options.file = (folder_ / "lines").string();
    const Status status = wheels_.start(options, base, WheelClock::kComputer);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  void write(const std::string& line) { std::ofstream(folder_ / "lines", std::ios::app) << line << '\n'; }
  // A second of 0.5 m/s until now.
  void drive(double now_s) {
    for (int k = -50; k <= 0; ++k) write(fmt::format("{:.6f} 0.5 0 0", now_s + 0.02 * k));
  }
  MotionPrior frame(int index) {
    const std::int64_t since_first_ns = index * 100'000'000;
    return wheels_.until(kStampOfNow + since_first_ns, first_arrival_ns_ + since_first_ns);
  }

  test::TemporaryFolder folder_;
  Console console_{true};
  LiveWheels wheels_{console_};
  // The stamp of the first frame is 0.5 s ago.
  const std::int64_t first_arrival_ns_ = posix_monotonic_ns() - 500'000'000 + kArrival;
};

TEST_F(LiveWheelsOfASensor, StampsOfLinesAreConvertedToTheClockOfTheFrames) {
  start();
  drive(since_1970_s());
  EXPECT_FALSE(frame(0).tells_motion());
  for (int i = 1; i <= 4; ++i) {
    const MotionPrior prior = frame(i);
    ASSERT_TRUE(prior.translation) << i;
    EXPECT_NEAR(prior.translation->t_now_before.norm(), 0.05, 1e-3) << i;
  }
  EXPECT_FALSE(frame(8).tells_motion()) << "the lines end before";
  EXPECT_EQ(wheels_.summary().with, 4U);
  EXPECT_EQ(wheels_.summary().without, 1U);
  EXPECT_EQ(console_.warnings().size(), 1U);
}

TEST_F(LiveWheelsOfASensor, AStampOfAnotherClockIsLeftOut) {
  start();
  (void)frame(0);
  write("12.5 0.5 0 0");
  write(fmt::format("{:.6f} 0.5 0 0", since_1970_s() + 3600));
  write("-1 0.5 0 0");
  drive(since_1970_s());
  EXPECT_TRUE(frame(1).tells_motion());
  EXPECT_EQ(wheels_.summary().lines, 54U);
  EXPECT_EQ(wheels_.summary().left_out, 2U) << "12.5 s since 1970 is only long ago";
  ASSERT_FALSE(console_.warnings().empty());
  EXPECT_NE(console_.warnings()[0].find("is not this computer's time in seconds since 1970"),
            std::string::npos)
      << console_.warnings()[0];
}

TEST_F(LiveWheelsOfASensor, LinesAreReadWhileNoFrameComes) {
  start();
  wheels_.while_no_frame_comes();
  EXPECT_EQ(wheels_.summary().lines, 0U) << "before the first frame there is no clock to take them over to";
  (void)frame(0);
  drive(since_1970_s());
  wheels_.while_no_frame_comes();
  EXPECT_EQ(wheels_.summary().lines, 51U);
  EXPECT_TRUE(frame(1).tells_motion());
}

TEST_F(LiveWheelsOfASensor, SpeedsThatNoRobotHasAreToldOnce) {
  start();
  (void)frame(0);
  const double now_s = since_1970_s();
  for (int k = -50; k <= 0; ++k) write(fmt::format("{:.6f} 500 0 57", now_s + 0.02 * k));
  (void)frame(1);
  ASSERT_EQ(console_.warnings().size(), 2U);
  EXPECT_EQ(console_.warnings()[0], "the wheels drive at up to 500 m/s: are their speeds in m/s?");
  EXPECT_EQ(console_.warnings()[1], "the wheels turn at up to 57 rad/s: are their rates in rad/s?");
}

}  // namespace
}  // namespace plvo::cli

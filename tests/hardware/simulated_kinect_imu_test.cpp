// SPDX-License-Identifier: Apache-2.0
// `plvo live --imu` and `plvo record --imu` with a simulated USB Kinect whose accelerometer is read through
// the real libusb: gravity reaches the odometry with its frame, and faults of the accelerometer do not stop
// the program.
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <limits>
#include <optional>
#include <sstream>
#include <thread>

#include "kinect_command.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/replay/imu_files.hpp"
#include "simulated_motor.hpp"
#include "wrapped_track.hpp"

// The linker's --wrap routes every call of track() through these functions.
namespace {
struct Tracked {
  std::int64_t stamp_ns;
  std::int64_t host_ns;  // steady_clock at the time of the call
  plvo::MotionPrior prior;
};
std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
std::vector<Tracked> tracked;
std::atomic<int> tracks{0};
}  // namespace
plvo::TrackResult wrapped_track(plvo::Odometry* odometry, const plvo::RgbdFrame& frame,
                                const plvo::MotionPrior& prior) {
  tracked.push_back({frame.stamp_ns, now_ns(), prior});
  ++tracks;
  return real_track(odometry, frame, prior);
}
// Takes the prior itself, to record it. Without a gyro there is no offset to correct.
plvo::TrackResult
wrapped_track(plvo::Odometry* odometry, const plvo::RgbdFrame& frame, plvo::ImuIntegrator& imu, const plvo::MotionPrior&) asm(
    "__wrap__ZN4plvo8Odometry5trackERKNS_9RgbdFrameERNS_"
    "13ImuIntegratorERKNS_11MotionPriorE");
plvo::TrackResult wrapped_track(plvo::Odometry* odometry, const plvo::RgbdFrame& frame,
                                plvo::ImuIntegrator& imu, const plvo::MotionPrior&) {
  return wrapped_track(odometry, frame, imu.prior(frame.stamp_ns));
}

namespace plvo_test {
namespace {

// Reading of a tilted Kinect at rest: 0.8 g up, 0.6 g forward.
constexpr std::array<int, 3> kTilted = {0, 655, 491};

long count_of(const std::string& text, const std::string& words) {
  long count = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
  return count;
}

class KinectImu : public KinectCommand {
 protected:
  static long with_gravity() {
    return std::count_if(tracked.begin(), tracked.end(),
                         [](const Tracked& t) { return t.prior.gravity.has_value(); });
  }
};

TEST_F(KinectImu, GravityComesWithTheFrames) {
  show_a_room();
  kinect_.plug();
  SimulatedMotor motor(kinect_, [] { return kTilted; });
  motor.plug();
  ASSERT_EQ(plvo({"live", "--imu", "--frames", "60", "--json", path("j.json")}), 0) << err_;
  EXPECT_GE(with_gravity(), 50) << "of 60 frames, but for a machine that is busy with others";
  for (const Tracked& t : tracked) {
    ASSERT_FALSE(t.prior.tells_motion());
    if (!t.prior.gravity) continue;
    // In the camera frame: x right, y down, z forward.
    const plvo::Vector3 down = t.prior.gravity->down.normalized();
    ASSERT_LT((down - plvo::Vector3(0, 0.8, -0.6)).norm(), 2e-3) << down.transpose();
    // The noise covers hand-held acceleration and a time error of up to 20 ms: 0.65 m/s² or more.
    EXPECT_GE(std::sqrt(t.prior.gravity->covariance(0, 0)), 0.65 / 9.81);
  }
  const nlohmann::json summary = json("j.json")["accelerometer"];
  EXPECT_GT(summary["readings"], 60);
  EXPECT_EQ(summary["failures"], 0);
  EXPECT_NE(out_.find("accelerometer "), std::string::npos) << out_;
  EXPECT_EQ(json("j.json")["lost"], 0);
}

TEST_F(KinectImu, TheWorldIsLevelOnRequest) {
  show_a_room();
  kinect_.plug();
  SimulatedMotor motor(kinect_, [] { return kTilted; });
  motor.plug();
  ASSERT_EQ(plvo({"live", "--imu", "--level", "--frames", "30", "--out", path("t"), "--quiet"}), 0) << err_;
  EXPECT_NE(read_file(path("t")).find("turned level: gravity along y"), std::string::npos);
  plvo::Trajectory trajectory;
  ASSERT_TRUE(plvo::read_trajectory({path("t"), plvo::TrajectoryFormat::kTum, {}}, trajectory).ok());
  ASSERT_GT(trajectory.poses.size(), 20U) << "from the first reading on";
  const plvo::Vector3 down(0, 0.8, -0.6);
  EXPECT_LT((trajectory.poses[0].T_world_camera.R * down - plvo::Vector3(0, 1, 0)).norm(), 2e-3);
}

// The accelerometer's first axis encodes the time of the reading. A frame gets the mean of the readings since
// the previous frame. On the camera's clock, this is accurate to the stated 20 ms for frames that arrive
// without delay. On a machine that is too slow for camera and command together, every frame is late, and the
// stamps of the readings are early by the smallest of these delays.
TEST_F(KinectImu, ReadingsAreStampedByTheClockOfTheFrames) {
  constexpr double kCountsPerSecond = 50;
  constexpr double kTurn_s = 4294967296.0 / 60e6;  // range of the camera's clock
  const std::int64_t start_ns = now_ns();
  show_a_room();
  kinect_.plug(123456);
  SimulatedMotor motor(kinect_, [&] {
    const double seconds = static_cast<double>(now_ns() - start_ns) * 1e-9;
    return std::array<int, 3>{static_cast<int>(kCountsPerSecond * seconds) - 400, 819, 0};
  });
  motor.plug();
  ASSERT_EQ(plvo({"live", "--imu", "--frames", "150", "--quiet"}), 0) << err_;
  std::vector<double> errors_s;
  std::int64_t held_up_ns = std::numeric_limits<std::int64_t>::max();
  for (std::size_t i = 0; i < tracked.size(); ++i) {
    const auto shown_ns = [&](std::size_t frame) { return kinect_.host_ns(tracked[frame].stamp_ns); };
    held_up_ns = std::min(held_up_ns, tracked[i].host_ns - shown_ns(i) - SimulatedKinect::kFrame_ns);
    if (i == 0 || !tracked[i].prior.gravity) continue;
    const plvo::Vector3 force = -tracked[i].prior.gravity->down;
    const double told_s = (force.x() * 819 / 9.80665 + 400.5) / kCountsPerSecond;
    const std::int64_t stamped_ns = (shown_ns(i) + shown_ns(i - 1)) / 2 + held_up_ns;
    const double error_s = told_s - static_cast<double>(stamped_ns - start_ns) * 1e-9;
    errors_s.push_back(std::remainder(error_s, kTurn_s));
  }
  ASSERT_GT(errors_s.size(), 75U);
  std::sort(errors_s.begin(), errors_s.end());
  const double median_s = errors_s[errors_s.size() / 2];
  std::printf(
      "%zu readings are stamped %+.1f ms early (median; a tenth %+.1f ms); the quickest frame was held up "
      "%.1f ms\n",
      errors_s.size(), 1e3 * median_s, 1e3 * errors_s[errors_s.size() / 10],
      1e3 * std::remainder(1e-9 * static_cast<double>(held_up_ns), kTurn_s));
  EXPECT_LT(std::abs(median_s), 0.020);
}

TEST_F(KinectImu, AMissingAccelerometerIsReportedOnce) {
  show_a_room();
  kinect_.plug();
  ASSERT_EQ(plvo({"live", "--imu", "--frames", "60"}), 0) << err_;
  EXPECT_EQ(count_of(err_, "no accelerometer, poses are tracked without gravity"), 1) << err_;
  EXPECT_NE(err_.find("no Kinect v1 motor on the USB"), std::string::npos) << err_;
  EXPECT_EQ(with_gravity(), 0);
  EXPECT_EQ(tracked.size(), 60U);
}

TEST_F(KinectImu, AFailingAccelerometerStopsNothingElseAndMayComeBack) {
  show_a_room();
  kinect_.plug();
  SimulatedMotor motor(kinect_, [] { return kTilted; });
  motor.plug();
  std::atomic<bool> ended{false};
  std::thread hand([&] {
    const auto wait_for = [&](auto condition) {
      while (!ended && !condition()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    };
    wait_for([] { return tracks > 20; });
    for (int i = 0; i < 2; ++i) {
      motor.set_error(EPIPE);
      const int asked = motor.questions();
      wait_for([&] { return motor.questions() > asked + 1; });  // it failed and was retried
      motor.set_error(0);
      const int again = motor.questions();
      wait_for([&] { return motor.questions() > again + 20; });
    }
  });
  const int code = plvo({"live", "--imu", "--frames", "300", "--json", path("j.json")});
  ended = true;
  hand.join();
  EXPECT_EQ(code, 0) << err_;
  EXPECT_EQ(tracked.size(), 300U);
  EXPECT_EQ(count_of(err_, "poses are tracked without gravity: cannot read the Kinect's state"), 1) << err_;
  EXPECT_EQ(count_of(err_, "the Kinect's accelerometer answers again"), 1) << err_;
  EXPECT_GE(json("j.json")["accelerometer"]["failures"], 3) << json("j.json");
  EXPECT_EQ(json("j.json")["lost"], 0);
  EXPECT_TRUE(tracked.back().prior.gravity.has_value()) << "it is back";
}

TEST_F(KinectImu, RecordKeepsWhatItReads) {
  show_a_room();
  kinect_.plug();
  SimulatedMotor motor(kinect_, [] { return kTilted; });
  motor.plug();
  ASSERT_EQ(plvo({"record", path("sequence"), "--imu", "--frames", "30", "--quiet"}), 0) << err_;
  plvo::ImuRecording kept;
  const plvo::Status status = plvo::read_imu_files(path("sequence"), kept);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(kept.gyro.empty());
  EXPECT_EQ(kept.ignored, 0U);
  ASSERT_GT(kept.accelerometer.size(), 20U);
  EXPECT_NEAR(kept.accelerometer[3].value.y(), 655 * 9.80665 / 819, 1e-12);
  EXPECT_NEAR(kept.accelerometer[3].value.z(), 491 * 9.80665 / 819, 1e-12);
  EXPECT_NE(read_file(path("sequence/accelerometer.txt")).find("--imu-axes x,-y,z"), std::string::npos);
  // The readings are recorded with the frames, on the same clock.
  std::istringstream rows(read_file(path("sequence/rgb.txt")));
  std::string row;
  std::getline(rows, row);
  std::getline(rows, row);
  const double first_frame = std::stod(row);
  const double first_reading = static_cast<double>(kept.accelerometer.front().stamp_ns) * 1e-9;
  EXPECT_LT(std::abs(first_reading - first_frame), 2.0);
  tracked.clear();
  ASSERT_EQ(plvo({"run", path("sequence"), "--imu", "--imu-axes", "x,-y,z", "--readout", "0", "--quiet"}), 0)
      << err_;
  EXPECT_GE(with_gravity(), 20);
  EXPECT_LT((tracked.back().prior.gravity->down.normalized() - plvo::Vector3(0, 0.8, -0.6)).norm(), 2e-3);
}

}  // namespace
}  // namespace plvo_test

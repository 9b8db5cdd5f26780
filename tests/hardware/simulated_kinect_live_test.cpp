// SPDX-License-Identifier: Apache-2.0
// The command line with a simulated USB Kinect below the real libusb, libfreenect, OpenNI2 and our driver.
// umockdev needs the bus and its client in one process, so the tests call the commands as functions.
// PLVO_KINECT_SECONDS sets the duration of the run at full rate (default 5).
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "allocation_guard.hpp"
#include "kinect_command.hpp"
#include "kinect_reference.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "processor_time.hpp"
#include "wrapped_track.hpp"

// The linker's --wrap routes every call of track() through this function, which counts its allocations.
namespace {
std::atomic<std::int64_t> tracks{0}, allocations{0};
}
plvo::TrackResult wrapped_track(plvo::Odometry* odometry, const plvo::RgbdFrame& frame,
                                const plvo::MotionPrior& prior) {
  const plvo::AllocationGuard guard;
  plvo::TrackResult result = real_track(odometry, frame, prior);
  allocations += guard.calls();
  ++tracks;
  return result;
}

namespace plvo_test {
namespace {

TEST_F(KinectCommand, LiveAtFullRateWithoutAllocationsInFlatMemory) {
  const char* given = std::getenv("PLVO_KINECT_SECONDS");
  const double seconds = given != nullptr ? std::atof(given) : 5;
  show_a_room();
  // The clock wraps after a third of the duration.
  kinect_.plug(static_cast<std::uint32_t>(0) - static_cast<std::uint32_t>(seconds / 3 * 60e6));
  const ProcessorTime processor;
  tracks = allocations = 0;
  const int wanted = static_cast<int>(30 * seconds);  // frames, not time: the machine may be loaded
  ASSERT_EQ(plvo({"live", "--frames", std::to_string(wanted), "--out", path("t.txt"), "--json",
                  path("j.json"), "--stream", "unix:" + path("poses"), "--quiet"}),
            0)
      << err_;
  const nlohmann::json json = this->json("j.json");
  std::printf("camera %.2f Hz, tracked %d of %d, dropped %d; latency %.1f ms median, %.1f p95\n",
              json["camera_hz"].get<double>(), json["tracked"].get<int>(), json["camera_frames"].get<int>(),
              json["dropped"].get<int>(), json["latency_ms"]["median"].get<double>(),
              json["latency_ms"]["p95"].get<double>());
  if (kFiguresCount) {
    EXPECT_EQ(processor.judge(json["camera_frames"].get<double>(), SimulatedKinect::kFrame_ns * 1e-9), "");
  }
  // The stamps continue through the wrap of the Kinect's clock; consecutive stamps differ by one or more
  // frame periods.
  std::istringstream rows(read_file(path("t.txt")));
  std::string row;
  std::getline(rows, row);
  double last = -1;
  std::int64_t steps = 0;
  while (std::getline(rows, row)) {
    const double stamp = std::stod(row);
    if (last >= 0) {
      const double periods = (stamp - last) / (SimulatedKinect::kFrame_ns * 1e-9);
      ASSERT_GE(std::round(periods), 1) << row;
      ASSERT_NEAR(periods, std::round(periods), 0.05) << row;
      steps += static_cast<std::int64_t>(std::round(periods));
    }
    last = stamp;
  }
  EXPECT_GE(steps, tracks - 1);
  EXPECT_GE(static_cast<double>(steps * SimulatedKinect::kFrame_ns) * 1e-9, seconds / 2)
      << "it went through the wrap";
  EXPECT_EQ(json["camera_counters"]["clock_jumps"], 0);
  EXPECT_EQ(json["lost"], 0) << json;
  // On a loaded machine a colour image may come twice.
  EXPECT_GE(json["tracked"].get<int>() + json["repeated"].get<int>(), wanted - 1);
  EXPECT_EQ(tracks, json["frames"].get<std::int64_t>());
  if (plvo::AllocationGuard::available()) {
    EXPECT_EQ(allocations, 0) << "by the core, in " << tracks << " frames";
  }
  if (kFiguresCount) {
    const auto growth = json["memory_bytes"]["anonymous_at_end"].get<std::int64_t>() -
                        json["memory_bytes"]["anonymous_after_start"].get<std::int64_t>();
    std::printf("memory %+ld kB\n", static_cast<long>(growth / 1024));
    EXPECT_LT(growth, 1 << 20);
  }
}

TEST_F(KinectCommand, RecordKeepsEveryByte) {
  kinect_.plug();
  Reference reference;
  ASSERT_TRUE(reference.take());
  ASSERT_EQ(plvo({"record", path("sequence"), "--frames", "6", "--quiet"}), 0) << err_;
  plvo::Calibration calibration;
  ASSERT_TRUE(plvo::read_calibration(path("sequence/calibration.txt"), calibration).ok());
  plvo::RecordedCamera camera;
  ASSERT_TRUE(camera.open(path("sequence"), calibration).ok());
  plvo::RgbdFrame frame;
  int frames = 0;
  for (; camera.next(frame).ok(); ++frames) {
    const int picture = Reference::picture_of(frame.colour.data);
    ASSERT_GE(picture, 0) << frames;
    EXPECT_EQ(std::memcmp(frame.colour.data, reference.rgb[picture].data(), SimulatedKinect::kPixels * 3), 0);
    EXPECT_EQ(
        std::memcmp(frame.depth.data, reference.registered[picture].data(), SimulatedKinect::kPixels * 2), 0);
    EXPECT_EQ(frame.depth.metres_per_unit, 0.001);
  }
  EXPECT_EQ(frames, 6);
}

TEST_F(KinectCommand, LiveOutlivesAnUnplug) {
  show_a_room();
  kinect_.plug();
  tracks = 0;
  std::atomic<bool> ended{false};
  std::thread hand([&] {
    while (tracks < 10 && !ended) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    kinect_.unplug();
    std::this_thread::sleep_for(std::chrono::seconds(3));  // long enough to be detected
    kinect_.plug();
  });
  const int code = plvo({"live", "--frames", "200", "--json", path("j.json"), "--stats", path("s.csv")});
  ended = true;
  hand.join();
  EXPECT_EQ(code, 0) << err_;
  EXPECT_NE(err_.find("was unplugged; plug it in again to go on"), std::string::npos) << err_;
  EXPECT_NE(err_.find("frames arrive again"), std::string::npos) << err_;
  const nlohmann::json json = this->json("j.json");
  EXPECT_EQ(json["camera_counters"]["replugged"], 1) << err_;
  const std::string rows = read_file(path("s.csv"));
  EXPECT_NE(rows.substr(rows.rfind('\n', rows.size() - 2)).find(",tracking,"), std::string::npos) << rows;
}

TEST_F(KinectCommand, LiveSaysWhyItCannotHaveTheKinect) {
  EXPECT_EQ(plvo({"live"}), 4);
  EXPECT_NE(err_.find("no sensor"), std::string::npos) << err_;
  kinect_.plug();
  kinect_.deny();
  EXPECT_EQ(plvo({"live"}), 4);
  kinect_.allow();
  EXPECT_NE(err_.find("60-plvo-rgbd.rules"), std::string::npos) << err_;
  kinect_.set_faults({.claim_errno = EBUSY});
  EXPECT_EQ(plvo({"live"}), 4);
  EXPECT_NE(err_.find("another program holds the sensor"), std::string::npos) << err_;
}

// The four diagnoses of the doctor. The one without a driver runs with another OpenNI2 folder.
class KinectDoctor : public KinectCommand {};

TEST_F(KinectDoctor, ReportsThatNothingIsPluggedIn) {
  EXPECT_EQ(plvo({"doctor"}), 4);
  EXPECT_NE(out_.find("problem  No known RGB-D sensor is plugged in."), std::string::npos) << out_;
  EXPECT_EQ(out_.find("Test capture"), std::string::npos) << out_;
}

TEST_F(KinectDoctor, NamesTheUdevRuleWhenPermissionIsDenied) {
  kinect_.plug();
  kinect_.deny();
  EXPECT_EQ(plvo({"doctor", "--seconds", "1"}), 4);
  kinect_.allow();
  EXPECT_NE(out_.find("problem  No permission to use the Kinect v1 camera (port 1-1.3)"), std::string::npos)
      << out_;
  EXPECT_NE(out_.find("60-plvo-rgbd.rules"), std::string::npos) << out_;
}

TEST_F(KinectDoctor, CapturesFromAHealthyKinect) {
  show_a_room();
  kinect_.plug();
  const int code = plvo({"doctor", "--seconds", "1"});
  EXPECT_NE(out_.find("good     The Kinect v1 camera (port 1-1.3) is ready."), std::string::npos) << out_;
  // On a loaded machine the frames may arrive too slowly; the doctor must then report this and nothing else.
  const bool slow = out_.find("frames came per second") != std::string::npos;
  EXPECT_EQ(code, slow ? 4 : 0) << out_;
  EXPECT_NE(slow, out_.find("good     The test capture is good") != std::string::npos) << out_;
  EXPECT_NE(out_.find("freenect://1-1.3"), std::string::npos) << out_;
}

TEST_F(KinectDoctor, ReportsTheMissingDriver) {
  kinect_.plug();
  EXPECT_EQ(plvo({"doctor"}), 4);
  EXPECT_NE(out_.find("problem  OpenNI2 has no driver for the Kinect v1 in"), std::string::npos) << out_;
  EXPECT_NE(out_.find("-> plvo brings its own"), std::string::npos) << out_;
}

}  // namespace
}  // namespace plvo_test

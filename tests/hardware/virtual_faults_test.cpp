// SPDX-License-Identifier: Apache-2.0
// OpenNi2Camera with the real OpenNI2 and a virtual device: every fault of a sensor is a state that ends with
// the fault.
#include <cstdlib>
#include <thread>

#include "virtual_device_fixture.hpp"

namespace plvo_test {
namespace {

TEST_F(VirtualDeviceTest, DeliversFramesAgainWhenReplugged) {
  open();
  ASSERT_TRUE(next_frame().ok());
  const std::int64_t before_ns = frame_.stamp_ns;
  ASSERT_TRUE(device_.command("unplug"));
  Status status = wait_for(StatusCode::kUnplugged);
  EXPECT_EQ(status.code(), StatusCode::kUnplugged) << status.message();
  // The device is still absent: each call waits until its time limit and reports it.
  EXPECT_EQ(camera_.next(frame_).code(), StatusCode::kUnplugged);
  // The device's clock restarts; the camera's stamps continue.
  ASSERT_TRUE(device_.command("clock 0"));
  ASSERT_TRUE(device_.command("plug"));
  status = next_frame();
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_GT(frame_.stamp_ns, before_ns + 300000000);
  EXPECT_GE(colour_tick(), 0);
  EXPECT_GE(depth_tick(), 0);
  EXPECT_EQ(camera_.counters().unplugged, 1u);
  EXPECT_EQ(camera_.counters().replugged, 1u);
  EXPECT_EQ(camera_.counters().clock_jumps, 0u);
}

TEST_F(VirtualDeviceTest, MissingDeviceIsReported) {
  ASSERT_TRUE(device_.command("unplug"));
  const Status status = camera_.open(options_);
  EXPECT_EQ(status.code(), StatusCode::kNotFound) << status.message();
}

TEST_F(VirtualDeviceTest, NamesTheStreamThatStopped) {
  open();
  ASSERT_TRUE(next_frame().ok());
  for (const char* stream : {"colour", "depth"}) {
    ASSERT_TRUE(device_.command((std::string("stop ") + stream).c_str()));
    const Clock::time_point start = Clock::now();
    // A call that began before the stop may still have received both streams; a later one has not.
    Status status;
    while (!says(status, std::string(stream) + " stream stopped") && seconds_since(start) < kPatience_s) {
      status = camera_.next(frame_);
    }
    ASSERT_EQ(status.code(), StatusCode::kTimeout) << status.message();
    ASSERT_TRUE(device_.command("run"));
    ASSERT_TRUE(next_frame().ok());
    EXPECT_EQ(colour_tick(), depth_tick() % 256);
  }
  EXPECT_GT(camera_.counters().unmatched_colour + camera_.counters().unmatched_depth, 0u);
}

TEST_F(VirtualDeviceTest, StallIsATimeoutAndEnds) {
  // PLVO_STALL_S=30 sets a stall of 30 s; only the waiting time differs.
  const char* given = std::getenv("PLVO_STALL_S");
  const double stall_s = given != nullptr ? std::atof(given) : 1.5;
  open();
  ASSERT_TRUE(next_frame().ok());
  ASSERT_TRUE(device_.command("stall"));
  const Clock::time_point start = Clock::now();
  Status status = wait_for(StatusCode::kTimeout);
  int timeouts = 0;
  while (seconds_since(start) < stall_s) {
    status = camera_.next(frame_);
    if (status.ok()) continue;  // a frame that was in transit
    ASSERT_EQ(status.code(), StatusCode::kTimeout) << status.message();
    ++timeouts;
  }
  EXPECT_GE(timeouts, 1);
  EXPECT_NE(std::string(status.message()).find("no frames"), std::string::npos) << status.message();
  ASSERT_TRUE(device_.command("run"));
  ASSERT_TRUE(next_frame().ok());
  EXPECT_EQ(colour_tick(), depth_tick() % 256);
  EXPECT_GE(camera_.counters().missing, 10u) << "the gap is counted";
}

TEST_F(VirtualDeviceTest, StampsIncreaseWhenTheClockJumpsBack) {
  open();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(next_frame().ok());
  std::int64_t last_ns = frame_.stamp_ns;
  ASSERT_TRUE(device_.command("clock 5000"));
  for (int i = 0; i < 15; ++i) {
    ASSERT_TRUE(next_frame().ok());
    EXPECT_GT(frame_.stamp_ns, last_ns);
    EXPECT_LT(frame_.stamp_ns, last_ns + 2000000000);
    EXPECT_EQ(colour_tick(), depth_tick() % 256) << "after the jump the pairs still belong together";
    last_ns = frame_.stamp_ns;
  }
  EXPECT_EQ(camera_.counters().clock_jumps, 1u);
  EXPECT_EQ(camera_.counters().clock_wraps, 0u);
}

TEST_F(VirtualDeviceTest, ClockWrapsAsTheKinectsDoes) {
  ASSERT_TRUE(device_.command("wrap 200000"));
  open();
  ASSERT_TRUE(next_frame().ok());
  std::int64_t last_ns = frame_.stamp_ns;
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(next_frame().ok());
    const std::int64_t step_us = (frame_.stamp_ns - last_ns) / 1000;
    EXPECT_EQ(step_us % 33333, 0) << "the step over the wrap is exact: " << step_us;
    EXPECT_EQ(frame_.depth_stamp_ns - frame_.stamp_ns, kPatternDepthOffset_us * 1000);
    EXPECT_EQ(colour_tick(), depth_tick() % 256);
    last_ns = frame_.stamp_ns;
  }
  EXPECT_EQ(camera_.counters().clock_wraps, 1u);
  EXPECT_EQ(camera_.counters().clock_jumps, 0u);
}

TEST_F(VirtualDeviceTest, PairsImagesWhenDepthArrivesLate) {
  ASSERT_TRUE(device_.command("late 4"));
  open();
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(next_frame().ok());
    EXPECT_EQ(colour_tick(), depth_tick() % 256) << "late depth belongs to the older colour image";
  }
}

TEST_F(VirtualDeviceTest, StampsTooFarApartNeverPair) {
  ASSERT_TRUE(device_.command("shift 12000"));
  options_.pair_tolerance_us = 10000;
  open();
  // Depth comes 12 ms after its colour image and 21 ms before the next: neither is within 10 ms.
  const Status status = camera_.next(frame_);
  EXPECT_EQ(status.code(), StatusCode::kTimeout);
  EXPECT_NE(std::string(status.message()).find("apart"), std::string::npos) << status.message();
  EXPECT_GT(camera_.counters().unmatched_depth, 3u);
  EXPECT_EQ(camera_.counters().frames, 0u);
  ASSERT_TRUE(device_.command("shift 9000"));
  EXPECT_TRUE(next_frame().ok());
}

TEST_F(VirtualDeviceTest, CoveredCameraStillDelivers) {
  ASSERT_TRUE(device_.command("dark 1"));
  ASSERT_TRUE(device_.command("zero_depth 1"));
  open();
  ASSERT_TRUE(next_frame().ok());
  for (int i = 0; i < 640 * 480; ++i) {
    ASSERT_EQ(frame_.depth.data[i], 0);
    ASSERT_EQ(frame_.colour.data[3 * i], 0);
  }
}

TEST_F(VirtualDeviceTest, DamagedImageIsSkipped) {
  open();
  ASSERT_TRUE(next_frame().ok());
  ASSERT_TRUE(device_.command("damage 1"));
  const Status status = wait_for(StatusCode::kDamaged);
  EXPECT_EQ(status.code(), StatusCode::kDamaged) << status.message();
  ASSERT_TRUE(next_frame().ok());
  EXPECT_EQ(colour_tick(), depth_tick() % 256);
  EXPECT_EQ(camera_.counters().damaged, 1u);
}

TEST_F(VirtualDeviceTest, SlowReaderGetsPairsAndLossIsCounted) {
  open();
  // Reads until enough frames are lost: the number of frames between two reads depends on the machine.
  const Clock::time_point start = Clock::now();
  while ((camera_.counters().dropped_colour <= 5 || camera_.counters().missing <= 5) &&
         seconds_since(start) < kPatience_s) {
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    ASSERT_TRUE(next_frame().ok());
    EXPECT_EQ(colour_tick(), depth_tick() % 256);
  }
  EXPECT_GT(camera_.counters().dropped_colour, 5u);
  EXPECT_GT(camera_.counters().missing, 5u);
}

}  // namespace
}  // namespace plvo_test

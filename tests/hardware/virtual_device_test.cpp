// SPDX-License-Identifier: Apache-2.0
// OpenNi2Camera over the real OpenNI2 and a virtual device: the right bytes, the right pairs, and every fault
// of a sensor as a state that ends when the fault does.
#include "virtual_device.hpp"

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "plvo/openni2/openni2_camera.hpp"
#include "plvo/openni2/software_registration.hpp"

namespace plvo_test {
namespace {

using plvo::OpenNi2Camera;
using plvo::OpenNi2Options;
using plvo::RgbdFrame;
using plvo::Status;
using plvo::StatusCode;
using Clock = std::chrono::steady_clock;

struct Messages : plvo::Log {
  void write(plvo::LogLevel /*level*/, std::string_view message) override {
    text.append(message).append("\n");
  }
  std::string text;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class VirtualDeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(openni::OpenNI::initialize(), openni::STATUS_OK) << openni::OpenNI::getExtendedError();
    ASSERT_TRUE(device_.find()) << "OpenNI2 did not load the virtual driver: run this test through ctest";
    options_.log = &log_;
    options_.timeout_ms = 400;
  }
  void TearDown() override {
    camera_.close();
    device_.set_source(nullptr, nullptr);
    device_.command("reset");
    device_.command("plug");
    openni::OpenNI::shutdown();
  }
  void open() {
    const Status status = camera_.open(options_);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  // The next frame, however many timeouts lie before it (10 s at most).
  Status next_frame() {
    const Clock::time_point start = Clock::now();
    Status status = camera_.next(frame_);
    while (!status.ok() && seconds_since(start) < 10) status = camera_.next(frame_);
    return status;
  }
  // The first answer that is not a frame (10 s at most).
  Status next_fault() {
    const Clock::time_point start = Clock::now();
    Status status = camera_.next(frame_);
    while (status.ok() && seconds_since(start) < 10) status = camera_.next(frame_);
    return status;
  }
  // Which tick of the pattern the colour image shows, by its first pixel (modulo 256); all of it must fit.
  int colour_tick() const {
    const int first = frame_.colour.data[0];
    const int index = first * 183 % 256;  // 7 · 183 = 1 (mod 256)
    for (int y = 0; y < frame_.colour.height; ++y) {
      for (int x = 0; x < frame_.colour.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          if (frame_.colour.data[y * frame_.colour.stride_bytes + 3 * x + c] !=
              pattern_colour(index, x, y, c))
            return -1;
        }
      }
    }
    return index;
  }
  // The same for depth (modulo 4000).
  int depth_tick() const {
    const int first = frame_.depth.data[0] - 500;
    const int index = first * 1091 % 4000;  // 11 · 1091 = 1 (mod 4000)
    for (int y = 0; y < frame_.depth.height; ++y) {
      for (int x = 0; x < frame_.depth.width; ++x) {
        if (frame_.depth.data[y * frame_.depth.stride + x] != pattern_depth(index, x, y)) return -1;
      }
    }
    return index;
  }

  VirtualDevice device_;
  Messages log_;
  OpenNi2Options options_;
  OpenNi2Camera camera_;
  RgbdFrame frame_;
};

TEST_F(VirtualDeviceTest, ListsTheDevice) {
  std::vector<plvo::OpenNi2DeviceInfo> devices;
  ASSERT_TRUE(OpenNi2Camera::list(devices).ok());
  ASSERT_EQ(devices.size(), 1u);
  EXPECT_EQ(devices[0].uri, "virtual://plvo");
  EXPECT_EQ(devices[0].name, "Virtual RGB-D");
}

TEST_F(VirtualDeviceTest, EveryByteArrivesInPairsOfOneTick) {
  open();
  std::int64_t last_ns = 0;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(camera_.next(frame_).ok());
    ASSERT_EQ(frame_.colour.width, 640);
    ASSERT_EQ(frame_.colour.height, 480);
    ASSERT_EQ(frame_.depth.width, 640);
    EXPECT_EQ(frame_.depth.metres_per_unit, 0.001);
    const int colour = colour_tick();
    ASSERT_GE(colour, 0) << "a wrong colour byte";
    ASSERT_EQ(colour, depth_tick() % 256) << "colour and depth of different ticks, or a wrong depth value";
    EXPECT_EQ(frame_.depth_stamp_ns - frame_.stamp_ns, kPatternDepthOffset_us * 1000);
    EXPECT_GT(frame_.stamp_ns, last_ns);
    last_ns = frame_.stamp_ns;
  }
  EXPECT_EQ(camera_.counters().frames, 10u);
  EXPECT_EQ(camera_.counters().clock_jumps, 0u);
  EXPECT_TRUE(camera_.registered_by_device());
}

TEST_F(VirtualDeviceTest, FieldOfViewServesAsCalibrationWithAWarning) {
  open();
  const plvo::CameraModel model = camera_.model();
  EXPECT_NEAR(model.pinhole.fx, 320 / std::tan(1.0226 / 2), 1e-3);
  EXPECT_NEAR(model.pinhole.fy, 240 / std::tan(0.7959 / 2), 1e-3);
  EXPECT_EQ(model.pinhole.cx, 319.5);
  EXPECT_NE(log_.text.find("guessed from the field of view"), std::string::npos) << log_.text;
}

TEST_F(VirtualDeviceTest, CalibrationOfTheUserIsKeptWithoutAWarning) {
  options_.model = plvo::CameraModel{};
  options_.model->pinhole.fx = 517.3;
  open();
  EXPECT_EQ(camera_.model().pinhole.fx, 517.3);
  EXPECT_EQ(log_.text, "");
  options_.model->width = 320;
  EXPECT_EQ(camera_.open(options_).code(), StatusCode::kInvalidArgument);
}

TEST_F(VirtualDeviceTest, NoFieldOfViewAndNoCalibrationIsRefused) {
  ASSERT_TRUE(device_.command("no_fov 1"));
  EXPECT_EQ(camera_.open(options_).code(), StatusCode::kInvalidArgument);
}

TEST_F(VirtualDeviceTest, ModesAreSetAndUnknownOnesNamed) {
  options_.width = 320;
  options_.height = 240;
  options_.fps = 60;
  open();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(camera_.next(frame_).ok());
  EXPECT_EQ(frame_.colour.width, 320);
  EXPECT_EQ(frame_.depth.height, 240);
  EXPECT_GE(colour_tick(), 0);
  EXPECT_GE(depth_tick(), 0);

  options_.fps = 25;
  const Status status = camera_.open(options_);
  EXPECT_EQ(status.code(), StatusCode::kUnsupported);
  EXPECT_NE(std::string(status.message()).find("640x480@30"), std::string::npos) << status.message();
}

TEST_F(VirtualDeviceTest, TenthsOfAMillimetre) {
  options_.depth_unit = plvo::OpenNi2DepthUnit::kTenthMillimetre;
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  EXPECT_EQ(frame_.depth.metres_per_unit, 0.0001);
  EXPECT_GE(depth_tick(), 0);
  // Not offered at 60 Hz: millimetres then.
  options_.width = 320;
  options_.height = 240;
  options_.fps = 60;
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  EXPECT_EQ(frame_.depth.metres_per_unit, 0.001);
}

TEST_F(VirtualDeviceTest, MirroringThatStaysOnIsUndone) {
  ASSERT_TRUE(device_.command("mirror_stuck 1"));
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  EXPECT_GE(colour_tick(), 0);
  EXPECT_GE(depth_tick(), 0);
}

TEST_F(VirtualDeviceTest, SoftwareRegistersWhereTheDeviceCannot) {
  ASSERT_TRUE(device_.command("registration 0"));
  open();
  EXPECT_FALSE(camera_.registered_by_device());
  EXPECT_NE(log_.text.find("in software"), std::string::npos) << log_.text;
  ASSERT_TRUE(camera_.next(frame_).ok());
  const int tick = colour_tick();
  ASSERT_GE(tick, 0);
  std::vector<std::uint16_t> raw(640 * 480), expected(640 * 480);
  plvo::SoftwareRegistration registration;
  registration.reset(camera_.model().pinhole, camera_.model(), 0.001);
  bool found = false;
  // The colour pattern tells the tick modulo 256, the depth pattern does not repeat with it.
  for (int index = tick; index < 4000 && !found; index += 256) {
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) raw[static_cast<std::size_t>(y * 640 + x)] = pattern_depth(index, x, y);
    }
    registration.warp(raw.data(), expected.data());
    found = std::equal(expected.begin(), expected.end(), frame_.depth.data);
  }
  EXPECT_TRUE(found);
}

TEST_F(VirtualDeviceTest, UnplugAndReplug) {
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  const std::int64_t before_ns = frame_.stamp_ns;
  ASSERT_TRUE(device_.command("unplug"));
  const Clock::time_point start = Clock::now();
  Status status = next_fault();
  EXPECT_EQ(status.code(), StatusCode::kUnplugged) << status.message();
  EXPECT_LT(seconds_since(start), 1.0);
  // Still away: each call waits its time limit and says so.
  const Clock::time_point waiting = Clock::now();
  EXPECT_EQ(camera_.next(frame_).code(), StatusCode::kUnplugged);
  EXPECT_LT(seconds_since(waiting), 2.0);
  // The device's clock starts anew; ours goes on.
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

TEST_F(VirtualDeviceTest, NothingPluggedInSaysSo) {
  ASSERT_TRUE(device_.command("unplug"));
  const Status status = camera_.open(options_);
  EXPECT_EQ(status.code(), StatusCode::kNotFound) << status.message();
}

TEST_F(VirtualDeviceTest, OneStreamStops) {
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  for (const char* stream : {"colour", "depth"}) {
    ASSERT_TRUE(device_.command((std::string("stop ") + stream).c_str()));
    const Clock::time_point start = Clock::now();
    // A call that began before the stop may still have seen both streams: the one after it has not.
    Status status = next_fault();
    status = camera_.next(frame_);
    ASSERT_EQ(status.code(), StatusCode::kTimeout) << status.message();
    EXPECT_NE(std::string(status.message()).find(std::string(stream) + " stream stopped"), std::string::npos)
        << status.message();
    EXPECT_LT(seconds_since(start), 4.0);
    ASSERT_TRUE(device_.command("run"));
    ASSERT_TRUE(next_frame().ok());
    EXPECT_EQ(colour_tick(), depth_tick() % 256);
  }
  EXPECT_GT(camera_.counters().unmatched_colour + camera_.counters().unmatched_depth, 0u);
}

TEST_F(VirtualDeviceTest, StallIsATimeoutAndEnds) {
  // PLVO_STALL_S=30 makes the stall as long as the mission asks; nothing but the waiting differs.
  const char* given = std::getenv("PLVO_STALL_S");
  const double stall_s = given != nullptr ? std::atof(given) : 1.5;
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  ASSERT_TRUE(device_.command("stall"));
  const Clock::time_point start = Clock::now();
  Status status = next_fault();
  int timeouts = 0;
  while (seconds_since(start) < stall_s) {
    const Clock::time_point call = Clock::now();
    status = camera_.next(frame_);
    ASSERT_EQ(status.code(), StatusCode::kTimeout) << status.message();
    ASSERT_LT(seconds_since(call), 2.0);
    ++timeouts;
  }
  EXPECT_GE(timeouts, 1);
  EXPECT_NE(std::string(status.message()).find("no frames"), std::string::npos) << status.message();
  ASSERT_TRUE(device_.command("run"));
  ASSERT_TRUE(next_frame().ok());
  EXPECT_EQ(colour_tick(), depth_tick() % 256);
  EXPECT_GE(camera_.counters().missing, 10u) << "the gap is counted";
}

TEST_F(VirtualDeviceTest, ClockJumpsBack) {
  open();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(camera_.next(frame_).ok());
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
  ASSERT_TRUE(camera_.next(frame_).ok());
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

TEST_F(VirtualDeviceTest, DepthArrivesLate) {
  ASSERT_TRUE(device_.command("late 4"));
  open();
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(camera_.next(frame_).ok());
    EXPECT_EQ(colour_tick(), depth_tick() % 256) << "late depth belongs to the older colour image";
  }
}

TEST_F(VirtualDeviceTest, StampsTooFarApartNeverPair) {
  ASSERT_TRUE(device_.command("shift 12000"));
  options_.pair_tolerance_us = 10000;
  open();
  // Depth is 12 ms after its colour image and 21 ms before the next: neither is within 10 ms.
  const Status status = camera_.next(frame_);
  EXPECT_EQ(status.code(), StatusCode::kTimeout);
  EXPECT_NE(std::string(status.message()).find("apart"), std::string::npos) << status.message();
  EXPECT_GT(camera_.counters().unmatched_depth, 3u);
  EXPECT_EQ(camera_.counters().frames, 0u);
  ASSERT_TRUE(device_.command("shift 9000"));
  EXPECT_TRUE(next_frame().ok());
}

TEST_F(VirtualDeviceTest, PairsByStampNotByFrameIndex) {
  // Depth is stamped nearly a frame late: its partner is the next colour image, of another frame index.
  ASSERT_TRUE(device_.command("shift 30000"));
  open();
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(camera_.next(frame_).ok());
    EXPECT_EQ(colour_tick(), (depth_tick() + 1) % 256);
    EXPECT_EQ(frame_.stamp_ns - frame_.depth_stamp_ns, 3333000);
  }
}

TEST_F(VirtualDeviceTest, CoveredCameraStillDelivers) {
  ASSERT_TRUE(device_.command("dark 1"));
  ASSERT_TRUE(device_.command("zero_depth 1"));
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  for (int i = 0; i < 640 * 480; ++i) {
    ASSERT_EQ(frame_.depth.data[i], 0);
    ASSERT_EQ(frame_.colour.data[3 * i], 0);
  }
}

TEST_F(VirtualDeviceTest, DamagedImageIsSkipped) {
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  ASSERT_TRUE(device_.command("damage 1"));
  const Status status = next_fault();
  EXPECT_EQ(status.code(), StatusCode::kDamaged) << status.message();
  ASSERT_TRUE(camera_.next(frame_).ok());
  EXPECT_EQ(colour_tick(), depth_tick() % 256);
  EXPECT_EQ(camera_.counters().damaged, 1u);
}

TEST_F(VirtualDeviceTest, SlowReaderGetsPairsAndLossIsCounted) {
  open();
  for (int i = 0; i < 6; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    ASSERT_TRUE(camera_.next(frame_).ok());
    EXPECT_EQ(colour_tick(), depth_tick() % 256);
  }
  EXPECT_GT(camera_.counters().dropped_colour, 5u);
  EXPECT_GT(camera_.counters().missing, 5u);
}

TEST_F(VirtualDeviceTest, ImagesStayUntilTheNextCall) {
  open();
  ASSERT_TRUE(camera_.next(frame_).ok());
  const int tick = colour_tick();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(colour_tick(), tick);
  EXPECT_EQ(depth_tick() % 256, tick);
}

TEST_F(VirtualDeviceTest, FramesOfASourceComeExactlyAndEnd) {
  // What the command line test does with simulated frames: none lost, stamps and images as given.
  struct Source {
    int served = 0;
    static void serve(void* cookie, VirtualTick* tick) {
      auto& self = *static_cast<Source*>(cookie);
      if (self.served == 8) {
        tick->end = true;
        return;
      }
      tick->colour_us = 7000000 + 40000 * self.served;
      tick->depth_us = tick->colour_us;
      for (int i = 0; i < tick->width * tick->height; ++i) {
        tick->depth[i] = static_cast<std::uint16_t>(1000 + self.served);
        tick->rgb[3 * i] = tick->rgb[3 * i + 1] = tick->rgb[3 * i + 2] =
            static_cast<std::uint8_t>(self.served);
      }
      ++self.served;
    }
  } source;
  device_.set_source(&Source::serve, &source);
  ASSERT_TRUE(device_.command("after_end unplug"));
  ASSERT_TRUE(device_.command("pace 80000"));  // a busy machine must not lose one
  open();
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(camera_.next(frame_).ok()) << i;
    EXPECT_EQ(frame_.stamp_ns, (7000000 + 40000 * i) * std::int64_t{1000});
    EXPECT_EQ(frame_.depth_stamp_ns, frame_.stamp_ns);
    EXPECT_EQ(frame_.colour.data[3 * 640 * 240], i);
    EXPECT_EQ(frame_.depth.data[640 * 240], 1000 + i);
  }
  EXPECT_EQ(next_fault().code(), StatusCode::kUnplugged);
  camera_.close();
}

}  // namespace
}  // namespace plvo_test

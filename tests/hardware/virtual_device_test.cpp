// SPDX-License-Identifier: Apache-2.0
// OpenNi2Camera with the real OpenNI2 and a virtual device: correct bytes in correct pairs, modes, units,
// mirroring, registration and calibration.
#include <cmath>
#include <thread>
#include <vector>

#include "plvo/openni2/software_registration.hpp"
#include "virtual_device_fixture.hpp"

namespace plvo_test {
namespace {

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
    ASSERT_TRUE(next_frame().ok());
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
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(next_frame().ok());
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
  ASSERT_TRUE(next_frame().ok());
  EXPECT_EQ(frame_.depth.metres_per_unit, 0.0001);
  EXPECT_GE(depth_tick(), 0);
  // This unit is not offered at 60 Hz, so the camera uses millimetres.
  options_.width = 320;
  options_.height = 240;
  options_.fps = 60;
  open();
  ASSERT_TRUE(next_frame().ok());
  EXPECT_EQ(frame_.depth.metres_per_unit, 0.001);
}

TEST_F(VirtualDeviceTest, MirroringThatStaysOnIsUndone) {
  ASSERT_TRUE(device_.command("mirror_stuck 1"));
  open();
  ASSERT_TRUE(next_frame().ok());
  EXPECT_GE(colour_tick(), 0);
  EXPECT_GE(depth_tick(), 0);
}

TEST_F(VirtualDeviceTest, SoftwareRegistersDepthIfTheDeviceCannot) {
  ASSERT_TRUE(device_.command("registration 0"));
  open();
  EXPECT_FALSE(camera_.registered_by_device());
  EXPECT_NE(log_.text.find("in software"), std::string::npos) << log_.text;
  ASSERT_TRUE(next_frame().ok());
  const int tick = colour_tick();
  ASSERT_GE(tick, 0);
  std::vector<std::uint16_t> raw(640 * 480), expected(640 * 480);
  plvo::SoftwareRegistration registration;
  registration.reset(camera_.model().pinhole, camera_.model(), 0.001);
  bool found = false;
  // The colour pattern gives the tick modulo 256; the depth pattern has another period.
  for (int index = tick; index < 4000 && !found; index += 256) {
    for (int y = 0; y < 480; ++y) {
      for (int x = 0; x < 640; ++x) raw[static_cast<std::size_t>(y * 640 + x)] = pattern_depth(index, x, y);
    }
    registration.warp(raw.data(), expected.data());
    found = std::equal(expected.begin(), expected.end(), frame_.depth.data);
  }
  EXPECT_TRUE(found);
}

TEST_F(VirtualDeviceTest, PairsByStampNotByFrameIndex) {
  // Depth is stamped almost one frame late: its partner is the next colour image, which has another frame
  // index.
  ASSERT_TRUE(device_.command("shift 30000"));
  open();
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(next_frame().ok());
    EXPECT_EQ(colour_tick(), (depth_tick() + 1) % 256);
    EXPECT_EQ(frame_.stamp_ns - frame_.depth_stamp_ns, 3333000);
  }
}

TEST_F(VirtualDeviceTest, ImagesStayValidUntilTheNextCall) {
  open();
  ASSERT_TRUE(next_frame().ok());
  const int tick = colour_tick();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(colour_tick(), tick);
  EXPECT_EQ(depth_tick() % 256, tick);
}

TEST_F(VirtualDeviceTest, FramesOfASourceArriveUnchangedUntilTheEnd) {
  // Same set-up as the command line test with simulated frames: no frame is lost, stamps and images are
  // unchanged.
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
  ASSERT_TRUE(device_.command("allow 0"));
  open();
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(device_.command("allow 1"));
    ASSERT_TRUE(next_frame().ok()) << i;
    EXPECT_EQ(frame_.stamp_ns, (7000000 + 40000 * i) * std::int64_t{1000});
    EXPECT_EQ(frame_.depth_stamp_ns, frame_.stamp_ns);
    EXPECT_EQ(frame_.colour.data[3 * 640 * 240], i);
    EXPECT_EQ(frame_.depth.data[640 * 240], 1000 + i);
  }
  ASSERT_TRUE(device_.command("allow 1"));  // lets the source signal the end
  EXPECT_EQ(wait_for(StatusCode::kUnplugged).code(), StatusCode::kUnplugged);
  camera_.close();
}

}  // namespace
}  // namespace plvo_test

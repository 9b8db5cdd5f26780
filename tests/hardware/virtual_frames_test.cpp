// SPDX-License-Identifier: Apache-2.0
// The simulator's frames through the virtual device and the real OpenNI2 equal, byte for byte and stamp for
// stamp, the frames that replay reads from a folder. The environment configures the device, as it does for a
// program under test.
#include "virtual_frames.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "plvo/openni2/openni2_camera.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "virtual_device.hpp"

namespace plvo_test {
namespace {

TEST(VirtualFrames, LiveAndReplayAreTheSameBytes) {
  constexpr int kFrames = 10;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("plvo_virtual_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  plvo::SimulatorOptions simulated;
  simulated.frames = kFrames;
  simulated.camera.width = 320;
  simulated.camera.height = 240;
  simulated.camera.pinhole = {262.5, 262.5, 159.5, 119.5};
  const plvo::Status written = write_virtual_frames(simulated, folder / "raw", folder / "tum");
  ASSERT_TRUE(written.ok()) << written.message();

  plvo::Calibration calibration;
  ASSERT_TRUE(plvo::read_calibration(folder / "tum" / "calibration.txt", calibration).ok());
  plvo::RecordedCamera replay;
  const plvo::Status replayed = replay.open(folder / "tum", calibration);
  ASSERT_TRUE(replayed.ok()) << replayed.message();

  const std::string control = folder / "control";
  ASSERT_EQ(::mkfifo(control.c_str(), 0600), 0);
  ::setenv("PLVO_VIRTUAL_FRAMES", (folder / "raw").c_str(), 1);
  ::setenv("PLVO_VIRTUAL_START", "allow 0;after_end unplug", 1);
  ::setenv("PLVO_VIRTUAL_CONTROL", control.c_str(), 1);
  plvo::OpenNi2Options options;
  options.width = 320;
  options.height = 240;
  options.timeout_ms = 5000;
  options.model = replay.model();
  plvo::OpenNi2Camera live;
  const plvo::Status opened = live.open(options);
  ASSERT_TRUE(opened.ok()) << opened.message();
  VirtualDevice device;
  ASSERT_TRUE(device.find());
  plvo::RgbdFrame a, b;
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(device.command("allow 1"));
    ASSERT_TRUE(live.next(a).ok()) << i;
    ASSERT_TRUE(replay.next(b).ok()) << i;
    ASSERT_EQ(a.stamp_ns, b.stamp_ns);
    ASSERT_EQ(a.depth_stamp_ns, b.depth_stamp_ns);
    ASSERT_EQ(a.depth.metres_per_unit, b.depth.metres_per_unit);
    ASSERT_EQ(a.colour.format, plvo::PixelFormat::kRgb8);
    ASSERT_EQ(b.colour.format, plvo::PixelFormat::kRgb8);
    for (int y = 0; y < 240; ++y) {
      ASSERT_EQ(std::memcmp(a.colour.data + y * a.colour.stride_bytes,
                            b.colour.data + y * b.colour.stride_bytes, 960),
                0);
      ASSERT_EQ(std::memcmp(a.depth.data + y * a.depth.stride, b.depth.data + y * b.depth.stride, 640), 0);
    }
  }
  EXPECT_EQ(replay.next(b).code(), plvo::StatusCode::kEndOfStream);
  ASSERT_TRUE(device.command("allow 1"));  // lets the source signal the end
  EXPECT_EQ(live.next(a).code(), plvo::StatusCode::kUnplugged);
  // Commands through the pipe: the device is plugged in again, but has no more frames.
  std::ofstream(control) << "plug" << std::endl;
  plvo::Status status = live.next(a);
  for (int i = 0; i < 20 && status.code() == plvo::StatusCode::kUnplugged && live.counters().replugged == 0;
       ++i) {
    status = live.next(a);
  }
  EXPECT_GE(live.counters().replugged, 1u) << status.message();
  live.close();
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace plvo_test

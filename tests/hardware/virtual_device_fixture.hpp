// SPDX-License-Identifier: Apache-2.0
// A camera, a log and the controls of the virtual device, for the tests of this folder.
#pragma once

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "plvo/openni2/openni2_camera.hpp"
#include "virtual_device.hpp"

namespace plvo_test {

using plvo::OpenNi2Camera;
using plvo::OpenNi2Options;
using plvo::RgbdFrame;
using plvo::Status;
using plvo::StatusCode;
using Clock = std::chrono::steady_clock;

struct Messages final : plvo::Log {
  void write(plvo::LogLevel /*level*/, std::string_view message) override {
    text.append(message).append("\n");
  }
  std::string text;
};

// Time limit of a wait. It detects a hang; it does not judge speed.
inline constexpr double kPatience_s = 120;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

inline bool says(const Status& status, const std::string& words) {
  return std::string(status.message()).find(words) != std::string::npos;
}

class VirtualDeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(openni::OpenNI::initialize(), openni::STATUS_OK) << openni::OpenNI::getExtendedError();
    // OpenNI2 unloads its drivers when the last user leaves; a leak checker at exit could not resolve their
    // symbols.
    for (const char* driver : {"libOniFile.so.0", "libPlvoVirtual.so.0"}) {
      void* kept = dlopen(driver, RTLD_NOLOAD | RTLD_NODELETE | RTLD_NOW);
      if (kept != nullptr) dlclose(kept);
    }
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
  // Returns the next frame after any number of timeouts (within kPatience_s).
  Status next_frame() {
    const Clock::time_point start = Clock::now();
    Status status = camera_.next(frame_);
    while (!status.ok() && seconds_since(start) < kPatience_s) status = camera_.next(frame_);
    return status;
  }
  // Repeats the call until the camera returns this code (for kPatience_s at most); returns the last status.
  Status wait_for(StatusCode code) {
    const Clock::time_point start = Clock::now();
    Status status = camera_.next(frame_);
    while (status.code() != code && seconds_since(start) < kPatience_s) status = camera_.next(frame_);
    return status;
  }
  // The tick of the pattern in the colour image, from its first pixel (modulo 256); all pixels must match.
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

}  // namespace plvo_test

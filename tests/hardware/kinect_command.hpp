// SPDX-License-Identifier: Apache-2.0
// Runs the command line as a function in the process of the simulated Kinect, which shows a scene.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "plvo/cli/command_line.hpp"
#include "plvo/simulator/simulated_camera.hpp"
#include "simulated_kinect.hpp"
#include "temporary_folder.hpp"

namespace plvo_test {

using plvo::test::read_file;

// Returns the 11-bit disparity that libfreenect converts to this depth, with the simulated Kinect's zero
// plane (7.5 cm, 120 cm, 0.1042 mm) and shift (200). This is the inverse of its raw-to-millimetres formula.
inline std::uint16_t disparity_of(double depth_m) {
  if (!(depth_m > 0.4)) return 2047;
  const double cm = depth_m * 100;
  const double metric = 7.5 * (cm - 120) / cm;
  const double raw = 4 * (metric / 0.1042 + 0.375) + 800;
  return raw > 0 && raw < 2047 ? static_cast<std::uint16_t>(std::lround(raw)) : std::uint16_t{2047};
}

class KinectCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // Runs one line of the command line, as a shell would; out_ and err_ hold its output.
  int plvo(std::vector<std::string> words) {
    words.insert(words.begin(), "plvo");
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = plvo::cli::run_command_line(static_cast<int>(arguments.size()), arguments.data());
    std::fflush(nullptr);
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return code;
  }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(read_file(path(name))); }

  // A sequence of a few frames as a Kinect would observe it, played forwards and backwards: 0 1 2 1 0 1 2 1 …
  void show_a_room() {
    plvo::SimulatorOptions options;
    options.frames = 3;
    std::unique_ptr<plvo::SimulatedCamera> camera;
    ASSERT_TRUE(plvo::SimulatedCamera::create(options, camera).ok());
    std::vector<std::uint16_t> disparities(SimulatedKinect::kPictures * SimulatedKinect::kPixels);
    std::vector<std::uint8_t> mosaics(disparities.size());
    plvo::RgbdFrame frame;
    for (const std::vector<int>& places : {std::vector<int>{0}, {1, 3}, {2}}) {
      ASSERT_TRUE(camera->next(frame).ok());
      const bool bgr = frame.colour.format == plvo::PixelFormat::kBgr8;
      for (int y = 0; y < SimulatedKinect::kHeight; ++y) {
        for (int x = 0; x < SimulatedKinect::kWidth; ++x) {
          int channel = (x + y) % 2 == 0 ? 1 : y % 2 == 0 ? 0 : 2;  // GR over BG
          if (bgr) channel = 2 - channel;
          const double depth_m = frame.depth.data[y * frame.depth.stride + x] * frame.depth.metres_per_unit;
          for (const int place : places) {
            const std::size_t at = static_cast<std::size_t>(place) * SimulatedKinect::kPixels +
                                   static_cast<std::size_t>(y * SimulatedKinect::kWidth + x);
            mosaics[at] = frame.colour.data[y * frame.colour.stride_bytes + 3 * x + channel];
            disparities[at] = disparity_of(depth_m);
          }
        }
      }
    }
    kinect_.set_pictures(disparities, mosaics);
  }

  plvo::test::TemporaryFolder folder_;
  SimulatedKinect kinect_;
  std::string out_, err_;
};

}  // namespace plvo_test

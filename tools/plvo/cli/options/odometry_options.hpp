// SPDX-License-Identifier: Apache-2.0
// How the odometry is set, and the memory it lives in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/cli/common/frame_record.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/thread_pair.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo::cli {

enum class Preset : std::uint8_t { kDefault, kPaper, kTiny };

struct OdometryOptions {
  Preset preset = Preset::kDefault;
  std::optional<Features> features;
  std::optional<ReferencePolicy> reference;
  std::optional<std::uint64_t> seed;
  double budget_ms = 0;  // 0: none
  int cores = 1;
  bool level_world = false;
  std::optional<int> surfaces;
  std::string mask;  // a file; empty: none
};
void add_odometry_options(CLI::App& command, OdometryOptions& options);
// Ends the command when they contradict each other.
void check_odometry_options(const OdometryOptions& options);

// An odometry with the block it needs, and the second thread that it was asked for. Every page of the block
// is touched, so that memory does not seem to grow later.
class OdometryBlock {
 public:
  // scaled_down_by: factor between the images of the recording and those of the camera.
  Status init(const CameraModel& camera, const OdometryOptions& options, int scaled_down_by = 1);
  // Tracks, notes what came of it and what it took, and tells the budget.
  // imu: nullptr without one; with one, the rotation of wheels counts where the gyro tells none.
  void track(const RgbdFrame& frame, ImuIntegrator* imu, const MotionPrior& wheels, FrameRecord& record);
  Odometry& odometry() { return odometry_; }
  const Config& config() const { return config_; }

 private:
  std::int64_t cpu_ns() const;

  Config config_;
  std::vector<std::byte> memory_;
  std::vector<std::uint8_t> used_pixels_;  // Config::mask
  std::unique_ptr<ThreadPair> pair_;
  Odometry odometry_;
};

}  // namespace plvo::cli

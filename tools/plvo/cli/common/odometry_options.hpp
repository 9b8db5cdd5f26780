// SPDX-License-Identifier: Apache-2.0
// How the odometry is set, and the memory it lives in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "plvo/cli/common/arguments.hpp"
#include "plvo/odometry/odometry.hpp"

namespace plvo::cli {

enum class Preset : std::uint8_t { kDefault, kPaper, kTiny };

struct OdometryOptions {
  Preset preset = Preset::kDefault;
  std::optional<Features> features;
  std::optional<ReferencePolicy> reference;
  std::optional<std::uint64_t> seed;
  double budget_ms = 0;  // 0: none
};
void add_odometry_options(CLI::App& command, OdometryOptions& options);

// The preset, then what was asked for beside it.
Config make_config(const OdometryOptions& options);
Limits make_limits(const OdometryOptions& options, const CameraModel& camera);

// An odometry with the block it needs. Every page of the block is touched, so that memory does not seem
// to grow later.
class OdometryBlock {
 public:
  Status init(const CameraModel& camera, const Config& config, const Limits& limits);
  Odometry& odometry() { return odometry_; }

 private:
  std::vector<std::byte> memory_;
  Odometry odometry_;
};

}  // namespace plvo::cli

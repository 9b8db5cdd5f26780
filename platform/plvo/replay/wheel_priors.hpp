// SPDX-License-Identifier: Apache-2.0
// Makes the samples of wheels the priors of the frames (plvo/motion/wheel_prior.hpp), of a recording or as
// they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "plvo/motion/motion_prior.hpp"
#include "plvo/replay/wheel_files.hpp"

namespace plvo {

// How far off the twist is, as standard deviations. For samples that have their own, the first four are not
// used.
struct WheelConfig {
  Se3 T_base_camera;

  double share = 0.05;   // of the speed, and of the turn rate: slip, and the size of the wheels
  double track_m = 0.5;  // between the wheels: that share of the speed on one side is a turn
  double least_mps = 0.005, least_rps = 0.01;  // at rest
  double bounce_mps = 0.02, tilt_rps = 0.05;   // what wheels do not measure: vz; ωx, ωy
  double error_s = 0.5;                        // how long an error lasts (wheel_prior.hpp)
  double longest_gap_s = 0.25;                 // between samples; over a longer one there is no prior

  // For wheels that are read live: if later samples have not arrived yet, the last velocity is taken to go on
  // for this long. Its uncertainty grows by these accelerations, times that time.
  double hold_s = 0;
  double acceleration_mps2 = 1, acceleration_rps2 = 2;

  // Returns kInvalidArgument, naming the entry and its range.
  Status validate() const;
};

class WheelPriors {
 public:
  static constexpr std::size_t kMostSamples = std::size_t{1} << 16;  // of add(): twenty minutes of 50 Hz

  // Returns the error of WheelConfig::validate.
  Status init(WheelRecording recording, const WheelConfig& config);

  // Another sample. Returns false, and leaves it out, if it is not later than the one before or not finite.
  // Beyond kMostSamples the oldest are forgotten.
  bool add(const WheelSample& sample);
  // The stamp of the last sample; nothing without one.
  std::optional<std::int64_t> last_ns() const;

  // Prior of the frame at this stamp, since the frame of the previous call. Velocities are linear between
  // samples. It is empty at the first call, where samples are missing, and where wheel_prior.hpp refuses the
  // motion.
  MotionPrior prior(std::int64_t stamp_ns);

  std::size_t priors() const { return priors_; }  // that were not empty

 private:
  MotionPrior prior_between(std::int64_t from_ns, std::int64_t to_ns);
  Matrix6 covariance_between(const WheelSample& a, const WheelSample& b, const Vector3& velocity) const;
  bool covers(std::size_t first, std::int64_t from_ns, std::int64_t to_ns) const;

  std::vector<WheelSample> samples_;
  std::optional<double> held_s_;  // the last sample is no sample, but the one before so much later
  WheelConfig config_;
  std::size_t next_ = 0;  // no sample before it is needed any more
  std::size_t priors_ = 0;
  std::optional<std::int64_t> before_ns_;
};

}  // namespace plvo

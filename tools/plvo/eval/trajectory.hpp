// SPDX-License-Identifier: Apache-2.0
// Samples the ground truth at the stamps of an estimate.
#pragma once

#include <cstdint>
#include <vector>

#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

using plvo::read_trajectory;
using plvo::StampedPose;
using plvo::Trajectory;
using plvo::TrajectoryFormat;
using plvo::TrajectorySource;

enum class GroundTruthSampling : std::uint8_t {
  kNearest,       // the pose of the nearest stamp, as TUM's scripts do
  kInterpolated,  // between the two neighbours, at most 0.1 s apart: linear, slerp
};

struct TruthSampling {
  GroundTruthSampling method = GroundTruthSampling::kInterpolated;
  std::int64_t max_difference_ns = 20'000'000;  // nearest: between a pose and its true pose
};

// The true pose at each stamp. valid[i] is false if there is none within max_difference_ns (nearest) or
// between sufficiently close neighbours (interpolated).
struct SampledPoses {
  std::vector<Se3> poses;
  std::vector<bool> valid;
};
SampledPoses sample(const Trajectory& ground_truth, const std::vector<std::int64_t>& stamps_ns,
                    const TruthSampling& sampling);

// Returns the path length up to each pose, in metres.
std::vector<double> path_lengths(const std::vector<Se3>& poses);

}  // namespace plvo::eval

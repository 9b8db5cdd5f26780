// SPDX-License-Identifier: Apache-2.0
// Motion capture follows markers, not the camera: its frame may be turned against the camera's, and its clock
// may be off. Both are constant, and every estimate is charged with them. They are found from an estimate, by
// least squares over its motions from each pose to the one a second later: four numbers, which flatter that
// estimate.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/eval/trajectory.hpp"

namespace plvo::eval {

// The true pose for a stamp t of the estimate is T_world_camera(t + clock_s) · (Exp(rotation_rad), 0), of the
// truth as it was measured: rotation_rad turns the camera as the truth has it into the real one, in its own
// axes, and clock_s > 0 means that the truth's stamps are late.
struct TruthFit {
  Vector3 rotation_rad = Vector3::Zero();
  Vector3 rotation_sigma_rad = Vector3::Zero();  // standard deviations
  double clock_s = 0;
  double clock_sigma_s = 0;
  std::size_t motions = 0;      // over a second
  std::size_t independent = 0;  // how many of them share no stretch: the standard deviations are for these
};

// Squares of translation and of rotation each count in units of their mean before the fit, so that neither
// metres nor radians decide alone. The truth is interpolated. offset_ns: added to the stamps of the estimate.
// kInvalidArgument for too few motions with ground truth, for motions that do not say what is asked of them,
// and for clocks that are further apart than 0.1 s.
Status fit_truth(const Trajectory& ground_truth, const Trajectory& estimate, std::int64_t offset_ns,
                 TruthFit& fit);

// The truth as the fit has it: poses turned, stamps shifted.
Trajectory corrected(const Trajectory& ground_truth, const TruthFit& fit);

}  // namespace plvo::eval

// SPDX-License-Identifier: Apache-2.0
// Motion capture follows markers, not the camera: its frame may be rotated against the camera's, and its
// clock may be offset. Both errors are constant and affect every estimate. They are fitted by least squares
// to the motions of an estimate from each pose to the one a second later. These four parameters favour that
// estimate.
#pragma once

#include <cstdint>

#include "plvo/base/status.hpp"
#include "plvo/eval/trajectory.hpp"

namespace plvo::eval {

// The true pose at stamp t of the estimate is T_world_camera(t + clock_s) · (Exp(rotation_rad), 0), where
// T_world_camera is the truth as measured. rotation_rad rotates the camera of the truth into the real one, in
// its own axes; clock_s > 0 means that the truth's stamps are late.
struct TruthFit {
  Vector3 rotation_rad = Vector3::Zero();
  Vector3 rotation_sigma_rad = Vector3::Zero();  // standard deviations
  double clock_s = 0;
  double clock_sigma_s = 0;
  std::size_t motions = 0;  // over a second
  std::size_t independent =
      0;  // number of them that do not overlap; the standard deviations assume this number
};

// The squares of translation and rotation are each divided by their mean before the fit, so that neither
// metres nor radians dominate. The truth is interpolated. offset_ns: added to the stamps of the estimate.
// Returns kInvalidArgument for too few motions with ground truth, for motions that do not determine the
// parameters, and for clocks that differ by more than 0.1 s.
Status fit_truth(const Trajectory& ground_truth, const Trajectory& estimate, std::int64_t offset_ns,
                 TruthFit& fit);

// Returns the corrected truth: poses rotated, stamps shifted.
Trajectory corrected(const Trajectory& ground_truth, const TruthFit& fit);

}  // namespace plvo::eval

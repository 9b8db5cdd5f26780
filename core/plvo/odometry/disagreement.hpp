// SPDX-License-Identifier: Apache-2.0
// The factor on the covariance of the motion where points, lines and surfaces have contradicted each other of
// late. They then cannot all show the motion of the camera. The estimate is a compromise, and its covariance,
// (Σ H)⁻¹, is too small.
//
// What makes a kind disagree is the same from frame to frame. So the shift S_k that it demands
// (PoseWithCovariance::shifts) is added up over the last half second, and so is the noise N of the motions:
//
//   S_k ← κ A S_k + ΔS_k,   N ← κ² A N Aᵀ + B C Bᵀ,   κ = τ / (τ + Δt),
//
// with the derivatives A and B of advance(). If noise alone shifted the K kinds, their squared
// distances K S_kᵀ N⁻¹ S_k (a shift is divided by √K) would be 6 K in sum. What is beyond that, divided by
// six, is the variance of the compromise relative to the noise, as in the method of moments of DerSimonian
// and Laird ("Meta-analysis in clinical trials", Controlled Clinical Trials 7, 1986):
//
//   factor = 1 + (K Σ S_kᵀ N⁻¹ S_k − 6 K) / 6, at least 1.
//
// N is the noise of the compromise, not that of the kind alone, which would excuse a kind that measures
// little.
#pragma once

#include "plvo/odometry/window/pose_with_covariance.hpp"

namespace plvo {

class Disagreement {
 public:
  // Notes a frame that was tracked, elapsed_s after the last one, in the same world. pose: advance() of an
  // earlier pose by T_current_from, whose ⊞-perturbation has the covariance C.
  void note(const PoseWithCovariance& last, const PoseWithCovariance& pose, const Se3& T_current_from,
            const Matrix6& C, double elapsed_s);
  // The factor, at least 1.
  double inflation() const { return inflation_; }

 private:
  OfEachKind shifts_ = OfEachKind::Zero();
  Matrix6 noise_ = Matrix6::Zero();
  double inflation_ = 1;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// The factor on the covariance of the motion where points, lines, surfaces and priors have contradicted each
// other of late (MotionProblem::disagreement). They then cannot all show the motion of the camera, and the
// estimate is a compromise whose covariance, (Σ H)⁻¹, is too small.
//
// If the covariances are true, Q is χ² with six degrees of freedom for two kinds of measurements. Its mean
// over a few frames is Q̄. The excess Q̄ / 6 − 1 is the variance of the compromise beyond the noise, relative
// to the noise (the square of Birge's ratio, less one: R. T. Birge, "The calculation of errors by the method
// of least squares", Phys. Rev. 40, 1932). The noise of a frame is independent of the next one's. The
// compromise is the same in frame after frame: over n frames its variance grows by n², n times as fast. n is
// a second's.
#pragma once

namespace plvo {

class Disagreement {
 public:
  // Notes Q of a frame that was tracked.
  void note(double q) {
    const double bounded = q < kMost ? q : kMost;  // also if q is not a number
    mean_ += kRate * (bounded - mean_);
  }
  // The factor, at least 1.
  double inflation() const { return mean_ > kExpected ? 1 + kFrames * (mean_ / kExpected - 1) : 1; }

 private:
  static constexpr double kExpected = 6;
  static constexpr double kFrames = 30;
  static constexpr double kRate = 0.2;  // Q̄ is over about five frames
  static constexpr double kMost = 100;  // bound on the influence of one frame

  double mean_ = 0;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/parallax_check.hpp"

namespace plvo {
namespace {

constexpr double kParallaxMemory_s = 1;       // τ
constexpr double kErrorOfCalibration = 0.03;  // σ
constexpr double kSigmas = 2.5;

}  // namespace

void ParallaxCheck::note(const DepthShift& shift, double elapsed_s) {
  const double kept = kParallaxMemory_s / (kParallaxMemory_s + elapsed_s);
  product_ = kept * product_ + shift.information * shift.z * shift.t_z;
  square_ = kept * square_ + shift.information * shift.t_z * shift.t_z;
  constexpr double kVariance = kErrorOfCalibration * kErrorOfCalibration;
  fails_ =
      product_ > 0 && product_ * product_ > kSigmas * kSigmas * (square_ + kVariance * square_ * square_);
}

}  // namespace plvo

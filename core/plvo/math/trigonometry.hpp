// SPDX-License-Identifier: Apache-2.0
// sin, cos, atan2, acos, log and exp from + − × ÷ and sqrt alone. Unlike those of the C library, their
// results are bit-identical on all machines. They are accurate to a few units in the last place over the
// stated ranges.
#pragma once

namespace plvo {

double sin(double radians);        // |radians| ≤ 1e6
double cos(double radians);        // |radians| ≤ 1e6
double atan2(double y, double x);  // (−π, π]; atan2(0, 0) = 0
double acos(double x);             // clamps x to [−1, 1]
double exp(double x);              // 0 below −745, +inf above 709
double log(double x);              // x ≥ 0; −inf at 0
// IEEE 754 requires sqrt to be correctly rounded, and most processors have an instruction for it.
inline double sqrt(double x) { return __builtin_sqrt(x); }
constexpr double kPi = 3.141592653589793238462643383279502884;

}  // namespace plvo

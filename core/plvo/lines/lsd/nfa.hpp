// SPDX-License-Identifier: Apache-2.0
// The a-contrario test (LSD, section 2.5). In an image of noise, where directions are independent and
// uniform, the probability that a rectangle of n pixels has k or more aligned ones is a binomial tail.
// Multiplied by the number of possible rectangles, (width · height)^(5/2), it is the expected number of false
// alarms. A rectangle is a segment if this number is at most 1. There is no threshold on the gradient, so the
// illumination may change. One precision is used, p = 1/8; the paper uses eleven.
#pragma once

#include <array>
#include <cstddef>

namespace plvo::lsd {

class FalseAlarms {
 public:
  // Size of the image, in pixels.
  FalseAlarms(int width, int height);

  // −log10 of the number of false alarms for k aligned pixels among n. The tail is summed to one part in a
  // thousand and rounded up. If k ≤ n p, it is taken as 1.
  double meaningfulness(int n, int k) const;

 private:
  static constexpr std::size_t kTable = 256;

  double log_factorial(int n) const;

  double log10_tests_ = 0;
  std::array<double, kTable> log_factorials_{};
};

}  // namespace plvo::lsd

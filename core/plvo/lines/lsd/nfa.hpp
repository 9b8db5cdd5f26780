// SPDX-License-Identifier: Apache-2.0
// The a-contrario test (LSD, section 2.5). In an image of noise, where directions are independent and
// uniform, a rectangle of n pixels holds k or more aligned ones with the probability of a binomial tail;
// times the number of rectangles that could be tried, (width · height)^(5/2), that is the number of false
// alarms to expect. A segment is what makes it at most 1: no level of gradient decides, so the light may
// change. One precision is tried, p = 1/8, where the paper tries eleven.
#pragma once

#include <array>
#include <cstddef>

namespace plvo::lsd {

class FalseAlarms {
 public:
  // Of the image, in pixels.
  FalseAlarms(int width, int height);

  // −log10 of the number of false alarms of k aligned pixels among n. The tail is summed to one part in a
  // thousand and rounded up; where k ≤ n p it is taken as 1.
  double meaningfulness(int n, int k) const;

 private:
  static constexpr std::size_t kTable = 256;

  double log_factorial(int n) const;

  double log10_tests_ = 0;
  std::array<double, kTable> log_factorials_{};
};

}  // namespace plvo::lsd

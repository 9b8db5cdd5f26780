// SPDX-License-Identifier: Apache-2.0
#include "plvo/calibrate/stamp_jitter.hpp"

#include <algorithm>
#include <cmath>

namespace plvo::calibrate {
namespace {

// A line fitted to fewer stamps absorbs too much of their error.
constexpr std::size_t kLeastFrames = 20;
// Upper limit of the jitter, as a fraction of the frame period: with more, a stamp could belong to the next
// frame.
constexpr double kMostOfPeriod = 0.25;

struct Residuals {
  double squares = 0;
  double freedom = 0;  // number of stamps minus the two parameters of their line
  double period_s = 0;
};

// Fits a line to the pairs (frame number, stamp) of one recording and returns the residuals.
Residuals about_line(std::span<const TrackedFrame> frames) {
  const auto seconds_since = [&](std::size_t i, std::size_t from) {
    return static_cast<double>(frames[i].stamp_ns - frames[from].stamp_ns) * 1e-9;
  };
  std::vector<double> steps;
  for (std::size_t i = 1; i < frames.size(); ++i) steps.push_back(seconds_since(i, i - 1));
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  Residuals residuals;
  residuals.period_s = *middle;
  if (!(residuals.period_s > 0)) return {};
  const auto n = static_cast<double>(frames.size());
  double number = 0, mean_number = 0, mean_s = 0;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i > 0) number += std::max(1.0, std::round(seconds_since(i, i - 1) / residuals.period_s));
    numbers.push_back(number);
    mean_number += number / n;
    mean_s += seconds_since(i, 0) / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double x = numbers[i] - mean_number, y = seconds_since(i, 0) - mean_s;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  residuals.squares = std::max(0.0, yy - xy * xy / xx);
  residuals.freedom = n - 2;
  return residuals;
}

}  // namespace

double stamp_jitter_s(std::span<const TrackedRecording> recordings) {
  double squares = 0, freedom = 0, period_s = 0;
  for (const TrackedRecording& recording : recordings) {
    if (recording.frames.size() < kLeastFrames) continue;
    const Residuals residuals = about_line(recording.frames);
    squares += residuals.squares;
    freedom += residuals.freedom;
    period_s = period_s > 0 ? std::min(period_s, residuals.period_s) : residuals.period_s;
  }
  const double jitter_s = freedom > 0 ? std::sqrt(squares / freedom) : 0;
  return freedom > 0 && jitter_s < kMostOfPeriod * period_s ? jitter_s : -1;
}

}  // namespace plvo::calibrate

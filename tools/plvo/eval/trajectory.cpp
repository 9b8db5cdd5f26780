// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace plvo::eval {
namespace {

constexpr std::int64_t kMaxInterpolationGapNs = 100'000'000;
constexpr std::int64_t kSameStampNs = 1'000;  // a sample closer than this is used without a neighbour

// Interpolation uses seconds since 1970 as doubles, as every script of the benchmark does. This rounds stamps
// to 0.2 µs, and the results agree with those scripts to the last printed digit.
double seconds(std::int64_t stamp_ns) {
  return static_cast<double>(static_cast<long double>(stamp_ns) / 1e9L);
}

// Spherical linear interpolation of two unit quaternions, along the shorter arc.
Quaternion slerp(const Quaternion& a, Quaternion b, double fraction) {
  double cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  if (cosine < 0) {
    b = {-b.x, -b.y, -b.z, -b.w};
    cosine = -cosine;
  }
  const double angle = std::acos(std::min(cosine, 1.0));
  const double sine = std::sin(angle);
  const bool small = sine < 1e-8;
  const double from = small ? 1 - fraction : std::sin((1 - fraction) * angle) / sine;
  const double to = small ? fraction : std::sin(fraction * angle) / sine;
  return {from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z, from * a.w + to * b.w};
}

}  // namespace

SampledPoses sample(const Trajectory& ground_truth, const std::vector<std::int64_t>& stamps_ns,
                    const TruthSampling& sampling) {
  const auto& truth = ground_truth.poses;
  SampledPoses result;
  for (std::int64_t stamp : stamps_ns) {
    const auto after = std::lower_bound(truth.begin(), truth.end(), stamp,
                                        [](const StampedPose& p, std::int64_t t) { return p.stamp_ns < t; });
    const auto last = static_cast<std::ptrdiff_t>(truth.size()) - 1;
    const std::ptrdiff_t j =
        std::clamp<std::ptrdiff_t>(after - truth.begin(), std::min<std::ptrdiff_t>(1, last), last);
    const StampedPose& a = truth[static_cast<std::size_t>(std::max<std::ptrdiff_t>(j - 1, 0))];
    const StampedPose& b = truth[static_cast<std::size_t>(j)];
    const std::int64_t to_a = std::abs(a.stamp_ns - stamp);
    const std::int64_t to_b = std::abs(b.stamp_ns - stamp);
    if (sampling.method == GroundTruthSampling::kNearest || a.stamp_ns == b.stamp_ns) {
      result.poses.push_back(to_a <= to_b ? a.T_world_camera : b.T_world_camera);
      result.valid.push_back(std::min(to_a, to_b) <= sampling.max_difference_ns);
      continue;
    }
    const double fraction = std::clamp(
        (seconds(stamp) - seconds(a.stamp_ns)) / (seconds(b.stamp_ns) - seconds(a.stamp_ns)), 0.0, 1.0);
    const bool between = a.stamp_ns <= stamp && stamp <= b.stamp_ns;
    const bool close = b.stamp_ns - a.stamp_ns <= kMaxInterpolationGapNs;
    result.poses.push_back(
        {to_rotation(slerp(to_quaternion(a.T_world_camera.R), to_quaternion(b.T_world_camera.R), fraction)),
         a.T_world_camera.t * (1 - fraction) + b.T_world_camera.t * fraction});
    result.valid.push_back((between && close) || std::min(to_a, to_b) < kSameStampNs);
  }
  return result;
}

std::vector<double> path_lengths(const std::vector<Se3>& poses) {
  std::vector<double> lengths(poses.size(), 0);
  for (std::size_t i = 1; i < poses.size(); ++i)
    lengths[i] = lengths[i - 1] + (poses[i].t - poses[i - 1].t).norm();
  return lengths;
}

}  // namespace plvo::eval

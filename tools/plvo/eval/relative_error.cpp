// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/relative_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "plvo/eval/trajectory.hpp"
#include "plvo/host/number_text.hpp"

namespace plvo::eval {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

constexpr double kDegreesPerRadian = 57.295779513082320877;
constexpr std::int64_t kSecondsToleranceNs = 50'000'000;

std::vector<Pair> pairs_by_frames(std::size_t count, std::size_t step) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i + step < count; ++i) pairs.emplace_back(i, i + step);
  return pairs;
}

std::vector<Pair> pairs_by_metres(const std::vector<Se3>& truth, double length_m) {
  const std::vector<double> lengths = path_lengths(truth);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const auto reached = std::lower_bound(lengths.begin(), lengths.end(), lengths[i] + length_m);
    if (reached != lengths.end()) pairs.emplace_back(i, static_cast<std::size_t>(reached - lengths.begin()));
  }
  return pairs;
}

std::vector<Pair> choose_pairs(const PairedPoses& poses, const RpeDelta& delta) {
  switch (delta.unit) {
    case RpeDelta::Unit::kFrames:
      return pairs_by_frames(poses.truth.size(), static_cast<std::size_t>(delta.amount));
    case RpeDelta::Unit::kSeconds: return pairs_by_seconds(poses.stamps_ns, std::llround(delta.amount * 1e9));
    case RpeDelta::Unit::kMetres: return pairs_by_metres(poses.truth, delta.amount);
  }
  return {};
}

}  // namespace

std::vector<Pair> pairs_by_seconds(const std::vector<std::int64_t>& stamps_ns, std::int64_t delta_ns) {
  std::vector<Pair> pairs;
  if (stamps_ns.size() < 2) return pairs;
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    const std::int64_t target = stamps_ns[i] + delta_ns;
    const auto after = static_cast<std::size_t>(std::lower_bound(stamps_ns.begin(), stamps_ns.end(), target) -
                                                stamps_ns.begin());
    // As in the benchmark's script, j is at least 1.
    std::size_t j = std::clamp<std::size_t>(after, 1, stamps_ns.size() - 1);
    if (std::abs(stamps_ns[j - 1] - target) <= std::abs(stamps_ns[j] - target)) --j;
    if (std::abs(stamps_ns[j] - target) <= kSecondsToleranceNs) pairs.emplace_back(i, j);
  }
  return pairs;
}

std::size_t count_apart(const std::vector<Pair>& pairs) {
  std::size_t count = 0, counted_to = 0;
  for (const auto& [from, to] : pairs) {
    if (from < counted_to) continue;
    ++count;
    counted_to = to;
  }
  return count;
}

Se3 motion_error(const PairedPoses& poses, std::size_t i, std::size_t j) {
  const Se3 true_motion = poses.truth[i].inverse() * poses.truth[j];
  return true_motion.inverse() * (poses.estimate[i].inverse() * poses.estimate[j]);
}

bool parse_rpe_delta(std::string_view text, RpeDelta& delta) {
  if (text.size() < 2) return false;
  RpeDelta result;
  result.text = text;
  const char unit = text.back();
  if (unit != 'f' && unit != 's' && unit != 'm') return false;
  result.unit = unit == 'f'   ? RpeDelta::Unit::kFrames
                : unit == 's' ? RpeDelta::Unit::kSeconds
                              : RpeDelta::Unit::kMetres;
  text.remove_suffix(1);
  if (!parse_whole_text(text, result.amount) || !(result.amount > 0) || result.amount > 1e6) return false;
  if (unit == 'f' && result.amount != std::floor(result.amount)) return false;
  delta = result;
  return true;
}

double rotation_angle_deg(const Matrix3& R) {
  const Vector3 v(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(v.norm() / 2, (R.trace() - 1) / 2) * kDegreesPerRadian;
}

RpeResult relative_pose_error(const PairedPoses& poses, const RpeDelta& delta) {
  std::vector<double> translation, rotation, still_translation, still_rotation;
  for (const auto& [i, j] : choose_pairs(poses, delta)) {
    const Se3 true_motion = poses.truth[i].inverse() * poses.truth[j];
    const Se3 error = motion_error(poses, i, j);
    translation.push_back(error.t.norm());
    rotation.push_back(rotation_angle_deg(error.R));
    still_translation.push_back(true_motion.t.norm());
    still_rotation.push_back(rotation_angle_deg(true_motion.R));
  }
  return {delta,
          {statistics(std::move(translation)), statistics(std::move(rotation))},
          {statistics(std::move(still_translation)), statistics(std::move(still_rotation))}};
}

EndDrift end_drift(const PairedPoses& poses) {
  if (poses.truth.empty()) return {};
  const Se3 error = motion_error(poses, 0, poses.truth.size() - 1);
  return {error.t.norm(), rotation_angle_deg(error.R)};
}

EndDrift identity_end_drift(const PairedPoses& poses) {
  if (poses.truth.empty()) return {};
  const Se3 true_motion = poses.truth.front().inverse() * poses.truth.back();
  return {true_motion.t.norm(), rotation_angle_deg(true_motion.R)};
}

std::vector<DistanceError> distance_errors(const PairedPoses& poses) {
  std::vector<DistanceError> result;
  for (double decade : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    for (double factor : {1.0, 2.0, 5.0}) {
      const double length_m = decade * factor;
      std::vector<double> translation, rotation;
      for (const auto& [i, j] : pairs_by_metres(poses.truth, length_m)) {
        const Se3 error = motion_error(poses, i, j);
        translation.push_back(100 * error.t.norm() / length_m);
        rotation.push_back(rotation_angle_deg(error.R) / length_m);
      }
      if (translation.empty()) return result;
      result.push_back({length_m, statistics(std::move(translation)), statistics(std::move(rotation))});
    }
  }
  return result;
}

}  // namespace plvo::eval

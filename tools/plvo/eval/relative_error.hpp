// SPDX-License-Identifier: Apache-2.0
// Relative pose error, equation (27) of Lu & Song after Sturm et al. (IROS 2012): with estimates P and truth
// Q, E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) over all pairs (i, j) that lie one delta apart. Each result also has
// the error of the zero-motion baseline (P = identity).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plvo/eval/statistics.hpp"
#include "plvo/math/se3.hpp"

namespace plvo::eval {

// "1f" (frames of the estimate), "0.5s" (seconds; a pair may be off by 50 ms) or "2m" (metres of true path).
struct RpeDelta {
  enum class Unit : std::uint8_t { kFrames, kSeconds, kMetres };
  double amount = 1;
  Unit unit = Unit::kFrames;
  std::string text = "1f";
};
bool parse_rpe_delta(std::string_view text, RpeDelta& delta);

// Poses with their true poses; the three lists have the same length.
struct PairedPoses {
  std::vector<std::int64_t> stamps_ns;
  std::vector<Se3> estimate;
  std::vector<Se3> truth;
};

// Returns pairs of indices of stamps one delta apart: each stamp with the one nearest to a delta later, at
// most 50 ms off.
std::vector<std::pair<std::size_t, std::size_t>> pairs_by_seconds(const std::vector<std::int64_t>& stamps_ns,
                                                                  std::int64_t delta_ns);

// Returns how many of these pairs, in the order of their starts, do not overlap: a pair counts if it starts
// at or after the end of the last counted one.
std::size_t count_apart(const std::vector<std::pair<std::size_t, std::size_t>>& pairs);

// Returns E of the pair (i, j), as defined above.
Se3 motion_error(const PairedPoses& poses, std::size_t i, std::size_t j);

struct RpeErrors {
  Statistics translation_m;
  Statistics rotation_deg;
};

struct RpeResult {
  RpeDelta delta;
  RpeErrors estimate;
  RpeErrors identity;
};
RpeResult relative_pose_error(const PairedPoses& poses, const RpeDelta& delta);

// Drift between the first and the last pose (the paper's TED if the path is closed).
struct EndDrift {
  double translation_m = 0;
  double rotation_deg = 0;
};
EndDrift end_drift(const PairedPoses& poses);
EndDrift identity_end_drift(const PairedPoses& poses);

// Drift over sections of the path with a true length of `length_m`, one from each pose, relative to this
// length.
struct DistanceError {
  double length_m = 0;
  Statistics translation_percent;
  Statistics rotation_deg_per_m;
};
// Returns the errors for lengths 0.1, 0.2, 0.5, 1, 2, 5, … m up to the length of the path.
std::vector<DistanceError> distance_errors(const PairedPoses& poses);

// Returns the angle of a rotation in degrees, accurate near zero.
double rotation_angle_deg(const Matrix3& R);

}  // namespace plvo::eval

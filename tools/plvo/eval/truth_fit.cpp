// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/truth_fit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "plvo/eval/relative_error.hpp"
#include "plvo/math/cholesky.hpp"

namespace plvo::eval {
namespace {

constexpr std::size_t kLeastIndependent = 2;
constexpr int kMostIterations = 100;
constexpr double kMostClock_s = 0.1;
// Half-widths of the central differences. True poses jitter, and so does the slope between two of them 10 ms
// apart: a smaller step would differentiate the jitter.
constexpr double kRotationStep_rad = 1e-4;
constexpr double kClockStep_s = 0.005;
constexpr double kConverged = 1e-6;  // rad and s
constexpr double kLeastError =
    1e-12;  // m and rad: lower limit of the units of the errors, for an estimate without errors

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

// Errors of an estimate's motions against a rotated and time-shifted truth.
class SecondErrors {
 public:
  SecondErrors(const Trajectory& ground_truth, const Trajectory& estimate, std::int64_t offset_ns)
      : ground_truth_(ground_truth) {
    std::vector<std::int64_t> stamps;
    for (const StampedPose& pose : estimate.poses) stamps.push_back(pose.stamp_ns + offset_ns);
    // Use the same motions for every clock offset: those with truth at all offsets. Interpolated gaps are
    // longer than the steps taken here, so that no step passes over one.
    std::vector<bool> valid(stamps.size(), true);
    for (int k = -2; k <= 2; ++k) {
      std::vector<std::int64_t> shifted = stamps;
      for (std::int64_t& stamp : shifted) stamp += k * nanoseconds((kMostClock_s + kClockStep_s) / 2);
      const SampledPoses truth = sample(ground_truth, shifted, {});
      for (std::size_t i = 0; i < stamps.size(); ++i) valid[i] = valid[i] && truth.valid[i];
    }
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      if (!valid[i]) continue;
      poses_.stamps_ns.push_back(stamps[i]);
      poses_.estimate.push_back(estimate.poses[i].T_world_camera);
    }
    pairs_ = pairs_by_seconds(poses_.stamps_ns, nanoseconds(1));
  }

  const std::vector<std::pair<std::size_t, std::size_t>>& pairs() const { return pairs_; }

  // x: rotation (rad), clock (s). Each error: m, rad.
  std::vector<Vector6> at(const Vector4& x) {
    std::vector<std::int64_t> stamps = poses_.stamps_ns;
    for (std::int64_t& stamp : stamps) stamp += nanoseconds(x[3]);
    poses_.truth = sample(ground_truth_, stamps, {}).poses;
    const Matrix3 R = rotation_exp(x.head<3>());
    for (Se3& pose : poses_.truth) pose.R = pose.R * R;
    std::vector<Vector6> errors;
    for (const auto& [i, j] : pairs_) {
      const Se3 error = motion_error(poses_, i, j);
      errors.emplace_back();
      errors.back() << error.t, rotation_log(error.R);
    }
    return errors;
  }

 private:
  const Trajectory& ground_truth_;
  PairedPoses poses_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
};

struct Weights {
  double translation = 0, rotation = 0;
  double product(const Vector6& a, const Vector6& b) const {
    return translation * a.head<3>().dot(b.head<3>()) + rotation * a.tail<3>().dot(b.tail<3>());
  }
};

Weights weights_of(const std::vector<Vector6>& errors) {
  const auto n = static_cast<double>(errors.size());
  Weights sum;
  for (const Vector6& e : errors) {
    sum.translation += e.head<3>().squaredNorm() / n;
    sum.rotation += e.tail<3>().squaredNorm() / n;
  }
  constexpr double kLeast = kLeastError * kLeastError;
  return {1 / std::max(sum.translation, kLeast), 1 / std::max(sum.rotation, kLeast)};
}

struct NormalEquations {
  Matrix4 H = Matrix4::Zero();
  Vector4 g = Vector4::Zero();
  double cost = 0;
};

NormalEquations linearise(SecondErrors& errors, const Vector4& x, const Weights& weights) {
  const std::vector<Vector6> here = errors.at(x);
  std::vector<Vector6> slopes[4];
  for (int k = 0; k < 4; ++k) {
    const double step = k < 3 ? kRotationStep_rad : kClockStep_s;
    slopes[k] = errors.at(x + step * Vector4::Unit(k));
    const std::vector<Vector6> below = errors.at(x - step * Vector4::Unit(k));
    for (std::size_t i = 0; i < here.size(); ++i) slopes[k][i] = (slopes[k][i] - below[i]) / (2 * step);
  }
  NormalEquations sum;
  for (std::size_t i = 0; i < here.size(); ++i) {
    sum.cost += weights.product(here[i], here[i]);
    for (int k = 0; k < 4; ++k) {
      sum.g[k] += weights.product(slopes[k][i], here[i]);
      for (int l = 0; l < 4; ++l) sum.H(k, l) += weights.product(slopes[k][i], slopes[l][i]);
    }
  }
  return sum;
}

Status refused(std::string why) { return {StatusCode::kInvalidArgument, std::move(why)}; }

}  // namespace

Status fit_truth(const Trajectory& ground_truth, const Trajectory& estimate, std::int64_t offset_ns,
                 TruthFit& fit) {
  SecondErrors errors(ground_truth, estimate, offset_ns);
  const std::size_t independent = count_apart(errors.pairs());
  if (independent < kLeastIndependent)
    return refused(
        fmt::format("the truth cannot be fitted: {} motions over a second that do not overlap have ground "
                    "truth at both ends and {} s around them, and {} are needed; take a longer recording, or "
                    "compare without the fit",
                    independent, kMostClock_s, kLeastIndependent));
  Vector4 x = Vector4::Zero();
  const Weights weights = weights_of(errors.at(x));
  bool converged = false;
  for (int i = 0; i < kMostIterations && !converged; ++i) {
    const NormalEquations equations = linearise(errors, x, weights);
    Cholesky<4> cholesky;
    if (!cholesky.factor(equations.H))
      return refused(
          "the truth cannot be fitted: the camera must turn about more than one axis, and not evenly, for "
          "its rotation and its clock to show; compare without the fit");
    Vector4 next = x - cholesky.solve(equations.g);
    next[3] = std::clamp(next[3], -kMostClock_s, kMostClock_s);
    converged = (next - x).cwiseAbs().maxCoeff() < kConverged;
    x = next;
    // Overlapping motions contribute repeatedly, both to the cost and to the information matrix; dividing the
    // cost by the number of independent motions corrects for this.
    const double variance = equations.cost / (6 * static_cast<double>(independent) - 4);
    const Vector4 sigma = (variance * cholesky.inverse().diagonal()).cwiseSqrt();
    fit = {x.head<3>(), sigma.head<3>(), x[3], sigma[3], errors.pairs().size(), independent};
  }
  if (!converged) return refused("the truth cannot be fitted: the fit does not settle; compare without it");
  if (std::abs(fit.clock_s) >= kMostClock_s)
    return refused(fmt::format(
        "the truth cannot be fitted: its clock is more than {} s off; shift the estimate's stamps "
        "by --offset first",
        kMostClock_s));
  return {};
}

Trajectory corrected(const Trajectory& ground_truth, const TruthFit& fit) {
  Trajectory result = ground_truth;
  const Matrix3 R = rotation_exp(fit.rotation_rad);
  for (StampedPose& pose : result.poses) {
    pose.stamp_ns -= nanoseconds(fit.clock_s);
    pose.T_world_camera.R = pose.T_world_camera.R * R;
  }
  return result;
}

}  // namespace plvo::eval

// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/consistency.hpp"

#include <algorithm>
#include <cmath>

#include "plvo/eval/motion_chain.hpp"
#include "plvo/math/chi_square.hpp"
#include "plvo/math/cholesky.hpp"

namespace plvo::eval {
namespace {

// The 97.5 % quantile of the standard normal distribution.
constexpr double kNormal975 = 1.959963984540054;

// The band that contains 95 % of the means of n independent samples of χ²(dof). The sum is χ²(n dof). For
// many degrees of freedom, its cube root is nearly normal (Wilson & Hilferty, 1931): the error of a bound is
// 0.3 % at 15 degrees of freedom, 0.02 % at 60.
Band band_of_mean(int dof, std::size_t n) {
  constexpr int kFewDegrees = 12;  // those of chi_square_quantile
  const double k = static_cast<double>(dof) * static_cast<double>(n);
  if (k <= kFewDegrees) {
    const int all = static_cast<int>(k);
    return {dof / k * chi_square_quantile(all, 0.025), dof / k * chi_square_quantile(all, 0.975)};
  }
  const double variance = 2 / (9 * k);
  const auto bound = [&](double z) { return dof * std::pow(1 - variance + z * std::sqrt(variance), 3); };
  return {bound(-kNormal975), bound(kNormal975)};
}

// The NEES samples of one kind of error.
class Samples {
 public:
  explicit Samples(int dof) : dof_(dof) {}
  void add(double nees) { values_.push_back(nees); }

  Nees finish(std::size_t independent) const {
    const Statistics summary = statistics(values_);
    Nees nees{dof_, summary.mean, summary.median, 0, {}, {}};
    const double bound = chi_square_quantile(dof_, 0.95);
    for (const double value : values_) nees.inside_95 += value <= bound ? 1 : 0;
    nees.inside_95 /= static_cast<double>(values_.size());
    nees.mean_band = band_of_mean(dof_, independent);
    // The number of samples below the true median is binomial: its fraction is ½ ± 1.96 · ½/√n.
    const double share = std::min(0.49, kNormal975 * 0.5 / std::sqrt(static_cast<double>(independent)));
    nees.median_band = {chi_square_quantile(dof_, 0.5 - share), chi_square_quantile(dof_, 0.5 + share)};
    return nees;
  }

 private:
  int dof_;
  std::vector<double> values_;
};

class Accumulator {
 public:
  void add(const Vector6& error, const Matrix6& covariance) {
    Cholesky<6> whole;
    Cholesky<3> of_translation, of_rotation;
    if (!whole.factor(covariance) || !of_translation.factor(covariance.block<3, 3>(0, 0)) ||
        !of_rotation.factor(covariance.block<3, 3>(3, 3))) {
      ++result_.singular;
      return;
    }
    all_.add(whole.solve_lower(error).squaredNorm());
    translation_.add(of_translation.solve_lower(error.head<3>()).squaredNorm());
    rotation_.add(of_rotation.solve_lower(error.tail<3>()).squaredNorm());
    ++result_.count;
  }
  void add_broken() { ++result_.broken; }

  Consistency finish(std::size_t independent) {
    result_.independent = independent;
    if (result_.count == 0) return result_;
    result_.all = all_.finish(independent);
    result_.translation = translation_.finish(independent);
    result_.rotation = rotation_.finish(independent);
    return result_;
  }
  std::size_t count() const { return result_.count; }

 private:
  Consistency result_;
  Samples all_{6}, translation_{3}, rotation_{3};
};

const StampedCovariance* find(const std::vector<StampedCovariance>& covariances, std::int64_t stamp_ns) {
  const auto found =
      std::lower_bound(covariances.begin(), covariances.end(), stamp_ns,
                       [](const StampedCovariance& c, std::int64_t t) { return c.stamp_ns < t; });
  return found != covariances.end() && found->stamp_ns == stamp_ns ? &*found : nullptr;
}

}  // namespace

// With R_i Exp(η_i) and p_i + w_i for the true poses, R = R_bᵀ R_a changes by R η_a − η_b and t = R_bᵀ (p_a −
// p_b) by R_bᵀ (w_a − w_b) + t × η_b to first order; η and w are isotropic.
Matrix6 TruthSigma::of_motion(const Vector3& t) const {
  const double p = position_m * position_m, r = orientation_rad * orientation_rad;
  const Matrix3 T = skew(t);
  Matrix6 C = Matrix6::Zero();
  C.block<3, 3>(0, 0) = 2 * p * Matrix3::Identity() + r * T * T.transpose();
  C.block<3, 3>(3, 3) = 2 * r * Matrix3::Identity();
  C.block<3, 3>(0, 3) = -r * T;
  C.block<3, 3>(3, 0) = -r * T.transpose();
  return C;
}

std::vector<PoseError> pose_errors(const PairedPoses& poses,
                                   const std::vector<StampedCovariance>& covariances) {
  std::vector<PoseError> errors;
  for (std::size_t i = 0; i < poses.truth.size(); ++i) {
    const Se3 truth = poses.estimate[0] * (poses.truth[0].inverse() * poses.truth[i]);
    PoseError next{poses.stamps_ns[i], boxminus(poses.estimate[i], truth), {}};
    if (const StampedCovariance* c = find(covariances, poses.stamps_ns[i]); c != nullptr)
      next.sigma = c->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    errors.push_back(next);
  }
  return errors;
}

Consistency pose_consistency(const PairedPoses& poses, const std::vector<StampedCovariance>& covariances,
                             const TruthSigma& truth_sigma) {
  Accumulator accumulator;
  const std::vector<PoseError> errors = pose_errors(poses, covariances);
  for (std::size_t i = 1; i < errors.size();
       ++i) {  // the first pose defines the world: no error, no covariance
    if (const StampedCovariance* c = find(covariances, errors[i].stamp_ns); c != nullptr) {
      const Vector3 travelled = poses.estimate[0].R * (poses.truth[0].inverse() * poses.truth[i]).t;
      accumulator.add(errors[i].error, c->covariance + truth_sigma.of_motion(travelled));
    }
  }
  return accumulator.finish(accumulator.count());
}

Consistency motion_consistency(const std::vector<UncertainMotion>& motions, const Trajectory& ground_truth,
                               const TruthSampling& sampling, const TruthSigma& truth_sigma) {
  std::vector<std::int64_t> stamps, references;
  for (const UncertainMotion& motion : motions) {
    stamps.push_back(motion.stamp_ns);
    references.push_back(motion.reference_stamp_ns);
  }
  const SampledPoses now = sample(ground_truth, stamps, sampling);
  const SampledPoses before = sample(ground_truth, references, sampling);
  Accumulator accumulator;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (!now.valid[i] || !before.valid[i]) continue;
    const Se3 truth = now.poses[i].inverse() * before.poses[i];
    accumulator.add(boxminus(motions[i].T_camera_reference, truth),
                    motions[i].covariance + truth_sigma.of_motion(truth.t));
  }
  return accumulator.finish(accumulator.count());
}

Consistency span_consistency(const std::vector<UncertainMotion>& motions, std::int64_t span_ns,
                             const Trajectory& ground_truth, const TruthSampling& sampling,
                             const TruthSigma& truth_sigma) {
  const MotionChain chain(motions);
  const SampledPoses truth = sample(ground_truth, chain.stamps_ns(), sampling);
  Accumulator accumulator;
  std::vector<std::pair<std::size_t, std::size_t>> counted;
  for (const auto& [from, to] : pairs_by_seconds(chain.stamps_ns(), span_ns)) {
    if (!truth.valid[from] || !truth.valid[to]) continue;
    Se3 T_to_from;
    Matrix6 covariance;
    if (!chain.between(from, to, T_to_from, covariance)) {
      accumulator.add_broken();
      continue;
    }
    const std::size_t before = accumulator.count();
    const Se3 true_motion = truth.poses[to].inverse() * truth.poses[from];
    accumulator.add(boxminus(T_to_from, true_motion), covariance + truth_sigma.of_motion(true_motion.t));
    if (accumulator.count() > before) counted.emplace_back(from, to);
  }
  return accumulator.finish(count_apart(counted));
}

}  // namespace plvo::eval

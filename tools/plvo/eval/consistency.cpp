// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace plvo::eval {
namespace {

constexpr double kChiSquare6At95 = 12.591587243743977;

class Accumulator {
 public:
  void add(const Vector6& error, const Matrix6& covariance) {
    const Eigen::Matrix<double, 6, 6> C = covariance;
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> llt(C);
    if (!C.allFinite() || llt.info() != Eigen::Success || C.diagonal().minCoeff() <= 0) {
      ++result_.singular;
      return;
    }
    const Eigen::Matrix<double, 6, 1> e = error;
    const double nees = e.dot(llt.solve(e));
    const Eigen::Matrix3d C_t = C.topLeftCorner<3, 3>();
    const Eigen::Matrix3d C_r = C.bottomRightCorner<3, 3>();
    result_.mean += nees;
    result_.mean_position += e.head<3>().dot(C_t.llt().solve(e.head<3>()));
    result_.mean_orientation += e.tail<3>().dot(C_r.llt().solve(e.tail<3>()));
    result_.inside_95 += nees <= kChiSquare6At95 ? 1 : 0;
    ++result_.count;
  }

  Consistency finish() {
    if (result_.count == 0) return result_;
    const auto n = static_cast<double>(result_.count);
    for (double* sum : {&result_.mean, &result_.mean_position, &result_.mean_orientation, &result_.inside_95})
      *sum /= n;
    // The sum of n independent ones is chi-square with 6n degrees of freedom: variance 12n.
    const double half = 1.959963984540054 * std::sqrt(12 / n);
    result_.mean_low = 6 - half;
    result_.mean_high = 6 + half;
    return result_;
  }

 private:
  Consistency result_;
};

const StampedCovariance* find(const std::vector<StampedCovariance>& covariances, std::int64_t stamp_ns) {
  const auto found =
      std::lower_bound(covariances.begin(), covariances.end(), stamp_ns,
                       [](const StampedCovariance& c, std::int64_t t) { return c.stamp_ns < t; });
  return found != covariances.end() && found->stamp_ns == stamp_ns ? &*found : nullptr;
}

}  // namespace

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

Consistency pose_consistency(const PairedPoses& poses, const std::vector<StampedCovariance>& covariances) {
  Accumulator accumulator;
  const std::vector<PoseError> errors = pose_errors(poses, covariances);
  for (std::size_t i = 1; i < errors.size();
       ++i) {  // the first pose defines the world: no error, no covariance
    if (const StampedCovariance* c = find(covariances, errors[i].stamp_ns); c != nullptr)
      accumulator.add(errors[i].error, c->covariance);
  }
  return accumulator.finish();
}

Consistency motion_consistency(const std::vector<UncertainMotion>& motions, const Trajectory& ground_truth,
                               GroundTruthSampling sampling, std::int64_t max_difference_ns) {
  std::vector<std::int64_t> stamps, references;
  for (const UncertainMotion& motion : motions) {
    stamps.push_back(motion.stamp_ns);
    references.push_back(motion.reference_stamp_ns);
  }
  const SampledPoses now = sample(ground_truth, stamps, sampling, max_difference_ns);
  const SampledPoses before = sample(ground_truth, references, sampling, max_difference_ns);
  Accumulator accumulator;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (!now.valid[i] || !before.valid[i]) continue;
    const Se3 truth = now.poses[i].inverse() * before.poses[i];
    accumulator.add(boxminus(motions[i].T_camera_reference, truth), motions[i].covariance);
  }
  return accumulator.finish();
}

}  // namespace plvo::eval

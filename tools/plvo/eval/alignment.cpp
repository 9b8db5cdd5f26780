// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/alignment.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace plvo::eval {
namespace {

Vector3 mean(const std::vector<Vector3>& points) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

std::vector<Vector3> positions(const std::vector<Se3>& poses) {
  std::vector<Vector3> result;
  for (const Se3& T : poses) result.push_back(T.t);
  return result;
}

// The optimal rotation is the same with and without a scale.
void fit_scale(const std::vector<Se3>& estimate, const std::vector<Se3>& truth, AbsoluteError& result) {
  const Vector3 from = mean(positions(estimate)), to = mean(positions(truth));
  double product = 0, from_squared = 0, to_squared = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Vector3 a = result.T_truth_estimate.R * (estimate[i].t - from), b = truth[i].t - to;
    product += a.dot(b);
    from_squared += a.squaredNorm();
    to_squared += b.squaredNorm();
  }
  if (from_squared > 0) result.scale = product / from_squared;
  const double rest = to_squared - 2 * result.scale * product + result.scale * result.scale * from_squared;
  result.scaled_rmse_m = std::sqrt(std::max(rest, 0.0) / static_cast<double>(estimate.size()));
}

}  // namespace

Se3 align(const std::vector<Vector3>& from, const std::vector<Vector3>& to) {
  const Vector3 from_mean = mean(from);
  const Vector3 to_mean = mean(to);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) H += (from[i] - from_mean) * (to[i] - to_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
  if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0) D(2, 2) = -1;  // excludes a reflection
  const Matrix3 R = svd.matrixV() * D * svd.matrixU().transpose();
  return {R, to_mean - R * from_mean};
}

AbsoluteError absolute_trajectory_error(const std::vector<Se3>& estimate, const std::vector<Se3>& truth) {
  AbsoluteError result;
  if (estimate.empty()) return result;
  result.T_truth_estimate = align(positions(estimate), positions(truth));
  std::vector<double> errors;
  for (std::size_t i = 0; i < estimate.size(); ++i)
    errors.push_back((result.T_truth_estimate * estimate[i].t - truth[i].t).norm());
  result.position_m = statistics(std::move(errors));
  fit_scale(estimate, truth, result);
  return result;
}

Statistics identity_absolute_error(const std::vector<Se3>& truth) {
  if (truth.empty()) return {};
  const Vector3 centre = mean(positions(truth));
  std::vector<double> errors;
  for (const Se3& T : truth) errors.push_back((T.t - centre).norm());
  return statistics(std::move(errors));
}

}  // namespace plvo::eval

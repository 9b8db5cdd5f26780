// SPDX-License-Identifier: Apache-2.0
#include "plvo/calibrate/quadratic_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "plvo/base/random.hpp"

namespace plvo::calibrate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDraws = 300;

// Returns a row for each place, with the columns 1, x_i, x_i x_j (i ≤ j).
MatrixXd monomials(const MatrixXd& design) {
  const Eigen::Index n = design.cols();
  MatrixXd A(design.rows(), 1 + n + n * (n + 1) / 2);
  for (Eigen::Index row = 0; row < design.rows(); ++row) {
    Eigen::Index column = 0;
    A(row, column++) = 1;
    for (Eigen::Index i = 0; i < n; ++i) A(row, column++) = design(row, i);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = i; j < n; ++j) A(row, column++) = design(row, i) * design(row, j);
  }
  return A;
}

// Returns false if the surface has no minimum.
bool minimum_of(const VectorXd& coefficients, Eigen::Index n, VectorXd& place) {
  MatrixXd H(n, n);
  Eigen::Index k = 1 + n;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = i; j < n; ++j, ++k) H(i, j) = H(j, i) = (i == j ? 2 : 1) * coefficients(k);
  const Eigen::LLT<MatrixXd> factor(H);
  if (factor.info() != Eigen::Success) return false;
  place = -factor.solve(coefficients.segment(1, n)).eval();
  place = place.cwiseMax(-kFarthest).cwiseMin(kFarthest);
  return place.allFinite();
}

}  // namespace

MatrixXd quadratic_design(int unknowns) {
  if (unknowns == 1) {
    MatrixXd design(5, 1);
    design << -1, -0.5, 0, 0.5, 1;
    return design;
  }
  const int corners = 1 << unknowns;
  MatrixXd design = MatrixXd::Zero(1 + 2 * unknowns + corners, unknowns);
  for (int i = 0; i < unknowns; ++i) {
    design(1 + 2 * i, i) = 1;
    design(2 + 2 * i, i) = -1;
  }
  constexpr double kCorner = 0.6;
  for (int corner = 0; corner < corners; ++corner)
    for (int i = 0; i < unknowns; ++i)
      design(1 + 2 * unknowns + corner, i) = (corner >> i & 1) != 0 ? kCorner : -kCorner;
  return design;
}

QuadraticMinimum fit_quadratic(const MatrixXd& design, const MatrixXd& costs) {
  const Eigen::Index n = design.cols();
  const MatrixXd A = monomials(design);
  // One row for each block: the coefficients are linear in the costs.
  const Eigen::LLT<MatrixXd> normal(A.transpose() * A);  // the designs are well conditioned
  const MatrixXd coefficients = normal.solve(A.transpose() * costs.transpose()).transpose();
  QuadraticMinimum result;
  result.covariance = MatrixXd::Constant(n, n, std::numeric_limits<double>::infinity());
  result.convex = minimum_of(coefficients.colwise().sum(), n, result.place);
  if (!result.convex) {
    Eigen::Index best = 0;
    costs.colwise().sum().minCoeff(&best);
    result.place = design.row(best);
    return result;
  }
  Random random(1, 0x43414c);
  MatrixXd scatter = MatrixXd::Zero(n, n);
  int drawn = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    VectorXd sum = VectorXd::Zero(coefficients.cols());
    for (Eigen::Index i = 0; i < coefficients.rows(); ++i) {
      const auto block =
          static_cast<Eigen::Index>(random.uniform() * static_cast<double>(coefficients.rows()));
      sum += coefficients.row(std::min(block, coefficients.rows() - 1)).transpose();
    }
    VectorXd place;
    if (!minimum_of(sum, n, place)) continue;
    scatter += (place - result.place) * (place - result.place).transpose();
    ++drawn;
  }
  // If more than a tenth of the draws have no minimum, the covariance stays infinite.
  if (drawn > 9 * kDraws / 10) result.covariance = scatter / drawn;
  return result;
}

}  // namespace plvo::calibrate

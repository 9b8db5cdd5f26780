// SPDX-License-Identifier: Apache-2.0
#include "dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace plvo::test {

Dense product(const DenseRef& A, const DenseRef& B) { return A * B; }
Dense transposed_product(const DenseRef& A, const DenseRef& B) { return A.transpose() * B; }
Dense inverse(const DenseRef& A) { return A.inverse(); }
Dense cholesky(const DenseRef& A) { return A.llt().matrixL(); }
Dense solve_lower(const DenseRef& L, const DenseRef& B) { return L.triangularView<Eigen::Lower>().solve(B); }
Dense solve_positive(const DenseRef& A, const DenseRef& B) { return A.ldlt().solve(B); }
DenseVector symmetric_eigenvalues(const DenseRef& A) {
  return Eigen::SelfAdjointEigenSolver<Dense>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace plvo::test

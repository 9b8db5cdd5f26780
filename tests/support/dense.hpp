// SPDX-License-Identifier: Apache-2.0
// Eigen's decompositions for the independent statements in the tests: of any size, and compiled once. As
// templates of every size in every test they took most of the tests' building.
#pragma once

#include <Eigen/Core>

namespace plvo::test {

using Dense = Eigen::MatrixXd;
using DenseVector = Eigen::VectorXd;
using DenseRef = Eigen::Ref<const Dense>;

Dense product(const DenseRef& A, const DenseRef& B);
Dense transposed_product(const DenseRef& A, const DenseRef& B);  // Aᵀ B
Dense inverse(const DenseRef& A);
Dense cholesky(const DenseRef& A);                           // L of A = L Lᵀ
Dense solve_lower(const DenseRef& L, const DenseRef& B);     // L⁻¹ B
Dense solve_positive(const DenseRef& A, const DenseRef& B);  // A⁻¹ B, A positive definite
DenseVector symmetric_eigenvalues(const DenseRef& A);        // ascending

}  // namespace plvo::test

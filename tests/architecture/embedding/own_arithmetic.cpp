// SPDX-License-Identifier: Apache-2.0
// Calculations of a robot's program with poses. They instantiate the same Eigen templates with the same types
// as the core, compiled with the robot's options. Without optimisation each instance becomes a function that
// a linker could use in the core.
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "plvo/math/se3.hpp"
#include "plvo/math/types.hpp"

plvo::Vector3 own_arithmetic(const plvo::Se3& T_a_b, const plvo::Vector3& p_b) {
  using namespace plvo;
  const Matrix3 R = T_a_b.R * T_a_b.R.transpose() * T_a_b.R;
  const Vector3 p_a = R * p_b + T_a_b.t;
  Matrix6 Sigma = Matrix6::Identity();
  Sigma.block<3, 3>(0, 0) = R;
  const Vector6 x = Sigma * Vector6::Ones();
  const Matrix2 small = Sigma.topLeftCorner<2, 2>();
  return p_a.cross(Vector3(x.head<3>())).normalized() * p_a.dot(p_b) * p_a.squaredNorm() *
             small.determinant() +
         R.inverse() * p_b;
}

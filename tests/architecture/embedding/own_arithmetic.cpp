// SPDX-License-Identifier: Apache-2.0
// What a robot's program computes with poses: the same templates of Eigen over the same types as the core
// uses, compiled with the robot's switches. Without optimisation each becomes a function that a linker could
// take for the core's own.
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

// SPDX-License-Identifier: Apache-2.0
// Rigid motions. T_a_b maps coordinates in frame b to coordinates in frame a: p_a = T_a_b * p_b. A small
// motion is a 6-vector δ = (v, ω), translation first, then rotation (metres, radians): T ⊞ δ = (Exp(ω) R, t +
// v). The two parts are not coupled. The blocks of the covariance of δ are therefore those of the position
// and of the orientation, both in the axes of frame a.
#pragma once

#include "plvo/math/types.hpp"

namespace plvo {

// [v]×: the matrix with [v]× w = v × w.
Matrix3 skew(const Vector3& v);
// Returns a right-handed orthonormal frame whose third column is the unit vector d.
Matrix3 frame_along(const Vector3& d);
// Rodrigues' formula, exact to rounding for every angle. Near zero it uses the Taylor series.
Matrix3 rotation_exp(const Vector3& omega);
// Inverse of rotation_exp. |ω| lies in [0, π].
Vector3 rotation_log(const Matrix3& R);
// Returns the rotation nearest to a matrix that differs from a rotation only by rounding (one Newton step of
// the polar factor).
Matrix3 renormalise(const Matrix3& R);
// Checks R Rᵀ = I to 1e-6 in every entry. False for a reflection and for entries that are not finite.
bool is_rotation(const Matrix3& R);

struct Quaternion {  // Hamilton, unit
  double x = 0, y = 0, z = 0, w = 1;
};
Quaternion to_quaternion(const Matrix3& R);  // w ≥ 0
Matrix3 to_rotation(const Quaternion& q);    // normalises q first; the zero quaternion gives the identity

struct Se3 {
  Matrix3 R = Matrix3::Identity();
  Vector3 t = Vector3::Zero();

  Vector3 operator*(const Vector3& p) const { return R * p + t; }
  Se3 operator*(const Se3& other) const { return {R * other.R, R * other.t + t}; }
  Se3 inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
  bool is_finite() const { return R.allFinite() && t.allFinite(); }
};

// T ⊞ δ, as defined above.
Se3 boxplus(const Se3& T, const Vector6& delta);
// δ with boxplus(T, δ) = S.
Vector6 boxminus(const Se3& S, const Se3& T);

// J C Jᵀ: the covariance of J e, where e has the covariance C.
Matrix6 transform_covariance(const Matrix6& J, const Matrix6& C);
// Rotates both parts of a perturbation.
Matrix6 rotation_of_both(const Matrix3& R);
// First-order covariances of the ⊞-perturbations of the product T_a T_b and of the inverse T_a^-1. C_a and
// C_b are the covariances of T_a and T_b, which must be independent.
Matrix6 compose_covariance(const Se3& T_a, const Matrix6& C_a, const Se3& T_b, const Matrix6& C_b);
Matrix6 inverse_covariance(const Se3& T_a, const Matrix6& C_a);

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/math/se3.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "plvo/math/trigonometry.hpp"

namespace plvo {

Matrix3 skew(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Matrix3 rotation_exp(const Vector3& omega) {
  const double theta_squared = omega.squaredNorm();
  double a = 0;  // sin θ / θ
  double b = 0;  // (1 − cos θ) / θ²
  if (theta_squared < 1e-8) {
    // The next terms, θ⁴/120 and θ⁴/720, are below one unit in the last place here.
    a = 1 - theta_squared / 6;
    b = 0.5 - theta_squared / 24;
  } else {
    const double theta = sqrt(theta_squared);
    a = sin(theta) / theta;
    const double half = sin(theta / 2);  // 1 − cos θ = 2 sin²(θ/2) loses no digits
    b = 2 * half * half / theta_squared;
  }
  const Matrix3 W = skew(omega);
  return Matrix3::Identity() + a * W + b * (W * W);
}

Vector3 rotation_log(const Matrix3& R) {
  // Uses the quaternion, which is well conditioned at every angle, including π.
  const Quaternion q = to_quaternion(R);
  const Vector3 v(q.x, q.y, q.z);
  const double s = sqrt(v.squaredNorm());
  if (s < 1e-8) return 2 * v;
  return (2 * atan2(s, q.w) / s) * v;
}

Matrix3 renormalise(const Matrix3& R) {
  // Newton's iteration for the polar factor, R ← (R + R^-T)/2, converges quadratically. One step squares an
  // error that rounding keeps near 1e-15.
  return 0.5 * (R + Matrix3(R.inverse()).transpose());
}

bool is_rotation(const Matrix3& R) {
  constexpr double kTolerance = 1e-6;
  const Matrix3 product = R * R.transpose();
  return R.allFinite() && (product - Matrix3::Identity()).cwiseAbs().maxCoeff() <= kTolerance &&
         R.determinant() > 0;
}

Quaternion to_quaternion(const Matrix3& R) {
  // Shepperd's method: divide by the largest of the four components.
  const double trace = R.trace();
  Quaternion q;
  if (trace >= R(0, 0) && trace >= R(1, 1) && trace >= R(2, 2)) {
    const double s = 2 * sqrt(1 + trace);
    q = {(R(2, 1) - R(1, 2)) / s, (R(0, 2) - R(2, 0)) / s, (R(1, 0) - R(0, 1)) / s, s / 4};
  } else if (R(0, 0) >= R(1, 1) && R(0, 0) >= R(2, 2)) {
    const double s = 2 * sqrt(1 + R(0, 0) - R(1, 1) - R(2, 2));
    q = {s / 4, (R(0, 1) + R(1, 0)) / s, (R(0, 2) + R(2, 0)) / s, (R(2, 1) - R(1, 2)) / s};
  } else if (R(1, 1) >= R(2, 2)) {
    const double s = 2 * sqrt(1 + R(1, 1) - R(0, 0) - R(2, 2));
    q = {(R(0, 1) + R(1, 0)) / s, s / 4, (R(1, 2) + R(2, 1)) / s, (R(0, 2) - R(2, 0)) / s};
  } else {
    const double s = 2 * sqrt(1 + R(2, 2) - R(0, 0) - R(1, 1));
    q = {(R(0, 2) + R(2, 0)) / s, (R(1, 2) + R(2, 1)) / s, s / 4, (R(1, 0) - R(0, 1)) / s};
  }
  const double n = sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  const double scale = (q.w < 0 ? -1 : 1) / n;
  return {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
}

Matrix3 to_rotation(const Quaternion& q) {
  const double n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!(n > 0)) return Matrix3::Identity();
  const double s = 2 / n;
  Matrix3 R;
  R << 1 - s * (q.y * q.y + q.z * q.z), s * (q.x * q.y - q.z * q.w), s * (q.x * q.z + q.y * q.w),
      s * (q.x * q.y + q.z * q.w), 1 - s * (q.x * q.x + q.z * q.z), s * (q.y * q.z - q.x * q.w),
      s * (q.x * q.z - q.y * q.w), s * (q.y * q.z + q.x * q.w), 1 - s * (q.x * q.x + q.y * q.y);
  return R;
}

Se3 boxplus(const Se3& T, const Vector6& delta) {
  return {rotation_exp(delta.tail<3>()) * T.R, T.t + delta.head<3>()};
}

Vector6 boxminus(const Se3& S, const Se3& T) {
  Vector6 delta;
  delta.head<3>() = S.t - T.t;
  delta.tail<3>() = rotation_log(S.R * T.R.transpose());
  return delta;
}

// Not inlined, as most of its callers are called once for a frame.
[[gnu::noinline]] Matrix6 transform_covariance(const Matrix6& J, const Matrix6& C) {
  return J.lazyProduct(C).eval().lazyProduct(J.transpose());
}

[[gnu::noinline]] Matrix6 rotation_of_both(const Matrix3& R) {
  Matrix6 J = Matrix6::Zero();
  J.block<3, 3>(0, 0) = R;
  J.block<3, 3>(3, 3) = R;
  return J;
}

Matrix6 compose_covariance(const Se3& T_a, const Matrix6& C_a, const Se3& T_b, const Matrix6& C_b) {
  // First-order expansion of (T_a ⊞ (v_a, ω_a))(T_b ⊞ (v_b, ω_b)):
  //   v = v_a − [R_a t_b]× ω_a + R_a v_b,   ω = ω_a + R_a ω_b.
  Matrix6 J_a = Matrix6::Identity();
  J_a.block<3, 3>(0, 3) = -skew(T_a.R * T_b.t);
  return transform_covariance(J_a, C_a) + transform_covariance(rotation_of_both(T_a.R), C_b);
}

Matrix6 inverse_covariance(const Se3& T_a, const Matrix6& C_a) {
  // T^-1 = (Rᵀ, −Rᵀ t); with R → Exp(ω) R: v' = −Rᵀ v − Rᵀ [t]× ω … and ω' = −Rᵀ ω.
  const Matrix3 R_transposed = T_a.R.transpose();
  Matrix6 J = rotation_of_both(-R_transposed);
  J.block<3, 3>(0, 3) = -R_transposed * skew(T_a.t);
  return transform_covariance(J, C_a);
}

Matrix3 frame_along(const Vector3& d) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (d[k] * d[k] < d[least] * d[least]) least = k;
  Vector3 axis = Vector3::Zero();
  axis[least] = 1;
  Matrix3 frame;
  Vector3 u = axis - d * d[least];
  u *= 1 / sqrt(u.squaredNorm());
  frame.col(0) = u;
  frame.col(1) = d.cross(u);
  frame.col(2) = d;
  return frame;
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// The Mahalanobis distance (5)–(7) from a back-projected sample to a line, in the plane that the camera's
// centre and the segment span (see line3d.hpp). Its coordinates are (X, Z) with X = t Z, where t is the pixel
// along the segment. Inner loops use these functions, so they need one division per sample and no root.
#pragma once

namespace plvo {

// A line in the plane of the segment: the points at pixels t_a and t_b of the segment with depths z_a and
// z_b.
struct PlaneLine {
  double t_a = 0, z_a = 0;
  double t_b = 0, z_b = 0;
};

// The same line as the point A and the vector from A to B.
struct Chord {
  double x_a, z_a;
  double dx, dz;
  explicit Chord(const PlaneLine& line)
      : x_a(line.t_a * line.z_a), z_a(line.z_a), dx(line.t_b * line.z_b - x_a), dz(line.z_b - z_a) {}
};

// A sample with its whitener W = [w_x, -t w_x; 0, w_z] of (X, Z): WᵀW is the inverse of its covariance (4).
struct Whitened {
  double t, d;
  double w_x, w_z;  // 1 / (d σ_p), 1 / σ_d
};

inline Whitened whiten(double t_px, double depth_m, double sigma_p_px, double sigma_d_m) {
  const double sigma_x = depth_m * sigma_p_px;
  const double inverse = 1.0 / (sigma_x * sigma_d_m);
  return {t_px, depth_m, inverse * sigma_d_m, inverse * sigma_x};
}

// (6) and (7) with b = W (B − A) and b⊥ perpendicular to it: r = cross / |b|, the foot is A + λ (B − A), and
// ∂r/∂A = (1 − λ) Wᵀb⊥ / |b|, ∂r/∂B = λ Wᵀb⊥ / |b|. The foot moves only along the line, which does not change
// r.
struct Distance {
  double cross;
  double lambda;
  double inverse_norm2;  // 1 / |b|²
  double b_x, b_z;
  double normal_x, normal_z;  // Wᵀb⊥
  double squared() const { return cross * cross * inverse_norm2; }
};

inline Distance distance(const Whitened& s, const Chord& line) {
  const double a_x = (line.x_a - s.t * line.z_a) * s.w_x;
  const double a_z = (line.z_a - s.d) * s.w_z;
  const double b_x = (line.dx - s.t * line.dz) * s.w_x;
  const double b_z = line.dz * s.w_z;
  const double inverse_norm2 = 1.0 / (b_x * b_x + b_z * b_z);
  const double n_x = -b_z * s.w_x;
  return {b_x * a_z - b_z * a_x,  -(a_x * b_x + a_z * b_z) * inverse_norm2, inverse_norm2, b_x, b_z, n_x,
          b_x * s.w_z - s.t * n_x};
}

// r² only.
inline double squared_distance(const Whitened& s, const Chord& line) {
  const double a_x = (line.x_a - s.t * line.z_a) * s.w_x;
  const double a_z = (line.z_a - s.d) * s.w_z;
  const double b_x = (line.dx - s.t * line.dz) * s.w_x;
  const double b_z = line.dz * s.w_z;
  const double cross = b_x * a_z - b_z * a_x;
  return cross * cross / (b_x * b_x + b_z * b_z);
}

// Moves the line's two points to the given pixels of the segment. The inverse depth is linear in t along a
// line. Returns false if the line meets one of those rays behind the camera.
inline bool re_anchor(PlaneLine& line, double t_a, double t_b) {
  const double inverse_a = 1.0 / line.z_a, inverse_b = 1.0 / line.z_b;
  const double slope = (inverse_b - inverse_a) / (line.t_b - line.t_a);
  const double new_a = inverse_a + slope * (t_a - line.t_a);
  const double new_b = inverse_a + slope * (t_b - line.t_a);
  if (!(new_a > 0 && new_b > 0)) return false;
  line = {t_a, 1.0 / new_a, t_b, 1.0 / new_b};
  return true;
}

// The pixel along the segment at which the foot (6) of a sample projects.
inline double foot_pixel(const Whitened& s, const Chord& line) {
  const double lambda = distance(s, line).lambda;
  return (line.x_a + lambda * line.dx) / (line.z_a + lambda * line.dz);
}

}  // namespace plvo

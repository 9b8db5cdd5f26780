// SPDX-License-Identifier: Apache-2.0
// Line matches as constraints on the motion, equations (16)–(19) of the paper. In both frames, both ends of
// the measured segment are compared with the infinite line of one landmark.
//
// Residual. δ of (6) is the residual of an end that may slide along the landmark. Two of the six coordinates
// of [A; B] are free; the other four, the offsets across the line, are observed. Both ends slide at once
// under the full 6×6 covariance Λ of the segment. If A and B are uncorrelated, this equals (6) for each end.
// Minimising over the two positions along the line leaves exactly
//   δᵀ Λ⁻¹ δ = eᵀ (Vᵀ Λ V)⁻¹ e,   e = Vᵀ [A − Q; B − Q],
// with V = diag(U, U), U the 3×2 basis across the landmark's direction d, and Q a point on the landmark. A
// match therefore has 4 degrees of freedom, and J is the Jacobian of e with each end held at its optimal
// position λ along the line. (The paper may be read as using Λ⁻¹ with the 3-vectors δ and ∂δ; that would
// count the derivative of δ along d as information.)
//
// Gauge. The landmark is (Q, d). Its minimal update is the displacement across the line, 2 + 2 numbers, at
// the two stations λ_A, λ_B where the reference frame observed the ends. In these coordinates the derivative
// of the reference residual is −I and that of the current residual is −N, where N interpolates linearly
// between the stations. The elimination reads
//   c = e' − N e,   W = (C' + N C Nᵀ)⁻¹,   Schur complement J_ξᵀ W J_ξ,   gradient −J_ξᵀ W c,
// with C = Vᵀ Λ V: one 4×4 Cholesky per line. The result does not depend on U, and depends on the stations
// only to second order in the noise. tests/motion compares it with a dense solve that uses 6-parameter
// landmarks and other gauges.
//
// A solve holds W, N, U and the landmark's points at the ends constant, at their optimum for the initial
// motion. It therefore minimises a sum of squares with constant weights, and every step lowers it. The next
// solve starts from its result (iteratively reweighted least squares). If two successive solves return the
// same motion, the gradient there is that of the joint problem, up to the error of the landmark after one
// Gauss–Newton step.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/base/match.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

class LineConstraints final : public ConstraintSet {
 public:
  // Values of the reference measurement that RANSAC uses repeatedly.
  struct Reference {
    Vector3 q;           // middle of the segment
    Matrix3 frame;       // columns: two directions across the segment, then the one along it
    double half_length;  // m; the ends are q ± half_length · d
    Matrix4 C;           // Vᵀ Λ V
  };
  // Values held constant during a solve: the landmark, the positions of the ends along it, and the weights.
  struct Held {
    Vector3 ends[2];    // points of the landmark, in reference coordinates
    Vector3 across[2];  // U, in current coordinates
    Vector4 offset;     // N e
    Cholesky<4> W;      // factor of C' + N C Nᵀ
  };
  struct Workspace {
    std::span<std::uint8_t> inliers, usable;
    std::span<Reference> references;
    std::span<Held> held;
    static constexpr Workspace take(Arena& memory, std::size_t max_matches) {
      return {memory.take<std::uint8_t>("motion: line inliers", max_matches),
              memory.take<std::uint8_t>("motion: usable lines", max_matches),
              memory.take<Reference>("motion: reference lines", max_matches),
              memory.take<Held>("motion: lines held", max_matches)};
    }
  };

  // matches[i] pairs reference[matches[i].reference] with current[matches[i].current]; all spans must outlive
  // the set. Matches beyond the workspace's capacity are ignored. Neither the ends nor the directions of
  // matched segments need to correspond.
  LineConstraints(std::span<const Line3d> reference, std::span<const Line3d> current,
                  std::span<const Match> matches, const Workspace& workspace);

  std::size_t size() const override { return matches_.size(); }
  LandmarkKind kind() const override { return LandmarkKind::kLines; }
  int dof() const override { return 4; }
  bool usable(std::size_t i) const override { return usable_[i] != 0; }
  Primitive primitive(std::size_t i) const override;
  Extent extent(std::size_t i) const override {
    Extent extent = extent_of(current_[matches_[i].current]);
    extent.record = reference_[matches_[i].reference].record;
    return extent;
  }
  // Takes the reference measurement as the landmark. The result equals that of the eliminated residual to
  // first order in the noise.
  double mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const override;
  void begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
             std::size_t every) override;
  double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                   JointInformation& sum) const override;

 private:
  bool hold(std::size_t i, const Se3& T, const NuisanceParameters& shared);

  std::span<const Line3d> reference_, current_;
  std::span<const Match> matches_;
  std::span<std::uint8_t> usable_;
  std::span<Reference> references_;
  std::span<Held> held_;
};

}  // namespace plvo

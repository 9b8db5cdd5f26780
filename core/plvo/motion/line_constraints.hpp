// SPDX-License-Identifier: Apache-2.0
// Line matches as constraints on the motion: equations (16)–(19) of the paper, both ends of the measured
// segment in both frames against the infinite line of one landmark.
//
// Residual. δ of (6) is what remains of an end when it may slide along the landmark: of the six coordinates
// of [A; B] two are free, and four, the offsets across the line, are observed. We let both ends slide at once
// under the full 6×6 covariance Λ of the segment; for a Λ without correlation between A and B this is (6) end
// by end. Minimising over the two positions along the line leaves exactly
//   δᵀ Λ⁻¹ δ = eᵀ (Vᵀ Λ V)⁻¹ e,   e = Vᵀ [A − Q; B − Q],
// with V = diag(U, U), U the 3×2 basis across the landmark's direction d, Q a point on it. So a match has 4
// degrees of freedom, and J is that of e with each end held at its best position λ along the line. (Using Λ⁻¹
// with the 3-vectors δ and ∂δ instead, as the text of the paper may be read, would count the derivative of δ
// along d as information.)
//
// Gauge. The landmark is (Q, d), with a minimal update: the displacement across the line, 2 + 2 numbers, at
// the two stations λ_A, λ_B where the reference frame saw its ends. In these coordinates the residual of the
// reference frame has derivative −I and that of the current frame −N, N linear interpolation between the
// stations, and the elimination reads
//   c = e' − N e,   W = (C' + N C Nᵀ)⁻¹,   Schur complement J_ξᵀ W J_ξ,   gradient −J_ξᵀ W c,
// with C = Vᵀ Λ V: one 4×4 Cholesky per line. U does not influence the result, the stations to second order
// in the noise; tests/motion shows it against a dense solve with 6-parameter landmarks and gauges of its own.
//
// A solve holds W, N, U and the landmark's points at the ends as they are best for the motion it begins with,
// and so minimises squares of constant weights, which every step lowers; the next begins where it ended
// (iteratively reweighted least squares). At a motion that two solves in a row give, the gradient is that of
// the joint problem, as nearly as one step brings the landmark to its optimum there.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/base/match.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

class LineConstraints final : public ConstraintSet {
 public:
  // What RANSAC needs of the reference measurement again and again.
  struct Reference {
    Vector3 q;           // middle of the segment
    Matrix3 frame;       // columns: the two directions across the segment, then along
    double half_length;  // m; the ends are q ± half_length · d
    Matrix4 C;           // Vᵀ Λ V
  };
  // What stays as it is while the motion moves: the landmark, where along it the ends are, and the weights.
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
  // the set. Matches beyond the workspace's capacity are ignored. The ends of a match need not correspond,
  // nor its directions.
  LineConstraints(std::span<const Line3d> reference, std::span<const Line3d> current,
                  std::span<const Match> matches, const Workspace& workspace);

  std::size_t size() const override { return matches_.size(); }
  int dof() const override { return 4; }
  bool usable(std::size_t i) const override { return usable_[i] != 0; }
  Primitive primitive(std::size_t i) const override;
  // With the reference measurement as the landmark: equal to the eliminated residual to first order in the
  // noise.
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

// SPDX-License-Identifier: Apache-2.0
// Surface samples as point-to-plane constraints on the motion. A match is a point of the reference, the point
// at which the current depth image observes the same surface, and the normal n of that surface in current
// coordinates. With e = T p_reference − p_current, r = nᵀ e has variance σ² and
//   cost ½ eᵀ M e,   M = ((1 + ν) n nᵀ − ν I) / σ²,   J = ∂e/∂ξ = [I, −[R p_reference]×].
// ν is the variance of the normal. For a measured normal n + δ the expectation of (n + δ)(n + δ)ᵀ is n nᵀ + ν
// (I − n nᵀ), so M subtracts the false information along a wall that the noise of many normals adds (errors
// in variables). Without this correction the motion along a corridor, which its walls do not constrain, would
// be pulled towards its initial value.
//
// Errors that all matches share are not noise. γ has two components of unit variance, one for the time at
// which the current depth image was taken and one for its offset. It moves e by G γ and is eliminated within
// the set. It adds to the nuisance parameters of the frame and to the correlation of the set. The weights are
// those at the start of a solve. Surfaces take no part in minimal sets or in RANSAC's consensus: begin()
// judges them.
//
// e is linear in the 3×4 entries of T, in the nuisance parameters and in γ. With constant weights the cost is
// one quadratic form of these 22 numbers. begin() sums it over the matches, so the time of a solver step does
// not depend on their number.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/motion/cost_term.hpp"

namespace plvo {

struct SurfaceMatch {
  Vector3 p_reference = Vector3::Zero(), p_current = Vector3::Zero();  // at mid-exposure
  Vector3 normal = Vector3::Zero();                                    // unit, current coordinates
  double variance = 0;                                                 // σ², m²
  double normal_variance = 0;                                          // ν, rad²
  double delay_s = 0;                          // row time of p_current minus that of the middle row
  Matrix<3, 2> common = Matrix<3, 2>::Zero();  // G: change of e for one SD of the time and of the offset
};

// Σ w Aᵀ M A, symmetric, for e = A x with x = (T − T at the start of the solve, by rows; β; γ; 1).
struct SurfaceForm {
  static constexpr int kMotion = 12, kCommon = 2, kOthers = NuisanceParameters::kCount + kCommon + 1;
  static constexpr int kSize = kMotion + kOthers;
  double Q[kSize][kSize];
};

class SurfaceConstraints final : public CostTerm {
 public:
  struct Workspace {
    std::span<std::uint8_t> inliers;
    std::span<SurfaceForm> form;  // one
    static constexpr Workspace take(Arena& memory, std::size_t max_matches) {
      if (max_matches == 0) return {};
      return {memory.take<std::uint8_t>("motion: surface inliers", max_matches),
              memory.take<SurfaceForm>("motion: surfaces' form", 1)};
    }
  };

  // Matches beyond the workspace's capacity are ignored; the spans must outlive the set.
  SurfaceConstraints(std::span<const SurfaceMatch> matches, const Workspace& workspace);

  std::size_t size() const { return matches_.size(); }
  LandmarkKind kind() const override { return LandmarkKind::kSurfaces; }
  int dof() const override { return 1; }
  // r² / σ². σ² does not contain the common errors of the matches. Where these are large, the matches have
  // less weight (gate, robust loss, learnt σ²); on real sensors this works better than a model of the common
  // errors (docs/theory/noise.md).
  double mahalanobis_squared(std::size_t i, const Se3& T) const;
  void begin(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
             std::size_t every) override;
  double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                   JointInformation& sum) const override;

 private:
  std::span<const SurfaceMatch> matches_;
  SurfaceForm* form_;
  Se3 T_begin_;
};

}  // namespace plvo

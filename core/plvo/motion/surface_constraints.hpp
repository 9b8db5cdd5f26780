// SPDX-License-Identifier: Apache-2.0
// Samples of surfaces as constraints on the motion: point to plane. A match is a point of the reference, the
// point where the current frame's depth image shows its surface, and the normal n of that surface in current
// coordinates. With e = T p_reference − p_current, r = nᵀ e has variance σ² and
//   cost ½ eᵀ M e,   M = ((1 + ν) n nᵀ − ν I) / σ²,   J = ∂e/∂ξ = [I, −[R p_reference]×].
// ν is the variance of the normal: with a measured normal n + δ, the expectation of (n + δ)(n + δ)ᵀ is n nᵀ +
// ν (I − n nᵀ), so what noise of many normals would say along a wall is taken off (errors in variables).
// Without that a corridor, whose walls say nothing along it, would hold the motion there to where it began.
//
// Errors that all matches share are not noise: γ of unit variance, one for the moment at which the current
// depth image was taken, one for its offset, moves e by G γ and is eliminated within the set; besides the
// shared errors of the frame and the correlation of the set. Weights are those of where a solve begins. No
// minimal set is drawn from surfaces, and they are no part of RANSAC's consensus: begin() judges them.
//
// e is linear in the 3×4 entries of T, in the shared errors and in γ. With weights held, the cost is one
// quadratic form of these 22 numbers: begin() sums it up over the matches, and a step of the solver takes the
// same time however many there are.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

struct SurfaceMatch {
  Vector3 p_reference = Vector3::Zero(), p_current = Vector3::Zero();  // at mid-exposure
  Vector3 normal = Vector3::Zero();                                    // unit, current coordinates
  double variance = 0;                                                 // σ², m²
  double normal_variance = 0;                                          // ν, rad²
  double delay_s = 0;                          // from the middle row's exposure to that of p_current
  Matrix<3, 2> common = Matrix<3, 2>::Zero();  // G: what one SD of the moment and of the offset makes of e
};

// Σ w Aᵀ M A, symmetric, for e = A x with x = (T − T where the solve began, by rows; β; γ; 1).
struct SurfaceForm {
  static constexpr int kMotion = 12, kCommon = 2, kOthers = NuisanceParameters::kCount + kCommon + 1;
  static constexpr int kSize = kMotion + kOthers;
  double Q[kSize][kSize];
};

class SurfaceConstraints final : public ConstraintSet {
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

  std::size_t size() const override { return matches_.size(); }
  int dof() const override { return 1; }
  bool usable(std::size_t) const override { return false; }  // to RANSAC
  Primitive primitive(std::size_t) const override { return {}; }
  // r² / σ². What the matches share is not in it: where that shows, they weigh less (gate, robust loss, the
  // learning of σ²), which on real sensors is better than to believe that it is known (docs/sensors.md).
  double mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const override;
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

// SPDX-License-Identifier: Apache-2.0
// Point matches as constraints on the motion, equations (12)–(14) of the paper. The landmark X_i of a match
// enters linearly, so its 3×3 block is eliminated in closed form. With e = P' − R P − t and W = (R Σ Rᵀ +
// Σ')⁻¹, the optimal landmark for a given T gives
//   cost ½ eᵀ W e,   R X* + t = P' − Σ' W e,   Schur complement J_ξᵀ W J_ξ,   gradient −J_ξᵀ W e,
// with J_ξ = [I, −[R X*]×]. This elimination is exact: the Schur complement by the matrix inversion lemma,
// the gradient because X* is optimal. tests/motion compares it with a dense joint solve.
#pragma once

#include "plvo/base/arena.hpp"
#include "plvo/base/match.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/motion/constraint_set.hpp"

namespace plvo {

class PointConstraints final : public ConstraintSet {
 public:
  struct Workspace {
    std::span<std::uint8_t> inliers, usable;
    static constexpr Workspace take(Arena& memory, std::size_t max_matches) {
      return {memory.take<std::uint8_t>("motion: point inliers", max_matches),
              memory.take<std::uint8_t>("motion: usable points", max_matches)};
    }
  };

  // matches[i] pairs reference[matches[i].reference] with current[matches[i].current]; all spans must outlive
  // the set. Matches beyond the workspace's capacity are ignored.
  PointConstraints(std::span<const Point3d> reference, std::span<const Point3d> current,
                   std::span<const Match> matches, const Workspace& workspace);

  // The two measurements of match i.
  const Point3d& reference_point(std::size_t i) const { return reference_[matches_[i].reference]; }
  const Point3d& current_point(std::size_t i) const { return current_[matches_[i].current]; }

  std::size_t size() const override { return matches_.size(); }
  LandmarkKind kind() const override { return LandmarkKind::kPoints; }
  int dof() const override { return 3; }
  bool usable(std::size_t i) const override { return usable_[i] != 0; }
  Primitive primitive(std::size_t i) const override;
  Extent extent(std::size_t i) const override { return {current_point(i).p, 0, reference_point(i).record}; }
  double mahalanobis_squared(std::size_t i, const Se3& T, double cutoff) const override;
  void begin(const Se3&, const NuisanceParameters&, const RobustKernel&, std::size_t) override {}
  double linearize(const Se3& T, const NuisanceParameters& shared, const RobustKernel& kernel,
                   JointInformation& sum) const override;

 private:
  std::span<const Point3d> reference_, current_;
  std::span<const Match> matches_;
  std::span<std::uint8_t> usable_;
};

}  // namespace plvo

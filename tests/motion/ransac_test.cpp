// SPDX-License-Identifier: Apache-2.0
// Which matches lead.
#include "plvo/motion/ransac.hpp"

#include <gtest/gtest.h>

#include "plvo/motion/motion_estimator.hpp"
#include "simulated_pair.hpp"

namespace plvo {
namespace {

struct Lead {
  bool is_taken;        // by the proven landmarks
  std::size_t matches;  // that lead
};

// The first `proven` of 100 points have agreed before. The other ones lack one agreement.
Lead lead_of_proven(std::size_t proven) {
  test::Gaussian gaussian(34);
  test::SimulatedPair pair = test::simulate(gaussian, 100, 0);
  for (std::size_t i = 0; i < pair.points_reference.size(); ++i)
    pair.points_reference[i].record = LandmarkRecord(LandmarkRecord::kProven - (i < proven ? 0 : 1));
  test::Bench bench;
  bench.load(pair);
  const CostTerms terms(bench.sets);
  const std::span<MotionSolver> solver = take_solver(bench.arena);
  const MotionReferences references;
  const MotionConfig config;
  Ransac ransac(bench.sets, terms, references, config, MotionProblem::make_kernels(terms, RobustLoss::kHuber),
                take_ransac_scratch(bench.arena, 100), solver[0]);
  EXPECT_EQ(ransac.leading(), 100U);
  const bool is_taken = ransac.let_proven_lead();
  return {is_taken, ransac.leading()};
}

// A quarter as many new landmarks could outvote the proven ones where these disagree; fewer could not.
TEST(Ransac, ProvenLandmarksLeadWhereNewOnesCouldOutvoteThem) {
  for (const std::size_t proven : {10U, 50U, 80U}) {
    const Lead lead = lead_of_proven(proven);
    EXPECT_TRUE(lead.is_taken) << proven;
    EXPECT_EQ(lead.matches, proven);
  }
  // Too few to determine a motion, or hardly any new ones.
  for (const std::size_t proven : {0U, 9U, 81U, 100U}) {
    const Lead lead = lead_of_proven(proven);
    EXPECT_FALSE(lead.is_taken) << proven;
    EXPECT_EQ(lead.matches, 100U);
  }
}

}  // namespace
}  // namespace plvo

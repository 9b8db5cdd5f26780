// SPDX-License-Identifier: Apache-2.0
// Inliers among outliers: against a count over all pairs of matches, and what the estimate makes of them.
#include "plvo/motion/neighbourhoods.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "simulated_pair.hpp"

namespace plvo {
namespace {

struct Placed {
  int x, y;
  bool is_inlier;
  std::size_t cell() const { return static_cast<std::size_t>(y * ImageCells::kSide + x); }
};

Neighbourhoods count(const std::vector<Placed>& matches) {
  Neighbourhoods around;
  for (const Placed& match : matches) around.count(match.cell(), match.is_inlier);
  return around;
}

// Slow and obvious: looks at every other match.
bool is_isolated(const std::vector<Placed>& matches, std::size_t of) {
  double inliers = 0, outliers = 0, near_inliers = 0, near_outliers = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    ++(matches[i].is_inlier ? inliers : outliers);
    if (i == of || std::abs(matches[i].x - matches[of].x) > 1 || std::abs(matches[i].y - matches[of].y) > 1)
      continue;
    ++(matches[i].is_inlier ? near_inliers : near_outliers);
  }
  const double usual = outliers > inliers ? outliers / inliers : 1;
  return near_outliers >= 4 * usual && near_outliers > 2 * usual * near_inliers;
}

TEST(Neighbourhoods, AgreeWithACountOverAllPairs) {
  Random random(31);
  int isolated = 0, others = 0;
  for (const double share : {0.9, 0.6, 0.3}) {
    std::vector<Placed> matches;
    for (int i = 0; i < 200; ++i)
      matches.push_back({static_cast<int>(random.below(ImageCells::kSide)) / 3,
                         static_cast<int>(random.below(ImageCells::kSide)) / 3, random.uniform() < share});
    // At the edges of the grid, too.
    for (int i = 0; i < 40; ++i)
      matches.push_back({ImageCells::kSide - 1 - static_cast<int>(random.below(2)),
                         ImageCells::kSide - 1 - static_cast<int>(random.below(2)), random.uniform() < 0.2});
    const Neighbourhoods around = count(matches);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (!matches[i].is_inlier) continue;
      EXPECT_EQ(around.is_isolated(matches[i].cell()), is_isolated(matches, i));
      ++(is_isolated(matches, i) ? isolated : others);
    }
  }
  EXPECT_GT(isolated, 10);
  EXPECT_GT(others, 200);
}

TEST(Neighbourhoods, SingleOutliersIsolateNoInlier) {
  const std::vector<Placed> matches{{5, 5, true}, {5, 5, false}, {6, 5, false}, {4, 6, false}};
  EXPECT_FALSE(count(matches).is_isolated(matches[0].cell()));
}

TEST(Neighbourhoods, PointsOfAllDirectionsHaveACell) {
  for (const double x : {-1e9, -0.3, 0.0, 0.3, 1e9})
    EXPECT_LT(ImageCells::at(Vector3(x, -x, 1)), ImageCells::kCount);
  EXPECT_EQ(ImageCells::at(Vector3(0.01, 0.01, 1)), ImageCells::at(Vector3(0.1, 0.1, 2)));
  EXPECT_NE(ImageCells::at(Vector3(0.01, 0.01, 1)), ImageCells::at(Vector3(0.1, 0.01, 1)));
}

// A near board slides along three of its lines, which therefore agree with the room's motion.
TEST(Neighbourhoods, LinesThatAMovingBoardSlidesAlongAreNoInliers) {
  for (const bool has_points : {true, false}) {
    test::Gaussian gaussian(32);
    test::Bench bench;
    test::SimulatedPair pair;
    pair.truth = boxplus(Se3(), 0.01 * gaussian.vector<6>());
    for (int i = 0; i < 200; ++i) {
      const double z = gaussian.uniform(1, 2.5);
      pair.add_point(gaussian, {z * gaussian.uniform(0.05, 0.5), z * gaussian.uniform(-0.4, 0.4), z});
    }
    Se3 slides;
    slides.t.x() = 0.05;
    const Se3 T_room = pair.truth;
    pair.truth = T_room * slides;
    for (int i = 0; i < 3; ++i) {
      const double y = -0.1 + 0.1 * i;
      pair.add_line(gaussian, {-0.3, y, 0.8}, {-0.15, y, 0.8});
    }
    for (int i = 0; has_points && i < 40; ++i)
      pair.add_point(gaussian, {gaussian.uniform(-0.32, -0.12), gaussian.uniform(-0.12, 0.12), 0.8});
    pair.truth = T_room;
    MotionStart start(nullptr);
    start.registered = true;
    const MotionEstimate estimate = bench.estimate(pair, {}, 1, start);
    ASSERT_EQ(estimate.status, StatusCode::kOk);
    EXPECT_LT(test::nees(estimate.T_current_reference, T_room, test::inverse(estimate.C_H)), 30);
    EXPECT_GT(estimate.inliers[0], 180);
    EXPECT_EQ(estimate.inliers[1], has_points ? 0 : 3);
  }
}

}  // namespace
}  // namespace plvo

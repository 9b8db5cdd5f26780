// SPDX-License-Identifier: Apache-2.0
// Tests the criteria by which plvo_bench detectors counts a segment or a keypoint as found, on hand-made
// cases.
#include "plvo/bench/detectors/line_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plvo/bench/detectors/score.hpp"

namespace plvo::bench {
namespace {

Line line(double ax, double ay, double bx, double by) { return {Vector2(ax, ay), Vector2(bx, by)}; }

TEST(OffsetIfSame, IsThatOfTheFartherEndInEitherDirection) {
  const Line expected = line(10, 20, 50, 20);
  EXPECT_NEAR(offset_if_same(expected, line(10, 21, 50, 20.5), 2).value_or(9), 1, 0.01);
  EXPECT_NEAR(offset_if_same(expected, line(50, 20.5, 10, 21), 2).value_or(9), 1, 0.01);
  EXPECT_FALSE(offset_if_same(expected, line(10, 22.1, 50, 22.1), 2));
  EXPECT_TRUE(offset_if_same(expected, line(10, 22.1, 50, 22.1), 3));
  // Its midpoint is on the line, but it is rotated: one end is 3 px off.
  EXPECT_FALSE(offset_if_same(expected, line(10, 17, 50, 23), 2));
}

TEST(OffsetIfSame, RequiresHalfOfTheLength) {
  const Line expected = line(10, 20, 50, 20);
  EXPECT_TRUE(offset_if_same(expected, line(29, 20, 80, 20), 2));
  EXPECT_FALSE(offset_if_same(expected, line(31, 20, 80, 20), 2)) << "19 of 40 px";
  EXPECT_FALSE(offset_if_same(expected, line(20, 20, 39, 20), 2)) << "a fragment of 19 px";
  EXPECT_TRUE(offset_if_same(expected, line(20, 20, 41, 20), 2));
  EXPECT_TRUE(offset_if_same(expected, line(0, 20, 300, 20), 2)) << "longer is no fault";
  EXPECT_FALSE(offset_if_same(expected, line(60, 20, 100, 20), 2)) << "on the same line, but elsewhere";
  EXPECT_FALSE(offset_if_same(expected, line(10, 20, 10, 20), 2)) << "of no length";
}

TEST(Cover, CountsPixelsUnderParallelSegmentsAndTheirNearestOffset) {
  const Line edge = line(0, 0, 99, 0);
  EXPECT_EQ(cover(edge, {}, 2).samples, 100);
  EXPECT_TRUE(cover(edge, {}, 2).offsets_px.empty());
  // Two segments overlap for 10 px; there the nearer one counts.
  const Coverage pieces = cover(edge, {line(0, 1, 29, 1), line(49, 0.5, 20, 0.5)}, 2);
  ASSERT_EQ(pieces.offsets_px.size(), 50U);
  EXPECT_NEAR(pieces.offsets_px[10], 1, 1e-9);
  EXPECT_NEAR(pieces.offsets_px[25], 0.5, 1e-9);
  EXPECT_TRUE(cover(edge, {line(0, 2.5, 99, 2.5)}, 2).offsets_px.empty());
  // At 10° a segment crosses the edge and does not count.
  EXPECT_TRUE(cover(edge, {line(40, -1.76, 60, 1.76)}, 2).offsets_px.empty());
  EXPECT_FALSE(cover(edge, {line(40, -0.7, 60, 0.7)}, 2).offsets_px.empty());
}

TEST(Longest, DropsTheShortAndKeepsTheGivenNumber) {
  const std::vector<Line> kept =
      longest({line(0, 0, 19, 0), line(0, 0, 30, 0), line(0, 0, 0, 50), line(0, 0, 25, 0)}, 20, 2);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].length(), 50);
  EXPECT_EQ(kept[1].length(), 30);
}

TEST(Strongest, KeepsTheGivenNumber) {
  const std::vector<Vector2> kept =
      strongest({{Vector2(1, 0), 5}, {Vector2(2, 0), 9}, {Vector2(3, 0), 7}}, 2);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].x(), 2);
  EXPECT_EQ(kept[1].x(), 3);
}

// Two views of a wall 2 m away: the camera moves 0.04 m to the right, the image 10 px to the left. Left of
// column 50 an object 1 m away hides the wall in the second view.
class TwoViews : public ::testing::Test {
 protected:
  TwoViews() {
    sequence_.pinhole = {500, 500, 99.5, 49.5};
    sequence_.truth_known = true;
    for (View* view : {&first_, &second_}) {
      view->width = 200;
      view->height = 100;
      view->depth_m.assign(200 * 100, 2.0F);
      // A step of 100 grey levels at y = 49.5, between the rows 49 and 50.
      view->clean.assign(200 * 100, 50);
      std::fill(view->clean.begin() + 200 * 50, view->clean.end(), std::uint8_t{150});
      view->edges = {line(20, 49.5, 179, 49.5)};
    }
    for (std::size_t y = 0; y < 100; ++y)
      for (std::size_t x = 0; x < 50; ++x) second_.depth_m[200 * y + x] = 1.0F;
    second_.T_world_camera.t = Vector3(0.04, 0, 0);
  }
  void score(const std::vector<Line>& first, const std::vector<Line>& second) {
    sequence_.views = {first_, second_};
    score_ = Score();
    score_segments(sequence_, {first, second}, options_, score_);
  }

  ViewSequence sequence_;
  View first_, second_;
  ScoreOptions options_{2, 20, 1};
  Score score_;
};

TEST_F(TwoViews, CarryFollowsTheMotionAndDetectsOcclusion) {
  Vector2 carried = Vector2::Zero();
  ASSERT_TRUE(carry(sequence_.pinhole, first_, second_, Vector2(120, 30), carried));
  EXPECT_NEAR((carried - Vector2(110, 30)).norm(), 0, 1e-4);
  EXPECT_FALSE(carry(sequence_.pinhole, first_, second_, Vector2(40, 30), carried)) << "hidden";
  EXPECT_FALSE(carry(sequence_.pinhole, first_, second_, Vector2(5, 30), carried)) << "outside";
  std::fill(first_.depth_m.begin(), first_.depth_m.end(), 0.0F);
  EXPECT_FALSE(carry(sequence_.pinhole, first_, second_, Vector2(120, 30), carried)) << "no depth";
}

TEST_F(TwoViews, SegmentsAreFoundAgainAtTheirMovedPosition) {
  score({line(100, 49.5, 160, 49.5), line(100, 80, 160, 80), line(20, 20, 60, 20)},
        {line(90, 49.5, 150, 49.5), line(100, 83, 160, 83)});
  EXPECT_EQ(score_.features, 5U);
  EXPECT_EQ(score_.again.of, 2U) << "the third is hidden";
  EXPECT_EQ(score_.again.held, 1U) << "the second is 3 px off";
  EXPECT_EQ(score_.again_aside.held, 0U);
}

TEST_F(TwoViews, RecallAndPrecisionCountPixels) {
  score({line(20, 50, 99, 50)}, {line(20, 49, 179, 49), line(60, 10, 60, 40)});
  EXPECT_EQ(score_.recall.of, 2U * 160);
  EXPECT_EQ(score_.recall.held, 80U + 160);
  EXPECT_NEAR(score_.recall_px.front(), 0.5, 1e-9);
  EXPECT_EQ(score_.precision.of, 80U + 160 + 31);
  EXPECT_EQ(score_.precision.held, 80U + 160) << "the upright one lies on nothing";
  EXPECT_EQ(score_.precision_aside.held, 0U);
}

TEST_F(TwoViews, ALineAcrossAnEdgeIsNotOnIt) {
  score({line(60, 20, 120, 80)}, {});
  EXPECT_EQ(score_.precision.held, 0U);
  EXPECT_EQ(score_.recall.held, 0U);
}

TEST_F(TwoViews, KeypointsAreFoundAgainWithinTheTolerance) {
  sequence_.views = {first_, second_};
  score_points(sequence_,
               {{Vector2(120, 30), Vector2(150, 60), Vector2(40, 30)}, {Vector2(111, 31), Vector2(140, 63)}},
               options_, score_);
  EXPECT_EQ(score_.again.of, 2U);
  ASSERT_EQ(score_.again.held, 1U);
  EXPECT_NEAR(score_.again_px.front(), std::sqrt(2.0), 1e-4);
  EXPECT_NEAR(score_.again.percent(), 50, 1e-9);
}

}  // namespace
}  // namespace plvo::bench

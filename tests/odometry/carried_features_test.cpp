// SPDX-License-Identifier: Apache-2.0
// Which lines are left out as the edges of a part of the robot.
#include "plvo/odometry/tracking/carried_features.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace plvo {
namespace {

constexpr Limits kQvgaLimits{320, 240};

// One reference and the current frame, with horizontal segments alone. The lowest cells of the image are
// carried.
class Edges {
 public:
  explicit Edges(bool is_light) : memory_(8 << 20), arena_(memory_) {
    features_.allocate(arena_, kQvgaLimits);
    current_.allocate(arena_, kQvgaLimits.segments);
    tracks_.allocate(arena_, kQvgaLimits);
    reference_.features = &features_;
    cells_.init(kQvgaLimits.width, kQvgaLimits.height);
    CarriedCells::Counts stayed{};
    for (std::size_t cell = CarriedCells::kCells - CarriedCells::kColumns; cell < CarriedCells::kCells;
         ++cell)
      stayed[cell] = 1;
    cells_.mark_carried(stayed, is_light);
  }

  // A segment of the reference at row v, and its match, `moved` rows further down.
  void add(double v, double moved) {
    Segment segment;
    segment.a = {100, v};
    segment.b = {140, v};
    const auto i = static_cast<std::uint16_t>(current_.segments.size());
    ASSERT_TRUE(features_.lines.segments.push_back(segment));
    segment.a.y() += moved;
    segment.b.y() += moved;
    ASSERT_TRUE(current_.segments.push_back(segment));
    ASSERT_TRUE(tracks_.lines.push_back({i, i}));
  }

  // Rows of the matches that are kept.
  std::vector<double> keep() {
    leave_carried_lines_out({&reference_, 1}, current_, cells_, {&tracks_, 1});
    std::vector<double> rows;
    for (const Match& match : tracks_.lines) rows.push_back(features_.lines.segments[match.reference].a.y());
    return rows;
  }

 private:
  std::vector<std::byte> memory_;
  Arena arena_;
  FrameFeatures features_;
  LineFeatures current_;
  ReferenceTracks tracks_;
  Reference reference_;
  CarriedCells cells_;
};

TEST(CarriedLines, ThoseThatStayedInCarriedCellsAreLeftOutIfMostOthersMoved) {
  Edges edges(false);
  edges.add(230, 0);  // the edge of the part
  edges.add(20, 3);
  edges.add(235, 0.5);
  edges.add(60, 4);
  edges.add(232, 3);  // in a carried cell, but it moved
  edges.add(40, 0);   // it stayed, but not in a carried cell
  EXPECT_EQ(edges.keep(), (std::vector<double>{20, 60, 232, 40}));
}

TEST(CarriedLines, NoneIsLeftOutWhileTheCameraIsAtRest) {
  Edges edges(false);
  edges.add(230, 0);
  edges.add(20, 0.1);
  edges.add(60, 0);
  edges.add(80, 3);
  EXPECT_EQ(edges.keep().size(), 4U);
}

// The scene is seen through the light, in carried cells as well.
TEST(CarriedLines, NoneIsLeftOutWhereTheCellsAreCarriedByLight) {
  Edges edges(true);
  edges.add(230, 0);
  edges.add(20, 3);
  edges.add(60, 4);
  EXPECT_EQ(edges.keep().size(), 3U);
}

}  // namespace
}  // namespace plvo

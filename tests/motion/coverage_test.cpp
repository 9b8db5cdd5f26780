// SPDX-License-Identifier: Apache-2.0
// The evidence of features: by depth, shared within a cell, by cells for a line.
#include "plvo/motion/coverage.hpp"

#include <gtest/gtest.h>

namespace plvo {
namespace {

Extent point_at(double x, double y, double z) {
  Point3d point;
  point.p = Vector3(x * z, y * z, z);
  return extent_of(point);
}

TEST(Coverage, EvidenceIsInProportionToTheDepth) {
  Coverage coverage;
  coverage.count(point_at(0.1, 0.1, 1));
  coverage.count(point_at(-0.3, 0.1, 3));
  EXPECT_DOUBLE_EQ(coverage.evidence(point_at(-0.3, 0.1, 3)), 3 * coverage.evidence(point_at(0.1, 0.1, 1)));
}

TEST(Coverage, FeaturesOfACellShareItsEvidence) {
  Coverage coverage;
  for (int i = 0; i < 10; ++i) coverage.count(point_at(0.01 + 0.005 * i, 0.02, 1));
  coverage.count(point_at(0.2, 0.02, 1));
  double crowd = 0;
  for (int i = 0; i < 10; ++i) crowd += coverage.evidence(point_at(0.01 + 0.005 * i, 0.02, 1));
  EXPECT_NEAR(crowd, coverage.evidence(point_at(0.2, 0.02, 1)), 1e-12);
  coverage.clear();
  EXPECT_DOUBLE_EQ(coverage.evidence(point_at(0.02, 0.02, 1)), 1);
}

TEST(Coverage, ALineCountsForTheCellsThatItSpansUpToFour) {
  const auto line = [](double length) {
    Line3d along_x;
    along_x.a = Vector3(0, 0, 2);
    along_x.b = Vector3(2 * length, 0, 2);
    return extent_of(along_x);
  };
  const Coverage coverage;
  EXPECT_DOUBLE_EQ(coverage.evidence(line(0)), 2);
  EXPECT_DOUBLE_EQ(coverage.evidence(line(0.075)), 4);
  EXPECT_DOUBLE_EQ(coverage.evidence(line(1)), 8);
}

TEST(Coverage, FeaturesBeyondTheGridCountInItsBorderCells) {
  Coverage coverage;
  coverage.count(point_at(50, -50, 1));
  coverage.count(point_at(60, -70, 1));
  EXPECT_DOUBLE_EQ(coverage.evidence(point_at(55, -60, 1)), 0.5);
}

}  // namespace
}  // namespace plvo

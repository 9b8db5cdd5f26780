// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/landmark_records.hpp"

#include <gtest/gtest.h>

#include <array>

#include "plvo/motion/coverage.hpp"

namespace plvo {
namespace {

TEST(LandmarkRecord, IsTrustedUntilItDisagreedMoreOftenThanItAgreed) {
  LandmarkRecord record;
  EXPECT_TRUE(record.trusted());
  record.add(false);
  EXPECT_FALSE(record.trusted());
  record.add(true);
  EXPECT_TRUE(record.trusted());
}

TEST(LandmarkRecord, IsTrustedAgainAfterAsManyAgreements) {
  LandmarkRecord record;
  for (int i = 0; i < 1000; ++i) record.add(true);
  const int most = record.balance();
  EXPECT_LE(most, 10);
  for (int i = 0; i <= most; ++i) record.add(false);
  EXPECT_FALSE(record.trusted());
  for (int i = 0; i < 1000; ++i) record.add(false);
  for (int i = 0; i < most; ++i) record.add(true);
  EXPECT_TRUE(record.trusted());
}

TEST(LandmarkRecord, IsProvenAfterThreeMoreAgreementsThanDisagreements) {
  LandmarkRecord record;
  for (const bool agreed : {true, true, false, true}) {
    record.add(agreed);
    EXPECT_FALSE(record.proven());
  }
  record.add(true);
  EXPECT_TRUE(record.proven());
  record.add(false);
  EXPECT_FALSE(record.proven());
}

TEST(LandmarkRecord, AnUntrustedLandmarkHasNoEvidenceAndTakesNoneFromItsCell) {
  Point3d good, bad;
  good.p = bad.p = {0, 0, 2};
  bad.record.add(false);
  Coverage alone, both;
  alone.count(extent_of(good));
  both.count(extent_of(good));
  both.count(extent_of(bad));
  EXPECT_EQ(both.evidence(extent_of(bad)), 0);
  EXPECT_EQ(both.evidence(extent_of(good)), alone.evidence(extent_of(good)));
  Line3d line;
  line.a = {0, 0, 2};
  line.b = {1, 0, 2};
  EXPECT_GT(alone.evidence(extent_of(line)), 0);
  line.record.add(false);
  EXPECT_EQ(alone.evidence(extent_of(line)), 0);
}

// Tracks of two points and a line, of which one point and the line do not agree with the motion.
TEST(LandmarkRecords, UpdatesTheLandmarksThatAFrameFound) {
  std::array<Keypoint, 3> keypoints{};
  std::array<Point3d, 3> points{};
  std::array<Line3d, 2> lines{};
  FrameFeatures reference;
  reference.points.keypoints = FixedVector<Keypoint>(keypoints);
  reference.points.points = points;
  reference.lines.lines = lines;
  std::array<Match, 2> point_matches{}, line_matches{};
  std::array<std::uint8_t, 2> point_inliers{1, 0}, line_inliers{0, 0};
  ReferenceTracks tracks;
  tracks.points.matches = FixedVector<Match>(point_matches);
  tracks.lines = FixedVector<Match>(line_matches);
  tracks.point_inliers = point_inliers;
  tracks.line_inliers = line_inliers;
  ASSERT_TRUE(tracks.points.matches.push_back({2, 0}));
  ASSERT_TRUE(tracks.points.matches.push_back({0, 1}));
  ASSERT_TRUE(tracks.lines.push_back({1, 0}));

  note_records(tracks, reference);
  EXPECT_EQ(points[2].record.balance(), 1);
  EXPECT_EQ(points[0].record.balance(), -1);
  EXPECT_EQ(points[1].record.balance(), 0);
  EXPECT_EQ(lines[1].record.balance(), -1);
  EXPECT_EQ(lines[0].record.balance(), 0);
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plvo/eval/uncertainty_file.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "temporary_folder.hpp"

namespace plvo::eval {
namespace {

using test::TemporaryFolder;
using test::write_file;

Status read_text(const std::string& text, Trajectory& trajectory,
                 TrajectoryFormat format = TrajectoryFormat::kAuto) {
  const TemporaryFolder folder;
  write_file(folder / "t.txt", text);
  return read_trajectory({folder / "t.txt", format, {}}, trajectory);
}

bool says(const Status& status, std::string_view words) {
  return std::string_view(status.message()).find(words) != std::string_view::npos;
}

TEST(Trajectory, TumSortsAndIgnoresRepeatsAndNaN) {
  Trajectory t;
  ASSERT_TRUE(read_text("# c\n2.0 1 2 3 0 0 0 1\n1.0 0 0 0 0 0 0.70710678 0.70710678\n2.0 9 9 9 0 0 0 1\n"
                        "3.0 nan 0 0 0 0 0 1\n",
                        t)
                  .ok());
  ASSERT_EQ(t.poses.size(), 2u);
  EXPECT_EQ(t.ignored_rows, 2u);
  EXPECT_EQ(t.poses[0].stamp_ns, 1'000'000'000);
  EXPECT_NEAR(t.poses[0].T_world_camera.R(1, 0), 1, 1e-7);
  EXPECT_EQ(t.poses[1].T_world_camera.t.x(), 1);
}

TEST(Trajectory, EurocIsNanosecondsWithWFirst) {
  Trajectory t;
  ASSERT_TRUE(
      read_text("#timestamp [ns],p_x,...\n1403636579763555584,1,2,3,0.70710678,0,0,0.70710678,9,9,9\n", t)
          .ok());
  ASSERT_EQ(t.poses.size(), 1u);
  EXPECT_EQ(t.poses[0].stamp_ns, 1403636579763555584);
  EXPECT_NEAR(t.poses[0].T_world_camera.R(1, 0), 1, 1e-7);
  ASSERT_TRUE(read_text("1.5,1,2,3,0,0,0,1\n", t).ok());  // commas, but seconds: TUM's order
  EXPECT_EQ(t.poses[0].stamp_ns, 1'500'000'000);
  EXPECT_TRUE(t.poses[0].T_world_camera.R.isIdentity());
}

TEST(Trajectory, KittiStampsComeFromASeparateFile) {
  const TemporaryFolder folder;
  write_file(folder / "k.txt", "1 0 0 4 0 1 0 5 0 0 1 6\n0 -1 0 1 1 0 0 2 0 0 1 3\n");
  write_file(folder / "times.txt", "0.000000e+00\n1.036224e-01\n");
  Trajectory t;
  ASSERT_TRUE(read_trajectory({folder / "k.txt", TrajectoryFormat::kAuto, folder / "times.txt"}, t).ok());
  EXPECT_EQ(t.poses[1].stamp_ns, 103'622'400);
  EXPECT_EQ(t.poses[0].T_world_camera.t.y(), 5);
  EXPECT_EQ(t.poses[1].T_world_camera.R(1, 0), 1);
  ASSERT_TRUE(read_trajectory({folder / "k.txt", TrajectoryFormat::kKitti, {}}, t).ok());
  EXPECT_EQ(t.poses[1].stamp_ns, 100'000'000);
  write_file(folder / "times.txt", "0.0\n");
  EXPECT_TRUE(says(read_trajectory({folder / "k.txt", TrajectoryFormat::kAuto, folder / "times.txt"}, t),
                   "has 1 stamps for 2 poses"));
  write_file(folder / "times.txt", "0.0\n0.1\n0.2\n");
  const Status surplus =
      read_trajectory({folder / "k.txt", TrajectoryFormat::kAuto, folder / "times.txt"}, t);
  EXPECT_EQ(surplus.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(says(surplus, "has 3 stamps for 2 poses")) << surplus.message();
}

// The format in which programs on Windows save text.
TEST(Trajectory, ByteOrderMarkAndCarriageReturnsAreIgnored) {
  Trajectory t;
  Status status = read_text(
      "\xEF\xBB\xBF"
      "1.0 1 2 3 0 0 0 1\r\n\r\n2.0 4 5 6 0 0 0 1\r\n",
      t);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(t.poses.size(), 2u);
  EXPECT_EQ(t.poses[0].stamp_ns, 1'000'000'000);
  EXPECT_EQ(t.poses[1].T_world_camera.t, Vector3(4, 5, 6));
  status = read_text(
      "\xEF\xBB\xBF"
      "1 0 0 4 0 1 0 5 0 0 1 6\r\n",
      t);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(t.format, TrajectoryFormat::kKitti);
  EXPECT_EQ(read_text(std::string("\xFF\xFE"
                                  "1\0",
                                  4),
                      t)
                .code(),
            StatusCode::kDamaged);  // UTF-16
}

TEST(Trajectory, RejectsBadFilesWithAMessage) {
  Trajectory t;
  EXPECT_EQ(read_trajectory({"/nowhere.txt", TrajectoryFormat::kAuto, {}}, t).code(), StatusCode::kNotFound);
  EXPECT_TRUE(says(read_trajectory({"/tmp", TrajectoryFormat::kAuto, {}}, t), "it is a folder; name a file"));
  EXPECT_TRUE(says(read_text("# only\n", t), "holds no pose"));
  EXPECT_TRUE(
      says(read_text("1.0 0 0 0 0 0 0 1\n1.1 0 0 0\n", t), "line 2: has 4 columns where 8 are needed"));
  EXPECT_TRUE(says(read_text("1.0 0 0 x 0 0 0 1\n", t), "line 1: 'x' is not a number"));
  EXPECT_TRUE(says(read_text("abc 0 0 0 0 0 0 1\n", t), "'abc' is not a stamp"));
}

TEST(Trajectory, InvalidRotationIsRefusedWithItsLine) {
  Trajectory t;
  const Status zero = read_text("# c\n1.0 0 0 0 0 0 0 1\n1.1 1 2 3 0 0 0 0\n", t);
  EXPECT_EQ(zero.code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(zero, "line 3: the quaternion (x y z w = 0 0 0 0) must have length 1")) << zero.message();
  EXPECT_TRUE(says(read_text("1403636579763555584,1,2,3,0,0,0,0\n", t), "line 1: the quaternion"));
  EXPECT_TRUE(says(read_text("0 0 0 0 0 0 0 0 0 0 0 0\n", t),
                   "line 1: the 3x3 part of the matrix is not a rotation"));
  EXPECT_TRUE(says(read_text("1 0 0 0 0 1 0 0 0 0 -1 0\n", t), "is not a rotation"));  // a reflection
  // Four decimals, as in motion capture files, are accurate enough.
  EXPECT_TRUE(read_text("1.0 0 0 0 0.5774 0.5774 0.5774 0.0\n", t).ok());
}

Trajectory turning() {
  Trajectory t;
  for (int i = 0; i < 4; ++i)
    t.poses.push_back({i * 50'000'000LL, {rotation_exp(Vector3(0, 0, 0.2 * i)), Vector3(i, 0, 0)}});
  t.poses[3].stamp_ns = 400'000'000;  // a gap too wide to interpolate
  return t;
}

TEST(Sampling, InterpolatesBetweenNeighbours) {
  const SampledPoses s = sample(turning(), {25'000'000, 50'000'000, 200'000'000, -1'000'000, 400'000'000},
                                {GroundTruthSampling::kInterpolated, 20'000'000});
  EXPECT_EQ(s.valid, (std::vector<bool>{true, true, false, false, true}));
  EXPECT_NEAR(s.poses[0].t.x(), 0.5, 1e-12);
  EXPECT_NEAR(rotation_log(s.poses[0].R).z(), 0.1, 1e-12);
  EXPECT_NEAR(s.poses[4].t.x(), 3, 1e-12);
}

TEST(Sampling, NearestTakesTheEarlierOfTwo) {
  const SampledPoses s = sample(turning(), {25'000'000, 26'000'000, -25'000'000, 415'000'000},
                                {GroundTruthSampling::kNearest, 25'000'000});
  EXPECT_EQ(s.valid, (std::vector<bool>{true, true, true, true}));
  EXPECT_EQ(s.poses[0].t.x(), 0);
  EXPECT_EQ(s.poses[1].t.x(), 1);
  EXPECT_EQ(s.poses[3].t.x(), 3);
  EXPECT_FALSE(sample(turning(), {430'000'001}, {GroundTruthSampling::kNearest, 25'000'000}).valid[0]);
}

TEST(UncertaintyFile, ReadsTheWritersFormat) {
  const TemporaryFolder folder;
  TrackResult result;
  result.stamp_ns = 2'000'000'000;
  result.reference_stamp_ns = 1'000'000'000;
  result.T_camera_reference = {rotation_exp(Vector3(0.1, 0.2, -0.3)), Vector3(0.01, -0.02, 0.03)};
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) result.motion_covariance(r, c) = (r == c ? 1 : 0.01 * (r + c)) * 1e-6;
  result.pose_covariance = result.motion_covariance;
  result.state = TrackState::kTracking;
  CovarianceFile covariance_file;
  ASSERT_TRUE(covariance_file.open(folder / "c.txt").ok());
  ASSERT_TRUE(covariance_file.write(result).ok());
  MotionFile motion_file;
  ASSERT_TRUE(motion_file.open(folder / "m.txt").ok());
  ASSERT_TRUE(motion_file.write(result).ok());
  std::vector<StampedCovariance> covariances;
  ASSERT_TRUE(read_covariances(folder / "c.txt", covariances).ok());
  ASSERT_EQ(covariances.size(), 1u);
  EXPECT_TRUE(covariances[0].covariance.isApprox(result.motion_covariance, 1e-9));
  std::vector<UncertainMotion> motions;
  ASSERT_TRUE(read_motions(folder / "m.txt", motions).ok());
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].reference_stamp_ns, 1'000'000'000);
  EXPECT_LT(boxminus(motions[0].T_camera_reference, result.T_camera_reference).norm(), 1e-8);
}

TEST(UncertaintyFile, InvalidRotationIsRefused) {
  const TemporaryFolder folder;
  std::string row = "1.1 1.0 0 0 0 0 0 0 0";
  for (int i = 0; i < 36; ++i) row += i % 7 == 0 ? " 1e-6" : " 0";
  write_file(folder / "m.txt", row + '\n');
  std::vector<UncertainMotion> motions;
  EXPECT_TRUE(says(read_motions(folder / "m.txt", motions), "line 1: the quaternion"));
}

TEST(UncertaintyFile, ReadsTheUpperTriangle) {
  const TemporaryFolder folder;
  std::string row = "1.0";
  for (int i = 1; i <= 21; ++i) row += ' ' + std::to_string(i);
  write_file(folder / "c.txt", row + '\n');
  std::vector<StampedCovariance> covariances;
  ASSERT_TRUE(read_covariances(folder / "c.txt", covariances).ok());
  EXPECT_EQ(covariances[0].covariance(1, 0), 2);
  EXPECT_EQ(covariances[0].covariance(1, 1), 7);
  EXPECT_EQ(covariances[0].covariance(5, 5), 21);
  EXPECT_TRUE(covariances[0].covariance.isApprox(covariances[0].covariance.transpose()));
  write_file(folder / "c.txt", row + " 22\n");
  EXPECT_TRUE(says(read_covariances(folder / "c.txt", covariances), "has 23 columns where 37 (full) or 22"));
}

}  // namespace
}  // namespace plvo::eval

// SPDX-License-Identifier: Apache-2.0
// What tests of the public API for C share: C++'s structs as C's, and whether two results have the same bits.
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "plvo/c/boundary.hpp"
#include "plvo/c/plvo.h"
#include "plvo/odometry/odometry.hpp"

namespace plvo {

inline plvo_camera c_camera(const CameraModel& model) { return c::to_c(model); }
inline plvo_limits c_limits(const Limits& limits) {
  return {sizeof(plvo_limits), limits.width,      limits.height,      limits.keypoints,
          limits.segments,     limits.references, limits.line_bands,  limits.kept_keyframes,
          limits.cores,        limits.surfaces,   limits.mask ? 1 : 0};
}
inline plvo_frame c_frame(const RgbdFrame& frame) {
  plvo_frame result = {};
  result.struct_size = sizeof result;
  result.width = frame.colour.width;
  result.height = frame.colour.height;
  result.colour_format = PLVO_PIXELS_RGB8;
  result.stamp_ns = frame.stamp_ns;
  result.depth_stamp_ns = frame.depth_stamp_ns;
  result.colour = frame.colour.data;
  result.depth = frame.depth.data;
  result.colour_stride_bytes = frame.colour.stride_bytes;
  result.depth_stride_bytes = 2 * frame.depth.stride;
  result.metres_per_unit = frame.depth.metres_per_unit;
  return result;
}

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

inline void expect_same(const Se3& T, const double (&c)[12]) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) EXPECT_TRUE(same_bits(T.R(row, column), c[4 * row + column]));
    EXPECT_TRUE(same_bits(T.t(row), c[4 * row + 3]));
  }
}
template <int Rows, int Columns>
void expect_same(const Matrix<Rows, Columns>& matrix, const double (&c)[Rows * Columns]) {
  for (int row = 0; row < Rows; ++row)
    for (int column = 0; column < Columns; ++column)
      EXPECT_TRUE(same_bits(matrix(row, column), c[Columns * row + column]));
}
inline void expect_same(const FeatureCounts& counts, const plvo_counts& c) {
  EXPECT_EQ(counts.detected, c.detected);
  EXPECT_EQ(counts.dropped, c.dropped);
  EXPECT_EQ(counts.with_depth, c.with_depth);
  EXPECT_EQ(counts.matched, c.matched);
  EXPECT_EQ(counts.inliers, c.inliers);
}
inline void expect_same(const TrackResult& result, const plvo_result& c) {
  EXPECT_EQ(static_cast<int>(result.state), c.state);
  EXPECT_EQ(result.stamp_ns, c.stamp_ns);
  EXPECT_EQ(result.reference_stamp_ns, c.reference_stamp_ns);
  expect_same(result.T_world_camera, c.T_world_camera);
  expect_same(result.pose_covariance, c.pose_covariance);
  expect_same(result.T_camera_reference, c.T_camera_reference);
  expect_same(result.motion_covariance, c.motion_covariance);
  expect_same(result.points, c.points);
  expect_same(result.lines, c.lines);
  EXPECT_EQ(result.ransac_iterations, c.ransac_iterations);
  EXPECT_EQ(result.lm_iterations, c.lm_iterations);
  EXPECT_TRUE(same_bits(result.mean_brightness, c.mean_brightness));
  EXPECT_EQ(result.repeated ? 1 : 0, c.repeated);
  EXPECT_EQ(result.world, c.world);
  EXPECT_EQ(result.restarted ? 1 : 0, c.restarted);
  EXPECT_EQ(result.feature_step, c.feature_step);
  EXPECT_TRUE(same_bits(result.disagreement, c.disagreement));
}

}  // namespace plvo

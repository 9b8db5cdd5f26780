// SPDX-License-Identifier: Apache-2.0
// Tests the cases of plvo_bench growth: each table varies one parameter.
#include "plvo/bench/growth/growth_cases.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plvo/bench/sequences/scaled_camera.hpp"

namespace plvo::bench {
namespace {

TEST(GrowthCases, VaryOneParameterAtATime) {
  GrowthPlan plan;
  ASSERT_TRUE(plan_growth({}, {}, plan).ok());
  ASSERT_EQ(plan.tables.size(), 4U);
  const std::size_t rows[] = {5, 5, 6, 4};
  std::size_t measured = 1 + plan.sequences.rows.size();  // the first case is in each of these tables
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(plan.tables[i].rows.size(), rows[i]) << plan.tables[i].title;
    measured += rows[i] - 1;
  }
  EXPECT_EQ(plan.cases.size(), measured) << "nothing is measured twice";
  const StageSetting& tiny = plan.cases[plan.tables[0].rows[0].measured].setting;
  EXPECT_TRUE(tiny.tiny);
  EXPECT_EQ(tiny.segments, Limits::tiny().segments);
  EXPECT_EQ(plan.cases[plan.tables[0].rows[1].measured].setting.surfaces, 0) << "Limits::qvga has none";
  const StageSetting usual;
  for (const std::size_t table : {1U, 2U, 3U}) {
    for (const GrowthTable::Row& row : plan.tables[table].rows) {
      const GrowthCase& one = plan.cases[row.measured];
      const int changed = (one.setting.keypoints != usual.keypoints ? 1 : 0) +
                          (one.setting.segments != usual.segments ? 1 : 0) +
                          (one.setting.replacement != usual.replacement ? 1 : 0);
      EXPECT_EQ(changed, row.measured == 0 ? 0 : 1) << row.name;
      EXPECT_FALSE(one.setting.tiny) << row.name;
      EXPECT_EQ(one.sequence.folder, plan.cases[0].sequence.folder) << row.name;
    }
  }
  EXPECT_EQ(plan.cases[plan.tables[1].rows[4].measured].setting.keypoints, 2000);
  EXPECT_EQ(plan.cases[plan.tables[2].rows[0].measured].setting.segments, 20);
  EXPECT_EQ(plan.bounds.size(), 2U + 3 + 1);
}

TEST(GrowthCases, CoverTheRequestedTables) {
  GrowthOptions options;
  options.tables = {"sequences"};
  GrowthPlan plan;
  ASSERT_TRUE(plan_growth(options, {{"/recorded", "recorded", "tum-fr1"}}, plan).ok());
  EXPECT_TRUE(plan.tables.empty());
  ASSERT_EQ(plan.sequences.rows.size(), 2U);
  EXPECT_FALSE(plan.cases[plan.sequences.rows[1].measured].rendering) << "a recorded one is not rendered";
  options.tables = {"sizes", "moons"};
  EXPECT_EQ(plan_growth(options, {}, plan).code(), StatusCode::kInvalidArgument);
}

TEST(GrowthCases, ScaledCameraSeesTheSameScene) {
  const CameraModel camera;
  const CameraModel twice = scaled(camera, 2);
  EXPECT_EQ(twice.width, 2 * camera.width);
  const Vector3 p(0.4, -0.3, 2);
  // The corner of the image is at (−½, −½).
  const Vector2 half = project(camera.pinhole, p) + Vector2(0.5, 0.5);
  EXPECT_NEAR((project(twice.pinhole, p) + Vector2(0.5, 0.5) - 2 * half).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace plvo::bench

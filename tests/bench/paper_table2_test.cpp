// SPDX-License-Identifier: Apache-2.0
// Checks the paper's values against each other: the means weighted by frames follow from the rows.
#include "plvo/bench/sequences/paper_table2.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace plvo::bench {
namespace {

TEST(PaperTable2, MeansFollowFromTheRows) {
  const std::vector<Result> means = paper_results("mean");
  ASSERT_EQ(means.size(), 4U);
  for (std::size_t k = 0; k < means.size(); ++k) {
    double mm = 0, deg = 0, second = 0, frames = 0;
    for (const std::string& name : paper_sequences()) {
      const Result row = paper_results(name).at(k);
      mm += row.frames * row.estimate.rpe_frame_mm;
      deg += row.frames * row.estimate.rpe_frame_deg;
      second += row.frames * row.estimate.rpe_second_mm;
      frames += row.frames;
    }
    EXPECT_EQ(frames, means[k].frames);
    const Accuracy& mean = means[k].estimate;
    if (std::isfinite(mean.rpe_frame_mm)) {
      EXPECT_NEAR(mm / frames, mean.rpe_frame_mm, 0.1) << means[k].system;
      EXPECT_NEAR(deg / frames, mean.rpe_frame_deg, 0.01) << means[k].system;
    }
    if (std::isfinite(mean.rpe_second_mm)) {
      EXPECT_NEAR(second / frames, mean.rpe_second_mm, 1) << means[k].system;
    }
  }
}

TEST(PaperTable2, RecognisesSequencesByTheirFolders) {
  for (const char* folder : {"rgbd_dataset_freiburg1_rpy", "freiburg1_rpy", "fr1_rpy"}) {
    EXPECT_EQ(paper_sequence(folder).name, "rpy");
    EXPECT_TRUE(paper_sequence(folder).whole);
  }
  EXPECT_EQ(paper_sequence("fr1_rpy_150").name, "rpy");
  EXPECT_FALSE(paper_sequence("fr1_rpy_150").whole);
  EXPECT_EQ(paper_sequence("fr1_desk2").name, "desk2");
  for (const char* folder : {"fr2_desk", "fr1_moon", "corridor", ""})
    EXPECT_EQ(paper_sequence(folder).name, "");
  EXPECT_TRUE(paper_results("moon").empty());
}

}  // namespace
}  // namespace plvo::bench

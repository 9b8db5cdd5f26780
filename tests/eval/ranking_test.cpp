// SPDX-License-Identifier: Apache-2.0
// Tests the ranking of several estimates.
#include "plvo/eval/ranking.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace plvo::eval {
namespace {

// An estimate whose every step is `error_m` too long, at `frames` frames a tenth of a second apart.
NamedEvaluation named_estimate(const std::string& name, double error_m, int frames = 100) {
  Trajectory truth, poses;
  for (int i = 0; i < 100; ++i) {
    truth.poses.push_back({i * 100'000'000LL, {Matrix3::Identity(), Vector3(0.1 * i, 0, 0)}});
    if (i < frames)
      poses.poses.push_back({i * 100'000'000LL, {Matrix3::Identity(), Vector3((0.1 + error_m) * i, 0, 0)}});
  }
  NamedEvaluation result;
  result.name = name;
  EXPECT_TRUE(evaluate(truth, poses, {}, {}, {}, result.evaluation).ok());
  return result;
}

std::string order_of(const std::vector<NamedEvaluation>& estimates) {
  std::string names;
  for (const NamedEvaluation& e : estimates) names += e.name;
  return names;
}

TEST(Ranking, SortsByTheErrorOverASecond) {
  std::vector<NamedEvaluation> estimates = {named_estimate("b", 0.002), named_estimate("c", 0.003),
                                            named_estimate("a", 0.001)};
  rank(estimates);
  EXPECT_EQ(order_of(estimates), "abc");
  const std::string text = ranking_text(estimates);
  for (const char* words : {"ranked by the RMSE of the RPE over 1s", "RPE over 1f", "   1  a ", "   3  c ",
                            "identity", "   10.000"})
    EXPECT_NE(text.find(words), std::string::npos) << words << '\n' << text;
  const nlohmann::json json = ranking_json(estimates);
  EXPECT_EQ(json["ranked_by"], "rpe over 1s");
  EXPECT_EQ(json["estimates"][1]["estimate"], "b");
  EXPECT_EQ(json["estimates"][1]["rank"], 2);
  EXPECT_NEAR(json["estimates"][1]["rpe"][1]["translation_m"]["rmse"].get<double>(), 0.02, 1e-9);
  EXPECT_TRUE(doubts_about_ranking(estimates).empty());
}

TEST(Ranking, AnEstimateWithoutPairsIsLast) {
  std::vector<NamedEvaluation> estimates = {named_estimate("short", 0, 5), named_estimate("long", 0.01)};
  rank(estimates);
  EXPECT_EQ(order_of(estimates), "longshort");
  EXPECT_NE(ranking_text(estimates).find(" - "), std::string::npos);
}

TEST(Ranking, AnEstimateThatLeavesOutAPartIsNamed) {
  const std::vector<NamedEvaluation> estimates = {named_estimate("half", 0, 50),
                                                  named_estimate("whole", 0.01)};
  const std::vector<std::string> doubts = doubts_about_ranking(estimates);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(
      doubts[0],
      "half covers 4.9 s, another estimate 9.9 s: its errors are those of an easier part, where it lost the "
      "rest");
}

}  // namespace
}  // namespace plvo::eval

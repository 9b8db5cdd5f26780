// SPDX-License-Identifier: Apache-2.0
// The accuracy gate can fail: each figure that becomes worse is named, chance is not.
#include "baseline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

namespace plvo::accuracy {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<Figures> six_starts(double mm, double deg, double nees, int lost = 0) {
  std::vector<Figures> starts;
  for (const double part : {-1.0, -0.6, -0.2, 0.2, 0.6, 1.0})
    starts.push_back({mm * (1 + 0.1 * part), deg * (1 + 0.1 * part), nees * std::exp(0.1 * part), lost});
  return starts;
}

std::vector<std::string> compare(const std::vector<Figures>& before, const std::vector<Figures>& now) {
  return worse_by_more_than_chance(summarise("row", before), summarise("row", now));
}

TEST(AccuracyBaseline, AcceptsTheSameFiguresBetterOnesAndChance) {
  const auto before = six_starts(8, 0.8, 9);
  EXPECT_TRUE(compare(before, before).empty());
  EXPECT_TRUE(compare(before, six_starts(4, 0.4, 6)).empty());
  // One standard deviation of a mean of six: 8 × 0.075 / √6.
  EXPECT_TRUE(compare(before, six_starts(8.25, 0.825, 9.2)).empty());
}

TEST(AccuracyBaseline, NamesTheFigureThatIsWorse) {
  const auto before = six_starts(8, 0.8, 9);
  const auto translation = compare(before, six_starts(16, 0.8, 9));
  ASSERT_EQ(translation.size(), 1U);
  EXPECT_NE(translation[0].find("mm per second 8 -> 16"), std::string::npos) << translation[0];
  const auto rotation = compare(before, six_starts(8, 1.0, 9));
  ASSERT_EQ(rotation.size(), 1U);
  EXPECT_NE(rotation[0].find("degrees per second"), std::string::npos) << rotation[0];
}

// One start of six went wrong, before and now. The others became worse.
TEST(AccuracyBaseline, SeesThatMostStartsBecameWorseBesideOneThatWentWrong) {
  auto before = six_starts(8, 0.8, 9);
  before[2].translation_mm_per_s = 60;
  auto now = six_starts(10, 0.8, 9);
  now[2].translation_mm_per_s = 60;
  EXPECT_TRUE(compare(before, before).empty());
  const auto worse = compare(before, now);
  ASSERT_EQ(worse.size(), 1U);
  EXPECT_NE(worse[0].find("mm per second of most starts 8.032 -> 10.04"), std::string::npos) << worse[0];
  // The one that went wrong may be another one, or none.
  auto other = six_starts(8, 0.8, 9);
  other[5].translation_mm_per_s = 60;
  EXPECT_TRUE(compare(before, other).empty());
  EXPECT_TRUE(compare(before, six_starts(8, 0.8, 9)).empty());
}

TEST(AccuracyBaseline, RejectsACovarianceThatIsFartherFromTheTruthOnEitherSide) {
  const auto before = six_starts(8, 0.8, 9);
  EXPECT_EQ(compare(before, six_starts(8, 0.8, 18)).size(), 1U);
  EXPECT_EQ(compare(before, six_starts(8, 0.8, 1)).size(), 1U);
  EXPECT_TRUE(compare(before, six_starts(8, 0.8, 4)).empty());  // 6 / 4 is as far as 9 / 6
}

TEST(AccuracyBaseline, AcceptsASmallChangeWhereTheStartsAgree) {
  const std::vector<Figures> before(6, {8, 0.8, 6, 0});
  EXPECT_TRUE(compare(before, std::vector<Figures>(6, {8.1, 0.81, 6.2, 0})).empty());
  EXPECT_EQ(compare(before, std::vector<Figures>(6, {8.3, 0.83, 6.5, 0})).size(), 3U);
}

TEST(AccuracyBaseline, RejectsAFrameThatIsLostWhereNoneWas) {
  EXPECT_EQ(compare(six_starts(8, 0.8, 9, 0), six_starts(8, 0.8, 9, 1)).size(), 1U);
  EXPECT_TRUE(compare(six_starts(8, 0.8, 9, 6), six_starts(8, 0.8, 9, 8)).empty());  // 36 -> 48, 18 is chance
  EXPECT_EQ(compare(six_starts(8, 0.8, 9, 6), six_starts(8, 0.8, 9, 10)).size(), 1U);
}

TEST(AccuracyBaseline, RejectsAFigureThatNoLongerExists) {
  auto without = six_starts(8, 0.8, 9);
  without[3].translation_mm_per_s = kNaN;
  EXPECT_EQ(compare(six_starts(8, 0.8, 9), without).size(), 1U);
  EXPECT_TRUE(compare(without, without).empty());
}

TEST(AccuracyBaseline, ReadsBackWhatItWrites) {
  auto without = six_starts(8, 0.8, 9, 2);
  without[0].nees = kNaN;
  const std::vector<Row> rows = {summarise("a/both", six_starts(8, 0.8, 9)), summarise("b/lines", without)};
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "accuracy_baseline.csv";
  std::ofstream(path) << baseline_text(rows);
  std::vector<Row> read;
  const Status status = read_baseline(path, read);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(baseline_text(read), baseline_text(rows));
  std::ofstream(path) << baseline_text(rows) << "c/both,6,1\n";
  EXPECT_EQ(read_baseline(path, read).code(), StatusCode::kDamaged);
  std::filesystem::remove(path);
  EXPECT_EQ(read_baseline(path, read).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace plvo::accuracy

// SPDX-License-Identifier: Apache-2.0
// Tests the picture of `plvo eval --plot`.
#include "plvo/report/plot.hpp"

#include <gtest/gtest.h>

#include "plvo/report/svg.hpp"

namespace plvo::report {
namespace {

// A circle in the plane of x and z, which the estimate follows with a growing error of its height; the frames
// from `lost_from` to `lost_to` are lost.
eval::Evaluation circle(int lost_from, int lost_to, int frames = 200) {
  eval::Trajectory truth, estimate;
  for (int i = 0; i < frames; ++i) {
    const double a = 0.02 * i;
    const Se3 T{rotation_exp(Vector3(0, a, 0)), Vector3(std::cos(a), 0, std::sin(a))};
    truth.poses.push_back({i * 33'000'000LL, T});
    if (i >= lost_from && i < lost_to) continue;
    estimate.poses.push_back({i * 33'000'000LL, {T.R, T.t + Vector3(0, 1e-4 * i, 0)}});
  }
  eval::Evaluation evaluation;
  EXPECT_TRUE(eval::evaluate(truth, estimate, {}, {}, {}, evaluation).ok());
  return evaluation;
}

std::size_t count(const std::string& text, const std::string& words) {
  std::size_t found = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
  return found;
}

TEST(Plot, EachEstimateHasItsColourInEveryChart) {
  const eval::Evaluation first = circle(0, 0), second = circle(0, 0);
  const std::string svg = make_plot("title", {{"one", &first}, {"two", &second}});
  for (const char* words :
       {"z over x, m", "position error since the first pose, mm", "orientation error",
        "RPE over distance, translation", "RPE over distance, rotation", ">one<", ">two<"})
    EXPECT_EQ(count(svg, words), 1u) << words;
  // One curve in each of five charts, and the legend.
  EXPECT_EQ(count(svg, "<polyline fill=\"none\" stroke=\"" + css_colour(kCurves[0])), 6u);
  EXPECT_EQ(count(svg, "<polyline fill=\"none\" stroke=\"" + css_colour(kCurves[1])), 6u);
}

TEST(Plot, CurvesAreBrokenWhereFramesAreLost) {
  const eval::Evaluation whole = circle(0, 0), broken = circle(80, 120);
  const std::string stroke = "<polyline fill=\"none\" stroke=\"" + css_colour(kCurves[0]);
  // The trajectory and the two charts over time have two pieces.
  EXPECT_EQ(count(make_plot("", {{"", &broken}}), stroke), count(make_plot("", {{"", &whole}}), stroke) + 3);
}

TEST(Plot, NamesCannotEndTheTextThatHoldsThem) {
  const eval::Evaluation evaluation = circle(0, 0);
  const std::string svg = make_plot("a</text><script>alert(1)</script>&\x1b\xff", {{"<b>", &evaluation}});
  EXPECT_NE(svg.find("a&lt;/text&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;\\x1b\\xff"),
            std::string::npos);
  EXPECT_NE(svg.find("&lt;b&gt;"), std::string::npos);
  EXPECT_EQ(svg.find("<script"), std::string::npos);
}

TEST(Plot, LongRecordingsStaySmall) {
  const eval::Evaluation evaluation = circle(0, 0, 60'000);
  EXPECT_LT(make_plot("", {{"", &evaluation}}).size(), 200'000u);
}

TEST(Plot, WriteFailureIsAStatus) {
  const eval::Evaluation evaluation = circle(0, 0, 10);
  EXPECT_EQ(write_plot("/dev/full", "", {{"", &evaluation}}).code(), StatusCode::kIo);
}

std::string marks_of(const Axis& axis, int wanted) {
  std::string text;
  for (const auto& [value, label] : axis.marks(wanted)) text += label + ' ';
  return text;
}

TEST(PlotAxis, MarksAreRoundValuesWithinTheRange) {
  EXPECT_EQ(marks_of(Axis(0, 10, 0, 1), 5), "0 2 4 6 8 10 ");
  EXPECT_EQ(marks_of(Axis(-0.04, 0.113, 0, 1), 4), "0.00 0.05 0.10 ");
  EXPECT_EQ(marks_of(Axis(0.1, 5, 0, 1, Axis::Scale::kLogarithmic), 6), "0.1 0.2 0.5 1 2 5 ");
  EXPECT_EQ(Axis(3, 3, 100, 200).at(3), 150) << "an empty range has its value in the middle";
  EXPECT_EQ(Axis(1, 100, 0, 2, Axis::Scale::kLogarithmic).at(10), 1);
}

}  // namespace
}  // namespace plvo::report

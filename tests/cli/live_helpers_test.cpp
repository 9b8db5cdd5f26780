// SPDX-License-Identifier: Apache-2.0
// Tests the counters of `plvo live`, the parser of video modes and the judgement of a test capture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plvo/cli/common/duration_histogram.hpp"
#include "plvo/cli/doctor/doctor_capture.hpp"
#include "plvo/cli/live/rate_meter.hpp"

namespace plvo::cli {
namespace {

TEST(DurationHistogram, QuantilesAreThoseOfTheSortedValues) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile_ms(0.5), 0);
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(0.05 * std::exp(0.01 * (i * 377 % 1000)));
  for (double value : values) histogram.add(value);
  std::sort(values.begin(), values.end());
  for (double q : {0.01, 0.25, 0.5, 0.95, 0.99, 1.0}) {
    const double exact = values[static_cast<std::size_t>(q * 1000) - 1];
    EXPECT_GE(histogram.quantile_ms(q), exact * (1 - 1e-12)) << q;
    EXPECT_LE(histogram.quantile_ms(q), exact * 1.008) << q;
  }
  EXPECT_EQ(histogram.max_ms(), values.back());
  EXPECT_EQ(histogram.count(), 1000u);
}

TEST(DurationHistogram, AcceptsAnyDuration) {
  DurationHistogram histogram;
  for (double ms : {-1.0, 0.0, 1e9}) histogram.add(ms);
  EXPECT_EQ(histogram.max_ms(), 1e9);
  EXPECT_LE(histogram.quantile_ms(0.5), 0.0101);
}

TEST(RateMeter, GivesTheRateOfTheLastSecond) {
  RateMeter meter;
  EXPECT_EQ(meter.hz(0), 0);
  std::int64_t now = 0;
  for (int i = 0; i < 100; ++i) meter.tick(now += 100'000'000);
  for (int i = 0; i < 40; ++i) meter.tick(now += 20'000'000);
  EXPECT_NEAR(meter.hz(now), 50, 1e-9);
  EXPECT_EQ(meter.hz(now + 1'500'000'000), 0);
}

TEST(VideoMode, IsReadOrRefused) {
  VideoMode mode;
  ASSERT_TRUE(parse_video_mode("320x240@60", mode));
  EXPECT_EQ(mode.width * 1000000 + mode.height * 1000 + mode.fps, 320240060);
  ASSERT_TRUE(parse_video_mode("640x480", mode));
  EXPECT_EQ(mode.fps, 30);
  for (const char* text :
       {"", "640", "x480", "640x", "640x480@", "640x480@x", "-1x5", "1e3x5", "640x480@30 ", "@640x480"})
    EXPECT_FALSE(parse_video_mode(text, mode)) << text;
}

CaptureFacts good_capture() {
  CaptureFacts facts;
  facts.tried = true;
  facts.name = "Kinect";
  facts.mode = {640, 480, 30};
  facts.seconds = 3;
  facts.counters.frames = 90;
  facts.mean_brightness = 100;
  facts.depth_share = 0.7;
  facts.depth_time_known = true;
  return facts;
}
std::string code_of(const CaptureFacts& facts) {
  const auto findings = judge(facts);
  return findings.size() == 1 ? findings[0].code : "several";
}

TEST(DoctorCapture, EachFaultHasItsCode) {
  CaptureFacts facts = good_capture();
  EXPECT_EQ(code_of(facts), "capture_good");
  EXPECT_NEAR(facts.megabytes_per_s(), 46.08, 1e-9);
  facts.counters.frames = 70;
  EXPECT_EQ(code_of(facts), "slow");
  facts = good_capture();
  facts.mean_brightness = 3;
  EXPECT_EQ(code_of(facts), "dark");
  facts = good_capture();
  facts.depth_share = 0;
  EXPECT_EQ(code_of(facts), "no_depth");
  facts.counters.frames = 0;
  EXPECT_EQ(code_of(facts), "no_frames");
  facts.opened = {StatusCode::kBusy, "busy"};
  EXPECT_EQ(code_of(facts), "not_opened");
  EXPECT_TRUE(judge(CaptureFacts()).empty()) << "nothing was tried";
}

TEST(DoctorCapture, SuggestsCalibrationIfDepthTimingIsUnknown) {
  CaptureFacts facts = good_capture();
  facts.depth_time_known = false;
  const auto findings = judge(facts);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].code, "capture_good");
  EXPECT_EQ(findings[1].code, "depth_time_unknown");
  EXPECT_EQ(findings[1].severity, Severity::kNote);
  EXPECT_NE(findings[1].remedy.find("plvo calibrate"), std::string::npos);
}

}  // namespace
}  // namespace plvo::cli

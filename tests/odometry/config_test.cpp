// SPDX-License-Identifier: Apache-2.0
// Each number of Config and Limits has a range; init checks it and the message states it. The test repeats
// the ranges, so that every change of one is noticed.
#include "plvo/odometry/config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace plvo {
namespace {

// A number by its name, with its bounds as the message states them. with() puts a value into settings that
// are otherwise valid.
struct Entry {
  std::string name, low, high;
  std::function<Status(double)> with;
  bool whole = false;
};

template <typename Number>
Entry entry_of(const char* name, const char* low, const char* high, Number& (*of)(Config&)) {
  return {name, low, high,
          [of](double value) {
            Config config;
            of(config) = static_cast<Number>(value);
            return config.validate();
          },
          std::is_integral_v<Number>};
}
Entry limit_of(const char* name, const char* low, const char* high, int Limits::*member) {
  return {name, low, high,
          [member](double value) {
            Limits limits;
            limits.*member = static_cast<int>(value);
            return limits.validate();
          },
          true};
}

#define PLVO_ENTRY(path, low, high) \
  entry_of(                         \
      #path, low, high, +[](Config & config) -> auto& { return config.path; })
#define PLVO_LIMIT(member, low, high) limit_of("Limits::" #member, low, high, &Limits::member)

std::vector<Entry> all_entries() {
  return {PLVO_ENTRY(depth_noise.c1, "-1", "1"),
          PLVO_ENTRY(depth_noise.c2, "-1", "1"),
          PLVO_ENTRY(depth_noise.c3, "-1", "1"),
          PLVO_ENTRY(depth_noise.floor_m, "0.000001", "1"),
          PLVO_ENTRY(depth_noise.registration_px, "0", "20"),
          PLVO_ENTRY(points.sigma_px, "0.01", "20"),
          PLVO_ENTRY(points.depth_reach_px, "0", "3"),
          PLVO_ENTRY(lines.sample_spacing_px, "1", "1000"),
          PLVO_ENTRY(lines.min_agreement, "0", "1"),
          PLVO_ENTRY(lines.sigma_p_px, "0.01", "20"),
          PLVO_ENTRY(lines.side_reach_px, "0", "5"),
          PLVO_ENTRY(lines.depth_correlation_px, "0.01", "1000"),
          PLVO_ENTRY(lines.transverse_floor_px, "0", "20"),
          PLVO_ENTRY(noise.learning_rate, "0", "0.5"),
          PLVO_ENTRY(noise.angular_rate_error_rad_per_s, "0", "10"),
          PLVO_ENTRY(noise.shared_depth_m, "0", "1"),
          PLVO_ENTRY(noise.point_correlation, "0", "1"),
          PLVO_ENTRY(noise.line_correlation, "0", "1"),
          PLVO_ENTRY(noise.surface_correlation, "0", "1"),
          PLVO_ENTRY(noise.common_mode_share, "0", "1"),
          PLVO_ENTRY(motion.max_ransac_iterations, "1", "100000"),
          PLVO_ENTRY(motion.min_inliers, "3", "10000"),
          PLVO_ENTRY(motion.max_sigma_m, "0.000001", "100"),
          PLVO_ENTRY(motion.max_sigma_rad, "0.000001", "10"),
          PLVO_ENTRY(references.keyframe_inlier_ratio, "0", "1"),
          PLVO_ENTRY(references.max_lost_s, "0", "1000000"),
          PLVO_ENTRY(references.process_noise_m_per_s, "0", "100"),
          PLVO_ENTRY(references.process_noise_rad_per_s, "0", "100"),
          PLVO_ENTRY(budget.frame_ns, "0", "1000000000000"),
          PLVO_ENTRY(budget.patience_frames, "1", "1000000"),
          PLVO_ENTRY(budget.spare_share, "0", "1"),
          PLVO_LIMIT(width, "64", "2047"),
          PLVO_LIMIT(height, "64", "2047"),
          PLVO_LIMIT(keypoints, "10", "60000"),
          PLVO_LIMIT(segments, "1", "60000"),
          PLVO_LIMIT(references, "1", "3"),
          PLVO_LIMIT(line_bands, "1", "8"),
          PLVO_LIMIT(kept_keyframes, "0", "4"),
          PLVO_LIMIT(cores, "1", "2"),
          PLVO_LIMIT(surfaces, "0", "1000")};
}

TEST(Config, RefusesEveryNumberOutsideItsRangeAndStatesTheRange) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Entry& entry : all_entries()) {
    const std::string refusal =
        "config: " + entry.name + " must lie between " + entry.low + " and " + entry.high;
    const double low = std::stod(entry.low), high = std::stod(entry.high);
    std::vector<double> outside{-1e6, entry.whole ? low - 1 : std::nextafter(low, -kInfinity),
                                entry.whole ? high + 1 : std::nextafter(high, kInfinity)};
    if (!entry.whole) outside.insert(outside.end(), {std::numeric_limits<double>::quiet_NaN(), kInfinity});
    for (const double value : outside) {
      const Status refused = entry.with(value);
      EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument) << entry.name << " = " << value;
      EXPECT_EQ(refused.message(), refusal) << "for " << value;
    }
    for (const double value : {low, high})
      EXPECT_TRUE(entry.with(value).ok()) << entry.with(value).message() << ", but it is " << value;
  }
}

// One of the four kept keyframes is replaced by the third reference.
TEST(Config, AllowsThreeKeptKeyframesWithThreeReferences) {
  Limits limits;
  limits.references = 3;
  limits.kept_keyframes = 3;
  EXPECT_TRUE(limits.validate().ok()) << limits.validate().message();
  limits.kept_keyframes = 4;
  EXPECT_STREQ(limits.validate().message(), "config: Limits::kept_keyframes must lie between 0 and 3");
}

TEST(Config, AcceptsTheRecommendedSettings) {
  for (const Config& config : {Config{}, Config::paper(), Config::tiny()})
    EXPECT_TRUE(config.validate().ok()) << config.validate().message();
  for (const Limits& limits : {Limits{}, Limits::vga(), Limits::qvga(), Limits::tiny()})
    EXPECT_TRUE(limits.validate().ok()) << limits.validate().message();
}

}  // namespace
}  // namespace plvo

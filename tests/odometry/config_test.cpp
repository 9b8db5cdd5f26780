// SPDX-License-Identifier: Apache-2.0
// Every number of Config and Limits has a range, which the message tells and which is the one that is
// checked.
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

// A number by its name, put into settings that are good but for it.
struct Entry {
  std::string name;
  std::function<Status(double)> with;
  bool whole = false;
};

template <typename Number>
Entry entry_of(const char* name, Number& (*of)(Config&)) {
  return {name,
          [of](double value) {
            Config config;
            of(config) = static_cast<Number>(value);
            return config.validate();
          },
          std::is_integral_v<Number>};
}
Entry limit_of(const char* name, int Limits::*member) {
  return {name,
          [member](double value) {
            Limits limits;
            limits.*member = static_cast<int>(value);
            return limits.validate();
          },
          true};
}

#define PLVO_ENTRY(path) \
  entry_of(              \
      #path, +[](Config & config) -> auto& { return config.path; })
#define PLVO_LIMIT(member) limit_of("Limits::" #member, &Limits::member)

std::vector<Entry> all_entries() {
  return {PLVO_ENTRY(depth_noise.c1),
          PLVO_ENTRY(depth_noise.c2),
          PLVO_ENTRY(depth_noise.c3),
          PLVO_ENTRY(depth_noise.floor_m),
          PLVO_ENTRY(depth_noise.registration_px),
          PLVO_ENTRY(points.sigma_px),
          PLVO_ENTRY(points.depth_reach_px),
          PLVO_ENTRY(points.detector.levels),
          PLVO_ENTRY(points.detector.cell_px),
          PLVO_ENTRY(points.detector.noise_floor),
          PLVO_ENTRY(points.detector.min_strength),
          PLVO_ENTRY(points.match.radius_px),
          PLVO_ENTRY(points.match.max_distance),
          PLVO_ENTRY(points.match.max_ratio),
          PLVO_ENTRY(lines.fit.max_samples),
          PLVO_ENTRY(lines.fit.sample_spacing_px),
          PLVO_ENTRY(lines.fit.min_consensus),
          PLVO_ENTRY(lines.fit.min_agreement),
          PLVO_ENTRY(lines.fit.sigma_p_px),
          PLVO_ENTRY(lines.fit.inlier_chi_square),
          PLVO_ENTRY(lines.fit.max_ransac_iterations),
          PLVO_ENTRY(lines.fit.side_reach_px),
          PLVO_ENTRY(lines.fit.depth_correlation_px),
          PLVO_ENTRY(lines.fit.transverse_floor_px),
          PLVO_ENTRY(lines.match.max_angle_rad),
          PLVO_ENTRY(lines.match.max_offset_px),
          PLVO_ENTRY(lines.match.min_overlap),
          PLVO_ENTRY(lines.match.max_distance),
          PLVO_ENTRY(lines.match.max_ratio),
          PLVO_ENTRY(lines.match.same_line_px),
          PLVO_ENTRY(lines.match.same_line_rad),
          PLVO_ENTRY(lines.guided_offset_px),
          PLVO_ENTRY(lines.guided_angle_rad),
          PLVO_ENTRY(noise.initial.image),
          PLVO_ENTRY(noise.initial.depth),
          PLVO_ENTRY(noise.initial.lines),
          PLVO_ENTRY(noise.initial.surfaces),
          PLVO_ENTRY(noise.initial.turning),
          PLVO_ENTRY(noise.initial.shared_depth),
          PLVO_ENTRY(noise.learning_rate),
          PLVO_ENTRY(noise.turning_rad_per_s),
          PLVO_ENTRY(noise.shared_depth_m),
          PLVO_ENTRY(noise.point_correlation),
          PLVO_ENTRY(noise.line_correlation),
          PLVO_ENTRY(noise.surface_correlation),
          PLVO_ENTRY(noise.repeated_share),
          PLVO_ENTRY(noise.depth_moment_s),
          PLVO_ENTRY(noise.depth_offset_m),
          PLVO_ENTRY(motion.inlier_probability),
          PLVO_ENTRY(motion.ransac_confidence),
          PLVO_ENTRY(motion.max_ransac_iterations),
          PLVO_ENTRY(motion.min_inliers),
          PLVO_ENTRY(motion.min_inlier_ratio),
          PLVO_ENTRY(motion.max_sigma_m),
          PLVO_ENTRY(motion.max_sigma_rad),
          PLVO_ENTRY(references.keyframe_inlier_ratio),
          PLVO_ENTRY(references.window_inlier_ratio),
          PLVO_ENTRY(references.older_inlier_ratio),
          PLVO_ENTRY(references.wide_search_px),
          PLVO_ENTRY(references.max_lost_frames),
          PLVO_ENTRY(references.unseen_m_per_s),
          PLVO_ENTRY(references.unseen_rad_per_s),
          PLVO_ENTRY(references.recent_frames),
          PLVO_ENTRY(references.look_back_frames),
          PLVO_ENTRY(budget.frame_ns),
          PLVO_ENTRY(budget.patience_frames),
          PLVO_ENTRY(budget.spare_share),
          PLVO_LIMIT(width),
          PLVO_LIMIT(height),
          PLVO_LIMIT(keypoints),
          PLVO_LIMIT(segments),
          PLVO_LIMIT(references),
          PLVO_LIMIT(line_bands),
          PLVO_LIMIT(kept_keyframes),
          PLVO_LIMIT(cores),
          PLVO_LIMIT(surfaces)};
}

// "config: NAME must lie between LOW and HIGH", or nothing.
bool bounds_of(const std::string& name, const std::string& message, double& low, double& high) {
  const std::string start = "config: " + name + " must lie between ", middle = " and ";
  const std::size_t at = message.find(middle, start.size());
  if (message.rfind(start, 0) != 0 || at == std::string::npos) return false;
  std::size_t read = 0;
  low = std::stod(message.substr(start.size(), at - start.size()), &read);
  if (read != at - start.size()) return false;
  const std::string rest = message.substr(at + middle.size());
  high = std::stod(rest, &read);
  return read == rest.size();
}

TEST(Config, EveryNumberIsHeldToTheRangeThatTheMessageTells) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Entry& entry : all_entries()) {
    const Status refused = entry.with(-1e6);
    EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument) << entry.name;
    double low = 0, high = 0;
    ASSERT_TRUE(bounds_of(entry.name, refused.message(), low, high)) << entry.name << refused.message();
    ASSERT_LT(low, high) << entry.name;
    EXPECT_TRUE(entry.with(low).ok()) << entry.name;
    EXPECT_TRUE(entry.with(high).ok()) << entry.name;
    EXPECT_FALSE(entry.with(entry.whole ? low - 1 : std::nextafter(low, -kInfinity)).ok()) << entry.name;
    EXPECT_FALSE(entry.with(entry.whole ? high + 1 : std::nextafter(high, kInfinity)).ok()) << entry.name;
    if (entry.whole) continue;
    EXPECT_FALSE(entry.with(std::numeric_limits<double>::quiet_NaN()).ok()) << entry.name;
    EXPECT_FALSE(entry.with(kInfinity).ok()) << entry.name;
  }
}

TEST(Config, BoundsAreWrittenAsPeopleDo) {
  Config config;
  config.motion.ransac_confidence = 1;
  EXPECT_STREQ(config.validate().message(),
               "config: motion.ransac_confidence must lie between 0.5 and 0.999999");
  config = {};
  config.depth_noise.c3 = 2;
  EXPECT_STREQ(config.validate().message(), "config: depth_noise.c3 must lie between -1 and 1");
  config = {};
  config.depth_noise.floor_m = 0;
  EXPECT_STREQ(config.validate().message(), "config: depth_noise.floor_m must lie between 0.000001 and 1");
  config = {};
  config.budget.frame_ns = -1;
  EXPECT_STREQ(config.validate().message(), "config: budget.frame_ns must lie between 0 and 1000000000000");
}

TEST(Config, WhatWeRecommendIsAllowed) {
  for (const Config& config : {Config{}, Config::paper(), Config::tiny()})
    EXPECT_TRUE(config.validate().ok()) << config.validate().message();
  for (const Limits& limits : {Limits{}, Limits::vga(), Limits::qvga(), Limits::tiny()})
    EXPECT_TRUE(limits.validate().ok()) << limits.validate().message();
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/config.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "plvo/image/depth_sampler.hpp"
#include "plvo/motion/motion_problem.hpp"
#include "plvo/odometry/window/kept_keyframes.hpp"

namespace plvo {
namespace {

// A bounded entry of a group of settings. Both bounds are allowed; NaN is not. The names of a group's entries
// stand apart, each with a zero behind it: a table with pointers would be no constant in a shared library.
struct SettingRange {
  enum class Type : std::uint8_t { kDouble, kInt, kNanoseconds };  // bounds of the last in seconds

  std::uint16_t offset;  // in the group, bytes
  Type type;
  float low, high;
};

template <typename T>
double value_at(const std::byte* group, const SettingRange& range) {
  T value;
  std::memcpy(&value, group + range.offset, sizeof value);
  return static_cast<double>(value);
}

// Keeps the first number that is outside its range. Each range appears once; the message is built from it.
class RangeCheck {
 public:
  template <typename Group>
  void check(const char* name, const Group& group, const char* entries,
             std::span<const SettingRange> ranges) {
    static_assert(std::is_standard_layout_v<Group>);
    check_bytes(name, reinterpret_cast<const std::byte*>(&group), entries, ranges);
  }
  const Status& status() const { return status_; }

 private:
  [[gnu::noinline]] void check_bytes(const char* name, const std::byte* group, const char* entry,
                                     std::span<const SettingRange> ranges) {
    for (const SettingRange& range : ranges) {
      const double value = range.type == SettingRange::Type::kDouble ? value_at<double>(group, range)
                           : range.type == SettingRange::Type::kInt  ? value_at<int>(group, range)
                                                                     : value_at<std::int64_t>(group, range);
      const double unit = range.type == SettingRange::Type::kNanoseconds ? 1e9 : 1;
      const double low = unit * decimal(range.low), high = unit * decimal(range.high);
      const char* const its_name = entry;
      while (*entry++ != 0) {
      }
      if (!status_.ok() || (value >= low && value <= high)) continue;
      status_ = Status(StatusCode::kInvalidArgument, "config: ")
                    .append(name)
                    .append(its_name)
                    .append(" must lie between ");
      append_bound(low);
      status_.append(" and ");
      append_bound(high);
    }
  }

  // The number of at most six decimals that a float stands for.
  [[gnu::noinline]] static double decimal(float bound) {
    constexpr double kRounds = 6755399441055744.0;  // 1.5 · 2⁵²: a sum with it is a whole number
    return (static_cast<double>(bound) * 1e6 + kRounds - kRounds) / 1e6;
  }

  // Appends the bound in decimal, with up to six decimals. It does without the C library. It works in doubles
  // because small processors divide those in hardware, but 64-bit integers in a long function.
  void append_bound(double bound) {
    constexpr double kPerOne = 1e6;
    if (bound < 0) status_.append("-");
    double rest = (bound < 0 ? -bound : bound) * kPerOne + 0.5;
    double power = kPerOne;
    while (power * 10 <= rest) power *= 10;
    for (; power >= kPerOne || rest >= 1; power /= 10) {
      if (power * 10 == kPerOne) status_.append(".");
      const int digit = static_cast<int>(rest / power);
      rest -= digit * power;
      status_.append(digit);
    }
  }

  Status status_;
};

constexpr char kDepthNoiseEntries[] =
    "c1\0"
    "c2\0"
    "c3\0"
    "floor_m\0"
    "registration_px\0";
constexpr SettingRange kDepthNoiseRanges[] = {
    {offsetof(DepthNoise, c1), SettingRange::Type::kDouble, -1, 1},
    {offsetof(DepthNoise, c2), SettingRange::Type::kDouble, -1, 1},
    {offsetof(DepthNoise, c3), SettingRange::Type::kDouble, -1, 1},
    {offsetof(DepthNoise, floor_m), SettingRange::Type::kDouble, 1e-6F, 1},
    {offsetof(DepthNoise, registration_px), SettingRange::Type::kDouble, 0, 20},
};
constexpr char kPointsEntries[] =
    "sigma_px\0"
    "depth_reach_px\0";
constexpr SettingRange kPointsRanges[] = {
    {offsetof(PointConfig, sigma_px), SettingRange::Type::kDouble, 0.01F, 20},
    {offsetof(PointConfig, depth_reach_px), SettingRange::Type::kInt, 0, DepthSampler::kMaxRadius},
};
constexpr char kNoiseEntries[] =
    "learning_rate\0"
    "angular_rate_error_rad_per_s\0"
    "shared_depth_m\0"
    "point_correlation\0"
    "line_correlation\0"
    "surface_correlation\0"
    "common_mode_share\0";
constexpr SettingRange kNoiseRanges[] = {
    {offsetof(NoiseConfig, learning_rate), SettingRange::Type::kDouble, 0, 0.5F},
    {offsetof(NoiseConfig, angular_rate_error_rad_per_s), SettingRange::Type::kDouble, 0, 10},
    {offsetof(NoiseConfig, shared_depth_m), SettingRange::Type::kDouble, 0, 1},
    {offsetof(NoiseConfig, point_correlation), SettingRange::Type::kDouble, 0, 1},
    {offsetof(NoiseConfig, line_correlation), SettingRange::Type::kDouble, 0, 1},
    {offsetof(NoiseConfig, surface_correlation), SettingRange::Type::kDouble, 0, 1},
    {offsetof(NoiseConfig, common_mode_share), SettingRange::Type::kDouble, 0, 1},
};
constexpr char kLinesEntries[] =
    "sample_spacing_px\0"
    "min_agreement\0"
    "sigma_p_px\0"
    "side_reach_px\0"
    "depth_correlation_px\0"
    "transverse_floor_px\0";
constexpr SettingRange kLinesRanges[] = {
    {offsetof(Line3dConfig, sample_spacing_px), SettingRange::Type::kDouble, 1, 1000},
    {offsetof(Line3dConfig, min_agreement), SettingRange::Type::kDouble, 0, 1},
    {offsetof(Line3dConfig, sigma_p_px), SettingRange::Type::kDouble, 0.01F, 20},
    {offsetof(Line3dConfig, side_reach_px), SettingRange::Type::kInt, 0, kMaxSideReach},
    {offsetof(Line3dConfig, depth_correlation_px), SettingRange::Type::kDouble, 0.01F, 1000},
    {offsetof(Line3dConfig, transverse_floor_px), SettingRange::Type::kDouble, 0, 20},
};
constexpr char kMotionEntries[] =
    "max_ransac_iterations\0"
    "min_inliers\0"
    "max_sigma_m\0"
    "max_sigma_rad\0";
constexpr SettingRange kMotionRanges[] = {
    {offsetof(MotionConfig, max_ransac_iterations), SettingRange::Type::kInt, 1, 100000},
    {offsetof(MotionConfig, min_inliers), SettingRange::Type::kInt, 3, 10000},
    {offsetof(MotionConfig, max_sigma_m), SettingRange::Type::kDouble, 1e-6F, 100},
    {offsetof(MotionConfig, max_sigma_rad), SettingRange::Type::kDouble, 1e-6F, 10},
};
constexpr char kReferencesEntries[] =
    "keyframe_inlier_ratio\0"
    "max_lost_s\0"
    "process_noise_m_per_s\0"
    "process_noise_rad_per_s\0";
constexpr SettingRange kReferencesRanges[] = {
    {offsetof(ReferenceConfig, keyframe_inlier_ratio), SettingRange::Type::kDouble, 0, 1},
    {offsetof(ReferenceConfig, max_lost_s), SettingRange::Type::kDouble, 0, 1000000},
    {offsetof(ReferenceConfig, process_noise_m_per_s), SettingRange::Type::kDouble, 0, 100},
    {offsetof(ReferenceConfig, process_noise_rad_per_s), SettingRange::Type::kDouble, 0, 100},
};
constexpr char kBudgetEntries[] =
    "frame_ns\0"
    "patience_frames\0"
    "spare_share\0";
constexpr SettingRange kBudgetRanges[] = {
    {offsetof(BudgetConfig, frame_ns), SettingRange::Type::kNanoseconds, 0, 1000},
    {offsetof(BudgetConfig, patience_frames), SettingRange::Type::kInt, 1, 1000000},
    {offsetof(BudgetConfig, spare_share), SettingRange::Type::kDouble, 0, 1},
};

constexpr char kLimitsEntries[] =
    "width\0"
    "height\0"
    "keypoints\0"
    "segments\0"
    "references\0"
    "line_bands\0"
    "cores\0"
    "surfaces\0";
constexpr SettingRange kLimitsRanges[] = {
    {offsetof(Limits, width), SettingRange::Type::kInt, Limits::kLeastSide, Limits::kMostSide},
    {offsetof(Limits, height), SettingRange::Type::kInt, Limits::kLeastSide, Limits::kMostSide},
    {offsetof(Limits, keypoints), SettingRange::Type::kInt, 10, 60000},
    {offsetof(Limits, segments), SettingRange::Type::kInt, 1, 60000},
    {offsetof(Limits, references), SettingRange::Type::kInt, 1, kMaxReferences},
    {offsetof(Limits, line_bands), SettingRange::Type::kInt, 1, 8},
    {offsetof(Limits, cores), SettingRange::Type::kInt, 1, 2},
    {offsetof(Limits, surfaces), SettingRange::Type::kInt, 0, 1000},
};

}  // namespace

Status Limits::validate() const {
  RangeCheck ranges;
  ranges.check("Limits::", *this, kLimitsEntries, kLimitsRanges);
  const int most_kept = std::min(kMostKeptKeyframes, kMostOtherFrames - references);
  const SettingRange kept{offsetof(Limits, kept_keyframes), SettingRange::Type::kInt, 0,
                          static_cast<float>(most_kept)};
  ranges.check("Limits::", *this, "kept_keyframes", {&kept, 1});
  return ranges.status();
}

Status Config::validate() const {
  RangeCheck ranges;
  ranges.check("depth_noise.", depth_noise, kDepthNoiseEntries, kDepthNoiseRanges);
  ranges.check("points.", points, kPointsEntries, kPointsRanges);
  ranges.check("lines.", lines, kLinesEntries, kLinesRanges);
  ranges.check("noise.", noise, kNoiseEntries, kNoiseRanges);
  ranges.check("references.", references, kReferencesEntries, kReferencesRanges);
  ranges.check("budget.", budget, kBudgetEntries, kBudgetRanges);
  ranges.check("motion.", motion, kMotionEntries, kMotionRanges);
  return ranges.status();
}

Config Config::paper() {
  Config config;
  config.surfaces = false;
  config.references.policy = ReferencePolicy::kPreviousFrame;
  config.depth_noise.registration_px = 0;
  config.noise = {.learning_rate = 0,
                  .angular_rate_error_rad_per_s = 0,
                  .shared_depth_m = 0,
                  .point_correlation = 0,
                  .line_correlation = 0,
                  .common_mode_share = 0};
  config.points.registered = false;
  config.points.sigma_px = 1;
  config.points.depth_reach_px = 0;
  config.lines = Line3dConfig::paper();
  config.motion.robust = false;
  return config;
}

Config Config::tiny() {
  Config config;
  config.references.policy = ReferencePolicy::kKeyframe;
  return config;
}

}  // namespace plvo

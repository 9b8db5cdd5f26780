// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/index/stamp_order.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "plvo/host/files/stamp_text.hpp"
#include "plvo/replay/index/stamp_pairs.hpp"

namespace plvo {
namespace {

constexpr long double kMost_ns = 9e18L;              // safely within an int64
constexpr double kShortSteps = 0.75, kGapSteps = 3;  // of the median
constexpr double kOffsetSteps = 1.5;
constexpr double kSameSteps = 0.5;  // tolerance between the offsets at the two ends
constexpr double kSameShare = 0.1;
constexpr std::size_t kFewestForOffset = 5;

// The difference of two stamps may exceed an int64.
double seconds(std::int64_t later, std::int64_t earlier) {
  return static_cast<double>((static_cast<long double>(later) - static_cast<long double>(earlier)) * 1e-9L);
}

// Measures how uneven the forward steps of a list are: a gap counts like two steps that are too short.
int unevenness(const std::vector<std::int64_t>& stamps, double median_s) {
  int uneven = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] < stamps[i - 1]) continue;
    const double step_s = seconds(stamps[i], stamps[i - 1]);
    if (step_s < kShortSteps * median_s) ++uneven;
    if (step_s > kGapSteps * median_s) uneven += 2;
  }
  return uneven;
}

// The clock was set back if sorting makes the steps more uneven.
bool is_clock_step(const std::vector<std::int64_t>& stamps) {
  const double median_s = static_cast<double>(median_step_ns(stamps)) * 1e-9;
  if (median_s <= 0) return false;
  std::vector<std::int64_t> sorted = stamps;
  std::sort(sorted.begin(), sorted.end());
  return unevenness(sorted, median_s) >= unevenness(stamps, median_s) + 2;
}

}  // namespace

std::optional<StampFault> find_stamp_fault(const std::vector<std::int64_t>& stamps) {
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) continue;
    if (stamps[i] == stamps[i - 1]) return StampFault{StampFault::Kind::kRepeated, i, 0};
    if (!is_clock_step(stamps)) return StampFault{StampFault::Kind::kUnsorted, i, 0};
    const double step_s =
        seconds(stamps[i - 1], stamps[i]) + static_cast<double>(median_step_ns(stamps)) * 1e-9;
    const long double step_ns = std::min(static_cast<long double>(step_s) * 1e9L, kMost_ns);
    return StampFault{StampFault::Kind::kClockStep, i, std::llround(step_ns)};
  }
  return {};
}

std::string in_words(const StampFault& fault, const std::vector<std::int64_t>& stamps) {
  const std::string stamp = format_stamp(stamps[fault.at]);
  if (fault.kind == StampFault::Kind::kClockStep)
    return fmt::format(
        "the clock steps back by {:.3f} s, to {}; do not sort, which would mix before and after: from here "
        "on, add the step to the stamps of both lists, or end the lists here",
        static_cast<double>(fault.step_ns) * 1e-9, stamp);
  return fmt::format("stamp {} {}; sort the list by stamp and keep each stamp once", stamp,
                     fault.kind == StampFault::Kind::kRepeated ? "appears twice" : "runs backwards");
}

std::optional<std::int64_t> clock_offset_ns(const std::vector<std::int64_t>& first,
                                            const std::vector<std::int64_t>& second) {
  if (std::min(first.size(), second.size()) < kFewestForOffset) return {};
  const std::int64_t step_ns = std::max(median_step_ns(first), median_step_ns(second));
  const double step_s = static_cast<double>(step_ns) * 1e-9;
  const double begin_s = seconds(second.front(), first.front()), end_s = seconds(second.back(), first.back());
  const double shorter_s =
      std::min(seconds(first.back(), first.front()), seconds(second.back(), second.front()));
  const double least_s = std::min(std::abs(begin_s), std::abs(end_s));
  if (least_s <= kOffsetSteps * step_s || std::signbit(begin_s) != std::signbit(end_s) ||
      std::abs(begin_s - end_s) > std::max(kSameSteps * step_s, kSameShare * std::min(least_s, shorter_s)))
    return {};
  // Frames may be missing at either end: the pairs give the offset to less than a step.
  const auto rough = static_cast<long double>(begin_s + end_s) / 2 * 1e9L;
  std::vector<std::int64_t> shifted;
  for (const std::int64_t stamp : second) {
    const long double moved = static_cast<long double>(stamp) - rough;
    if (std::abs(moved) > kMost_ns) return {};
    shifted.push_back(std::llround(moved));
  }
  std::vector<double> rest;
  for (const auto& [i, j] : associate(first, shifted, step_ns)) rest.push_back(seconds(shifted[j], first[i]));
  if (rest.empty()) return {};
  const auto middle = rest.begin() + static_cast<std::ptrdiff_t>(rest.size() / 2);
  std::nth_element(rest.begin(), middle, rest.end());
  const long double offset = rough + static_cast<long double>(*middle) * 1e9L;
  if (std::abs(offset) > kMost_ns) return {};
  return std::llround(offset);
}

std::string why_no_pair(const std::vector<std::int64_t>& colour, const std::vector<std::int64_t>& depth) {
  if (const std::string doubt = stamp_unit_doubt(colour); !doubt.empty())
    return "the stamps are not in seconds: " + doubt;
  if (const std::optional<std::int64_t> offset = clock_offset_ns(colour, depth))
    return fmt::format("the clock of depth is {:.3f} s {}: subtract that from the stamps of depth",
                       std::abs(static_cast<double>(*offset)) * 1e-9, *offset > 0 ? "ahead" : "behind");
  return fmt::format("colour's stamps go from {} to {}, depth's from {} to {}", format_stamp(colour.front()),
                     format_stamp(colour.back()), format_stamp(depth.front()), format_stamp(depth.back()));
}

std::string doubt_about_clocks(const std::vector<std::int64_t>& colour,
                               const std::vector<std::int64_t>& depth) {
  if (const std::string doubt = stamp_unit_doubt(colour); !doubt.empty())
    return "the stamps look wrong: " + doubt;
  const std::optional<std::int64_t> offset = clock_offset_ns(colour, depth);
  if (!offset) return {};
  return fmt::format(
      "depth begins and ends {:.3f} s {} than colour: if its clock is {} by as much, pairs are of different "
      "moments, and the stamps of depth must be moved by {:+.3f} s",
      std::abs(static_cast<double>(*offset)) * 1e-9, *offset > 0 ? "later" : "earlier",
      *offset > 0 ? "ahead" : "behind", -static_cast<double>(*offset) * 1e-9);
}

}  // namespace plvo

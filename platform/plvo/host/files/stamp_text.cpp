// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/stamp_text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "plvo/host/number_text.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int64_t kMaxSeconds = INT64_MAX / kNanosecondsPerSecond - 1;

struct StampUnit {
  const char* name;
  int exponent;  // 10^exponent of them are a second
};
constexpr StampUnit kUnits[] = {{"milliseconds", 3}, {"microseconds", 6}, {"nanoseconds", 9}};
constexpr std::size_t kDigitsOfSeconds = 10;  // since 1970, of any date from 2001 to 2286
constexpr double kLongestStep_s = 3;          // nothing can be tracked from one image to the next over more

bool parse_double(std::string_view text, std::int64_t& stamp_ns) {
  double seconds = 0;
  if (!parse_whole_text(text, seconds) || !std::isfinite(seconds)) return false;
  if (std::abs(seconds) > static_cast<double>(kMaxSeconds)) return false;
  stamp_ns = std::llround(seconds * 1e9);
  return true;
}

}  // namespace

bool parse_stamp_ns(std::string_view text, std::int64_t& stamp_ns) {
  if (text.find_first_of("eE") != std::string_view::npos) return parse_double(text, stamp_ns);
  const bool negative = !text.empty() && text.front() == '-';
  if (negative) text.remove_prefix(1);
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view decimals =
      point == std::string_view::npos ? std::string_view() : text.substr(point + 1);
  if (whole.empty() && decimals.empty()) return false;

  std::int64_t seconds = 0;
  for (char c : whole) {
    if (c < '0' || c > '9') return false;
    seconds = seconds * 10 + (c - '0');
    if (seconds > kMaxSeconds) return false;
  }
  std::int64_t nanoseconds = 0;
  std::int64_t weight = kNanosecondsPerSecond / 10;
  for (char c : decimals) {
    if (c < '0' || c > '9') return false;
    nanoseconds += weight * (c - '0');
    weight /= 10;
  }
  stamp_ns = seconds * kNanosecondsPerSecond + nanoseconds;
  if (negative) stamp_ns = -stamp_ns;
  return true;
}

std::string stamp_error(std::string_view word) {
  const bool number = !word.empty() && word.find_first_not_of("0123456789.") == std::string_view::npos;
  const std::size_t digits = std::min(word.find('.'), word.size());
  if (!number || digits <= kDigitsOfSeconds) return fmt::format("'{}' is not a stamp in seconds", word);
  const StampUnit& unit = kUnits[std::min<std::size_t>((digits - kDigitsOfSeconds - 1) / 3, 2)];
  return fmt::format("stamps are seconds, and {} looks like {}; divide the stamps by 1e{}", word, unit.name,
                     unit.exponent);
}

std::string stamp_unit_doubt(const std::vector<std::int64_t>& stamps_ns) {
  double step_s = static_cast<double>(median_step_ns(stamps_ns)) * 1e-9;
  if (step_s <= kLongestStep_s) return {};
  for (const StampUnit& unit : kUnits) {
    if (const double scaled = step_s * std::pow(10, -unit.exponent); scaled <= kLongestStep_s)
      return fmt::format(
          "they lie {:.4g} s apart, as {} would ({:.4g} s); stamps are seconds: divide by 1e{}", step_s,
          unit.name, scaled, unit.exponent);
  }
  return {};
}

std::int64_t median_step_ns(const std::vector<std::int64_t>& stamps_ns) {
  std::vector<std::uint64_t> steps;  // two stamps may lie further apart than an int64 can say
  for (std::size_t i = 1; i < stamps_ns.size(); ++i)
    if (stamps_ns[i] > stamps_ns[i - 1])
      steps.push_back(static_cast<std::uint64_t>(stamps_ns[i]) -
                      static_cast<std::uint64_t>(stamps_ns[i - 1]));
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return static_cast<std::int64_t>(std::min<std::uint64_t>(*middle, INT64_MAX));
}

std::string format_stamp(std::int64_t stamp_ns) {
  const char* sign = stamp_ns < 0 ? "-" : "";
  const std::uint64_t magnitude =
      stamp_ns < 0 ? ~static_cast<std::uint64_t>(stamp_ns) + 1 : static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t seconds = magnitude / kNanosecondsPerSecond;
  const std::uint64_t rest = magnitude % kNanosecondsPerSecond;
  if (rest % 1000 != 0) return fmt::format("{}{}.{:09}", sign, seconds, rest);
  return fmt::format("{}{}.{:06}", sign, seconds, rest / 1000);
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/host/files/stamp_text.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

namespace plvo {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::int64_t kMaxSeconds = INT64_MAX / kNanosecondsPerSecond - 1;

bool parse_double(std::string_view text, std::int64_t& stamp_ns) {
  double seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(seconds)) return false;
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

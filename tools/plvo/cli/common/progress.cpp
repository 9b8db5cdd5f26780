// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>

namespace plvo::cli {
namespace {

constexpr std::int64_t kPeriodNs = 100'000'000;

}  // namespace

Progress::Progress(Clock& clock, bool quiet, std::optional<std::size_t> expected)
    : clock_(clock), expected_(expected), enabled_(!quiet && isatty(STDERR_FILENO) == 1) {}

void Progress::show(const FrameRecord& record, std::size_t lost) {
  if (!enabled_) return;
  const std::int64_t now = clock_.monotonic_ns();
  if (now < next_ns_) return;
  next_ns_ = now + kPeriodNs;
  const TrackResult& result = record.result;
  fmt::print(stderr, "\r\033[Kframe {}{} {}  points {}  lines {}  {:.1f} ms  lost {}", record.number + 1,
             expected_ ? fmt::format("/{}", *expected_) : "",
             record.damaged() ? "damaged" : to_string(result.state), result.points.inliers,
             result.lines.inliers, static_cast<double>(record.cpu_ns) * 1e-6, lost);
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace plvo::cli

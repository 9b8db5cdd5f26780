// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_wheels.hpp"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <limits>

#include "plvo/host/posix_clock.hpp"

namespace plvo::cli {
namespace {

constexpr double kHold_s = 0.1;  // lines a hundred milliseconds apart are held over
constexpr std::int64_t kSteady_ns =
    1'000'000'000;  // of frames with lines, before it is said that all is well
constexpr std::int64_t kFrameDelay_ns = 33'000'000;  // from the stamp of a sensor's frame to its arrival
constexpr std::int64_t kFuture_ns = 1'000'000'000;   // a stamp so far ahead of this computer's clock is wrong
constexpr int kMostLines = 1024;                     // at once: a writer of nonsense must not hold a frame up
constexpr std::uint64_t kToldLines = 10;             // further ones are only counted

std::int64_t now_since_1970_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

}  // namespace

LiveWheels::LiveWheels(Console& console) : console_(console), arrivals_(kFrameDelay_ns) {}

Status LiveWheels::start(const WheelOptions& options, const BaseOption& base, WheelClock clock) {
  if (options.file.empty()) return {};
  name_ = options.file == "-" ? "standard input" : options.file;
  clock_ = clock;
  WheelConfig config = wheel_config(options, base);
  config.hold_s = kHold_s;
  if (Status status = priors_.init({}, config); !status.ok()) return status;
  summary_.used = true;
  return reader_.open(options.file);
}

MotionPrior LiveWheels::until(std::int64_t stamp_ns, std::int64_t arrival_ns) {
  if (!summary_.used) return {};
  arrivals_.frame_arrived(stamp_ns, arrival_ns);
  read(stamp_ns);
  MotionPrior prior = priors_.prior(stamp_ns);
  if (!first_) tell(stamp_ns, prior.tells_motion());
  first_ = false;
  return prior;
}

void LiveWheels::while_no_frame_comes() {
  if (!summary_.used || first_ || clock_ == WheelClock::kImages) return;
  read(std::numeric_limits<std::int64_t>::max());
}

// Lines that are ahead of the images wait in the pipe: their writer may be a program that prints a file.
void LiveWheels::read(std::int64_t until_ns) {
  std::string line;
  for (int i = 0; i < kMostLines; ++i) {
    const bool ahead = clock_ == WheelClock::kImages && priors_.last_ns() > until_ns;
    if (ahead || !reader_.next(line)) return;
    take(line);
  }
}

void LiveWheels::take(const std::string& line) {
  ++row_.line;
  split_row(line, row_);
  if (row_.words.empty()) return;
  ++summary_.lines;
  WheelSample sample;
  if (const Status status = rows_.parse(name_, row_, sample); !status.ok()) {
    leave_out(status.message());
    return;
  }
  if (clock_ == WheelClock::kComputer) {
    const std::int64_t now_ns = now_since_1970_ns();
    if (sample.stamp_ns < 0 || sample.stamp_ns > now_ns + kFuture_ns) {
      leave_out(
          row_error(name_, row_, "the stamp is not this computer's time in seconds since 1970").message());
      return;
    }
    sample.stamp_ns = *arrivals_.stamp_of(posix_monotonic_ns() - (now_ns - sample.stamp_ns));
  }
  if (!priors_.add(sample)) {
    leave_out(row_error(name_, row_, "is not later than the line before, or not finite").message());
    return;
  }
  quick_.add(sample);
  quick_.tell(console_);
  keep(sample);
}

void LiveWheels::leave_out(const std::string& why) {
  ++summary_.left_out;
  if (summary_.left_out <= kToldLines)
    console_.write(LogLevel::kWarning, fmt::format("{}; the line is left out", why));
  if (summary_.left_out == kToldLines)
    console_.write(LogLevel::kWarning, "further lines of the wheels that are left out are only counted");
}

// A stream that comes and goes is not told of more often than once a second.
void LiveWheels::tell(std::int64_t stamp_ns, bool with) {
  ++(with ? summary_.with : summary_.without);
  if (!with) again_since_ns_.reset();
  if (!with && !missing_) {
    missing_ = true;
    console_.write(LogLevel::kWarning, why_without(stamp_ns));
  }
  if (!with || !missing_) return;
  if (!again_since_ns_) again_since_ns_ = stamp_ns;
  if (stamp_ns - *again_since_ns_ < kSteady_ns) return;
  missing_ = false;
  again_since_ns_.reset();
  console_.write(LogLevel::kInfo, "the wheels are used again");
}

std::string LiveWheels::why_without(std::int64_t stamp_ns) const {
  const std::optional<std::int64_t> last_ns = priors_.last_ns();
  if (reader_.ended()) return fmt::format("{} has ended; frames are tracked without wheels", name_);
  if (!last_ns)
    return fmt::format("no line of the wheels has come from {} yet; frames are tracked without wheels",
                       name_);
  const double late_s = 1e-9 * (static_cast<double>(stamp_ns) - static_cast<double>(*last_ns));
  if (late_s > 0)
    return fmt::format(
        "the last line of the wheels is {:.2f} s older than the frame; frames are tracked without wheels "
        "until lines come",
        late_s);
  return "the lines of the wheels have a gap, or begin after the frame; it is tracked without wheels";
}

void LiveWheels::keep(const WheelSample& sample) {
  if (folder_.empty()) return;
  const bool with_sigma = rows_.has_sigma();
  if (!file_.is_open())
    failure_ = file_.open(std::filesystem::path(folder_) / kWheelFile, wheel_header(with_sigma));
  if (failure_.ok()) failure_ = file_.write(wheel_line(sample, with_sigma));
  if (failure_.ok()) return;
  console_.write(LogLevel::kError, failure_.message());
  folder_.clear();
}

}  // namespace plvo::cli

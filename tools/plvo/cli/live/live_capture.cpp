// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/live/live_capture.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace plvo::cli {

void LiveCapture::StoppableClock::sleep_until_ns(std::int64_t until_ns) {
  constexpr std::int64_t kSlice_ns = 100'000'000;
  for (std::int64_t now = monotonic_ns(); now < until_ns && !stop_; now = monotonic_ns())
    clock_.sleep_until_ns(std::min(until_ns, now + kSlice_ns));
}

void LiveCapture::start() {
  thread_ = std::thread([this] { run(); });
}

void LiveCapture::stop() {
  stop_ = true;
  ring_.close();  // whoever waits for room in it
  if (thread_.joinable()) thread_.join();
}

const char* LiveCapture::State::word() const {
  switch (last.code()) {
    case StatusCode::kOk: return frames == 0 ? "waiting" : "running";
    case StatusCode::kUnplugged: return "unplugged";
    case StatusCode::kDamaged: return "damaged";
    default: return "stalled";
  }
}

LiveCapture::State LiveCapture::state() const {
  const std::lock_guard lock(mutex_);
  State state = state_;
  const std::int64_t now = posix_monotonic_ns();
  state.hz = meter_.hz(now);
  if (state.frames > 0) state.seconds_since_frame = static_cast<double>(now - last_ns_) * 1e-9;
  if (last_ns_ > first_ns_)
    state.average_hz =
        static_cast<double>(state.frames - 1) * 1e9 / static_cast<double>(last_ns_ - first_ns_);
  return state;
}

void LiveCapture::run() {
  while (!stop_) {
    RgbdFrame frame;
    const Status status = paced_.next(frame);
    if (status.ok()) {
      on_frame(frame);
    } else if (!stop_) {  // no trouble is reported once the command ends
      on_trouble(status);
    }
    poll_recording();
    if (!goes_on_after(status.code())) break;
  }
  tell(check_.finish());
  const OpenNi2Counters counters = camera_.counters();
  {
    const std::lock_guard lock(mutex_);
    state_.camera = counters;
  }
  ring_.close();
  camera_.close();
}

void LiveCapture::on_frame(const RgbdFrame& frame) {
  const std::int64_t now = posix_monotonic_ns();
  const OpenNi2Counters counters = camera_.counters();
  std::int64_t trouble_ns = 0;
  {
    const std::lock_guard lock(mutex_);
    if (state_.frames++ == 0) first_ns_ = now;
    last_ns_ = now;
    meter_.tick(now);
    state_.last = Status();
    state_.words = "ok";
    state_.camera = counters;
    if (trouble_since_ns_ != 0) trouble_ns = now - trouble_since_ns_;
    trouble_since_ns_ = 0;
  }
  if (trouble_ns > 0)
    console_.write(LogLevel::kInfo, fmt::format("frames arrive again, after {:.1f} s",
                                                static_cast<double>(trouble_ns) * 1e-9));
  recording_.push(frame);
  ring_.push(frame, now);
  tell(check_.add(frame));
}

void LiveCapture::tell(const std::vector<std::string>& findings) {
  for (const std::string& sentence : findings) console_.write(LogLevel::kWarning, sentence);
}

void LiveCapture::on_trouble(const Status& status) {
  const bool passes = status.code() == StatusCode::kTimeout || status.code() == StatusCode::kUnplugged;
  {
    const std::lock_guard lock(mutex_);
    state_.last = status;
    state_.words = status.message();
    state_.damaged += status.code() == StatusCode::kDamaged ? 1 : 0;
    state_.timeouts += status.code() == StatusCode::kTimeout ? 1 : 0;
    if (passes && trouble_since_ns_ == 0) trouble_since_ns_ = posix_monotonic_ns();
    if (!goes_on_after(status.code()) && status.code() != StatusCode::kEndOfStream) state_.end = status;
  }
  if (passes || status.code() == StatusCode::kDamaged) console_.write(LogLevel::kWarning, status.message());
}

void LiveCapture::poll_recording() {
  const Status status = recording_.poll();
  if (status.ok()) return;
  console_.write(LogLevel::kError, status.message());
  const std::lock_guard lock(mutex_);
  state_.recorder = status;
}

}  // namespace plvo::cli

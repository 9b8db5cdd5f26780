// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/stamp_tracker.hpp"

#include <algorithm>
#include <cstdlib>

namespace plvo {
namespace {

// Largest difference between a stamp and the value expected from the host's clock. Buffering in the driver
// and a busy machine delay whole frames; a clock that was set or wrapped differs by far more.
constexpr std::int64_t kSlack_us = 2000000;

}  // namespace

void StampTracker::reset(std::int64_t period_us, bool live) {
  streams_ = {};
  period_us_ = period_us;
  live_ = live;
}

void StampTracker::restart() {
  for (Stream& stream : streams_) stream.fresh = true;
}

bool StampTracker::plausible(std::int64_t candidate_us, std::int64_t expected_us,
                             std::int64_t last_us) const {
  return candidate_us > last_us && std::abs(candidate_us - expected_us) <= kSlack_us;
}

StampTracker::Result StampTracker::map(int stream_index, std::int64_t raw_us, std::int64_t now_us) {
  Stream& stream = streams_[static_cast<std::size_t>(stream_index)];
  const Stream& other = streams_[static_cast<std::size_t>(1 - stream_index)];
  Result result;

  if (!stream.seen) {
    // The first stamp of this stream: the device's value plus the offset of the other stream, if that is
    // known.
    stream.offset_us = other.seen ? other.offset_us : 0;
    result.stamp_us = raw_us + stream.offset_us;
  } else {
    const std::int64_t elapsed_us = live_ ? std::max(period_us_, now_us - stream.last_now_us) : period_us_;
    const std::int64_t expected_us = stream.last_us + elapsed_us;
    const std::int64_t as_before_us = raw_us + stream.offset_us;
    const bool leaps = live_ && as_before_us > expected_us + kSlack_us;
    result.stamp_us = as_before_us;

    if (stream.fresh || as_before_us <= stream.last_us || leaps) {
      const bool other_plausible =
          !other.fresh && plausible(raw_us + other.offset_us, expected_us, stream.last_us);
      if (plausible(as_before_us + kKinectWrap_us, expected_us, stream.last_us)) {
        result = {as_before_us + kKinectWrap_us, Step::kWrap};
      } else {
        result = {other_plausible ? raw_us + other.offset_us : expected_us, Step::kJump};
      }
      if (stream.fresh) result.step = Step::kForward;
      stream.offset_us = result.stamp_us - raw_us;
    }
  }
  stream.seen = true;
  stream.fresh = false;
  stream.last_us = result.stamp_us;
  stream.last_now_us = now_us;
  return result;
}

}  // namespace plvo

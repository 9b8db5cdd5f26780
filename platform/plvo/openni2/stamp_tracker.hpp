// SPDX-License-Identifier: Apache-2.0
// Converts a camera's stamps to strictly increasing microseconds per stream, whatever the device's counter
// does. The Kinect v1 counts 60 MHz ticks in 32 bits and wraps every 71.58 s; drivers restart at zero after a
// replug; a sensor that resets jumps back. Both streams of a device share one clock. If one stream has made a
// step, the other is mapped with the same offset as soon as it makes the same step, so colour and depth stay
// comparable.
#pragma once

#include <array>
#include <cstdint>

namespace plvo {

class StampTracker {
 public:
  enum class Step : std::uint8_t { kForward, kWrap, kJump };
  struct Result {
    std::int64_t stamp_us = 0;  // strictly increasing from call to call of one stream
    Step step = Step::kForward;
  };
  static constexpr int kStreams = 2;
  static constexpr std::int64_t kKinectWrap_us = 71582788;  // 2^32 / 60 MHz

  // period_us: frame period. live: the host's clock measures the elapsed time, so forward steps are detected
  // as well. For a recording it gives no information, and forward steps are accepted.
  void reset(std::int64_t period_us, bool live);

  // To be called after a replug or a restart: the next stamp of each stream may have any value and does not
  // count as a step.
  void restart();

  // raw_us: the driver's stamp; now_us: the host's monotonic clock at arrival. stream: 0 or 1.
  Result map(int stream, std::int64_t raw_us, std::int64_t now_us);

 private:
  struct Stream {
    bool seen = false;
    bool fresh = true;  // no stamp since restart()
    std::int64_t last_us = 0;
    std::int64_t last_now_us = 0;
    std::int64_t offset_us = 0;
  };
  bool plausible(std::int64_t candidate_us, std::int64_t expected_us, std::int64_t last_us) const;

  std::array<Stream, kStreams> streams_{};
  std::int64_t period_us_ = 33333;
  bool live_ = true;
};

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// The line that moves while frames are worked on: on a terminal only, ten times a second at most.
#pragma once

#include <cstdint>
#include <optional>

#include "plvo/cli/common/frame_record.hpp"
#include "plvo/hal/clock.hpp"

namespace plvo::cli {

class Progress {
 public:
  // quiet: never show. expected: how many frames there will be, where that is known.
  Progress(Clock& clock, bool quiet, std::optional<std::size_t> expected);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const FrameRecord& record, std::size_t lost);
  // Takes the line away, so that other text may be written.
  void clear();

 private:
  Clock& clock_;
  std::optional<std::size_t> expected_;
  bool enabled_;
  bool shown_ = false;
  std::int64_t next_ns_ = 0;
};

}  // namespace plvo::cli

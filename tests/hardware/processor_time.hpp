// SPDX-License-Identifier: Apache-2.0
// Measures the processor time of this process for a number of frames, which is meaningful on a shared
// machine. The benchmarks measure rates.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace plvo_test {

class ProcessorTime {
 public:
  double seconds() const { return taken_s() - start_s_; }

  // Returns an empty string if this machine, without other load, could process one frame per `period_s`;
  // otherwise an error message.
  std::string judge(double frames, double period_s) const {
    const double frame_s = seconds() / std::max(frames, 1.0);
    const auto processors = static_cast<double>(::sysconf(_SC_NPROCESSORS_ONLN));
    std::printf("%.0f frames; %.1f ms of processor time a frame\n", frames, 1e3 * frame_s);
    return frame_s > 0.9 * processors * period_s ? "a frame takes too much processor time" : "";
  }

 private:
  static double taken_s() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  double start_s_ = taken_s();
};

}  // namespace plvo_test

// SPDX-License-Identifier: Apache-2.0
// How much of this machine others took while a test ran, and how much the test itself: what a rate may be
// judged by on a machine that is not the test's own.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

namespace plvo_test {

class MachineLoad {
 public:
  MachineLoad() : start_(read()), own_start_s_(own_cpu_s()) {}

  double own_s() const { return own_cpu_s() - own_start_s_; }
  // 0 … 1 of all processors; 0 where the system does not tell.
  double others() const {
    const Ticks now = read();
    const double total = now.total - start_.total;
    if (total <= 0) return 0;
    const double own = own_s() * static_cast<double>(::sysconf(_SC_CLK_TCK));
    return std::clamp((now.busy - start_.busy - own) / total, 0.0, 1.0);
  }

  // Whether `frames` in `seconds` keep up with a sensor, of whose rate `wanted_hz` must arrive. A machine
  // that others use much of is asked two other questions: does the processor time for a frame leave room for
  // that rate, and did the share of the machine that was left bring its share of the frames?
  std::string judge(double frames, double seconds, double wanted_hz) const {
    const double hz = frames / seconds, taken = others();
    const double own_per_frame_s = own_s() / std::max(frames, 1.0);
    const auto processors = static_cast<double>(::sysconf(_SC_NPROCESSORS_ONLN));
    std::printf(
        "%.2f frames/s for %.1f s; %.1f ms of processor time a frame; others took %.0f %% of the machine\n",
        hz, seconds, 1e3 * own_per_frame_s, 100 * taken);
    if (hz >= wanted_hz) return "";
    if (taken < 0.15) return "too slow, and nobody else to blame";
    std::printf("JUDGED BY PROCESSOR TIME, for others used this machine\n");
    if (own_per_frame_s * wanted_hz > 0.9 * processors) return "a frame takes too much processor time";
    if (hz < 0.7 * (1 - taken) * wanted_hz) return "slower than the share of the machine that was left";
    return "";
  }

 private:
  struct Ticks {
    double busy = 0, total = 0;
  };
  static Ticks read() {
    std::ifstream stat("/proc/stat");
    std::string cpu;
    stat >> cpu;
    Ticks ticks;
    double value = 0;
    for (int i = 0; i < 8 && stat >> value; ++i) {  // user nice system idle iowait irq softirq steal
      ticks.total += value;
      if (i != 3 && i != 4) ticks.busy += value;
    }
    return ticks;
  }
  static double own_cpu_s() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  Ticks start_;
  double own_start_s_;
};

}  // namespace plvo_test

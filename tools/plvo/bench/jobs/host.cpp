// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/host.hpp"

#include <fmt/core.h>
#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "plvo/bench/systems/system.hpp"

namespace plvo::bench {
namespace {

// Reads "model name : …" on x86; boards state their name in the device tree.
std::string cpu_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  std::string board;
  std::ifstream tree("/proc/device-tree/model");
  std::getline(tree, board, '\0');
  return board.empty() ? "unknown processor" : board;
}

}  // namespace

nlohmann::ordered_json Host::to_json() const {
  return {{"cpu", cpu},   {"cores", cores},       {"load", load},     {"kernel", kernel},
          {"plvo", plvo}, {"compiler", compiler}, {"opencv", opencv}, {"open3d", open3d}};
}

std::string Host::to_line() const {
  return fmt::format("{}, {} cores, load {:.1f}; {}; plvo {}, compiled by {}; OpenCV {}, Open3D {}.", cpu,
                     cores, load, kernel, plvo, compiler, opencv.empty() ? "absent" : opencv,
                     open3d.empty() ? "absent" : open3d);
}

Host describe_host() {
  Host host;
  host.cpu = cpu_name();
  host.cores = static_cast<int>(std::thread::hardware_concurrency());
  if (getloadavg(&host.load, 1) != 1) host.load = 0;
  utsname system{};
  if (uname(&system) == 0)
    host.kernel = fmt::format("{} {} {}", system.sysname, system.release, system.machine);
#ifdef __clang__
  host.compiler = __VERSION__;
#else
  host.compiler = fmt::format("GCC {}", __VERSION__);
#endif
  host.plvo = PLVO_VERSION;
  host.opencv = opencv_version();
  host.open3d = open3d_version();
  return host;
}

}  // namespace plvo::bench

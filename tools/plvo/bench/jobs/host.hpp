// SPDX-License-Identifier: Apache-2.0
// The machine and the software of a measurement.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace plvo::bench {

struct Host {
  std::string cpu, kernel, compiler, plvo, opencv, open3d;
  int cores = 0;
  double load = 0;  // average over the last minute, including other programs

  nlohmann::ordered_json to_json() const;
  std::string to_line() const;
};

Host describe_host();

}  // namespace plvo::bench

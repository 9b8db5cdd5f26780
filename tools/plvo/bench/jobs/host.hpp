// SPDX-License-Identifier: Apache-2.0
// On what, and with what, a measurement was made.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace plvo::bench {

struct Host {
  std::string cpu, kernel, compiler, plvo, opencv, open3d;
  int cores = 0;
  double load = 0;  // average of the last minute: who else was at work

  nlohmann::ordered_json to_json() const;
  std::string to_line() const;
};

Host describe_host();

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/map/map_summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace plvo::cli {

SummaryRows MapSummary::rows() const {
  SummaryRows rows = {{"map", fmt::format("{} keyframes of {}, {:.1f} MB", keyframes, capacity,
                                          static_cast<double>(bytes) * 1e-6)}};
  if (loaded > 0)
    rows.emplace_back("place in the map", !located_after_s
                                              ? "not known: no place of the loaded map was recognised"
                                              : fmt::format("found after {:.2f} s", *located_after_s));
  rows.emplace_back("places seen again",
                    fmt::format("{} times, by {} pairs of keyframes", recognised, loops));
  rows.emplace_back("map, CPU per frame",
                    fmt::format("{:.2f} ms median, {:.2f} p99, {:.2f} max", cpu.quantile_ms(0.5),
                                cpu.quantile_ms(0.99), cpu.max_ms()));
  return rows;
}

nlohmann::ordered_json MapSummary::to_json() const {
  nlohmann::ordered_json json = {
      {"loaded", loaded},         {"located", located},   {"located_after_s", nullptr},
      {"keyframes", keyframes},   {"capacity", capacity}, {"bytes", bytes},
      {"removed", removed},       {"compared", compared}, {"accepted", accepted},
      {"recognised", recognised}, {"loops", loops},       {"cpu_ms", cli::to_json(cpu)},
      {"ate_m", nullptr}};
  if (located_after_s) json["located_after_s"] = *located_after_s;
  if (ate_m) json["ate_m"] = *ate_m;
  return json;
}

}  // namespace plvo::cli

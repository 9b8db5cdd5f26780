// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/sequences/paper_table2.hpp"

#include <algorithm>
#include <array>

#include "plvo/bench/table.hpp"

namespace plvo::bench {
namespace {

struct PaperRow {
  const char* name;
  int frames;
  // mm and degrees per frame
  double kpoint_mm, kpoint_deg, edge_mm, edge_deg, plvo_mm, plvo_deg;
  double plvo_second_mm, dvo_second_mm;
};

constexpr std::array<PaperRow, 10> kRows = {{
    {"360", 745, 13.8, 0.63, 11.2, 0.55, 11.2, 0.45, 84, 119},
    {"desk", 575, 11.7, 0.73, 8.6, 0.70, 10.8, 0.60, 39, 30},
    {"desk2", 614, 17.6, 1.07, 8.9, 0.7, 11.5, 0.64, 54, 55},
    {"floor", 1214, 3.7, 0.29, 15.7, 0.47, 3.5, 0.28, 24, 90},
    {"plant", 1112, 20.7, 1.25, 6.9, 0.49, 5.1, 0.34, 24, 36},
    {"room", 1332, 13.7, 0.63, 6.2, 0.48, 5.3, 0.36, 49, 48},
    {"rpy", 687, 12.1, 0.91, 7.2, 0.67, 9.1, 0.63, 52, 43},
    {"teddy", 1395, 25.4, 1.45, 36.5, 0.92, 11.5, 0.47, 50, 67},
    {"xyz", 788, 5.8, 0.35, 4.7, 0.41, 5.3, 0.35, 22, 24},
    {"mean", 8462, 14.4, 0.83, 13.4, 0.60, 7.7, 0.43, 43, 58},
}};

Result make(const PaperRow& row, const char* system, double mm, double deg, double second_mm) {
  Result result;
  result.system = system;
  result.frames = row.frames;
  result.estimate.rpe_frame_mm = mm;
  result.estimate.rpe_frame_deg = deg;
  result.estimate.rpe_second_mm = second_mm;
  result.estimate.rpe_second_deg = kNone;
  return result;
}

}  // namespace

const std::vector<std::string>& paper_sequences() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const PaperRow& row : kRows) all.emplace_back(row.name);
    all.pop_back();  // the mean
    return all;
  }();
  return names;
}

PaperSequence paper_sequence(const std::string& folder) {
  for (const std::string prefix : {"freiburg1_", "fr1_"}) {
    const std::size_t at = folder.find(prefix);
    if (at == std::string::npos) continue;
    const std::string rest = folder.substr(at + prefix.size());
    const std::string name = rest.substr(0, rest.find('_'));
    const auto& names = paper_sequences();
    if (std::find(names.begin(), names.end(), name) != names.end()) return {name, name == rest};
  }
  return {};
}

std::vector<Result> paper_results(const std::string& name) {
  for (const PaperRow& row : kRows) {
    if (row.name != name) continue;
    return {make(row, "paper: PLVO", row.plvo_mm, row.plvo_deg, row.plvo_second_mm),
            make(row, "paper: DVO", kNone, kNone, row.dvo_second_mm),
            make(row, "paper: Edge", row.edge_mm, row.edge_deg, kNone),
            make(row, "paper: Kpoint", row.kpoint_mm, row.kpoint_deg, kNone)};
  }
  return {};
}

}  // namespace plvo::bench

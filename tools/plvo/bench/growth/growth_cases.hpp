// SPDX-License-Identifier: Apache-2.0
// The cases that measure how the cost of a frame grows. Each changes one parameter of a rendered sequence at
// 640×480 with the default capacities for features.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plvo/bench/jobs/job.hpp"
#include "plvo/bench/stages/stage_times.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

struct GrowthCase {
  NamedFolder sequence;  // folder of the frames
  std::size_t frames = 0;
  StageSetting setting;
  std::optional<SimulatorOptions> rendering;  // simulator options, if the sequence is rendered
};

struct GrowthTable {
  struct Row {
    std::string name;
    std::size_t measured;  // index of its case
  };
  std::string title, first_column;
  std::vector<Row> rows;
};

struct GrowthPlan {
  std::vector<GrowthCase> cases;  // the first has 640×480 pixels and all defaults
  std::vector<GrowthTable> tables;
  GrowthTable sequences;  // evaluated over their length, not relative to the first case

  // An upper bound on the result of the case `measured`.
  struct Bound {
    std::string what;
    std::size_t measured;
    enum class Of : std::uint8_t { kMeanOfUsual, kWorstOfUsual, kP99OfMedian } of;
    double most;
  };
  std::vector<Bound> bounds;
};

struct GrowthOptions {
  std::filesystem::path out;
  std::vector<std::string> tables = {"sizes", "points", "segments", "images", "sequences"};
  SceneName scene = SceneName::kDesk;
  std::size_t frames = 20;
  std::size_t sequence_frames = 150;
  int repeats = 3;
  int jobs = 1;
};

// recorded: sequences that are measured in addition to the rendered one. Returns kInvalidArgument for an
// unknown table.
Status plan_growth(const GrowthOptions& options, const std::vector<NamedFolder>& recorded, GrowthPlan& plan);

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
// What is measured to see how a frame's cost grows: one thing at a time is changed of a rendered walk at
// 640×480 with the default room for features.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plvo/bench/jobs/job.hpp"
#include "plvo/bench/stages/stage_times.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

struct GrowthCase {
  NamedFolder sequence;  // where its frames are
  std::size_t frames = 0;
  StageSetting setting;
  std::optional<SimulatorOptions> walk;  // that is rendered there
};

struct GrowthTable {
  struct Row {
    std::string name;
    std::size_t measured;  // the number of its case
  };
  std::string title, first_column;
  std::vector<Row> rows;
};

struct GrowthPlan {
  std::vector<GrowthCase> cases;  // the first: 640×480, all as by default
  std::vector<GrowthTable> tables;
  GrowthTable walks;  // measured over their length, not against the first

  // What is wanted: of `measured`, at most so much.
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
  std::string tables = "sizes,points,segments,images,walks";
  SceneName scene = SceneName::kDesk;
  std::size_t frames = 20;
  std::size_t walk_frames = 150;
  int repeats = 3;
  int jobs = 1;
};

// recorded: sequences whose frames are measured beside those of the rendered walk. kInvalidArgument for a
// table that there is not.
Status plan_growth(const GrowthOptions& options, const std::vector<NamedFolder>& recorded, GrowthPlan& plan);

// The same view in an image `scale` times as wide and high.
CameraModel scaled(const CameraModel& camera, double scale);

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/growth/growth_cases.hpp"

#include <fmt/core.h>

#include "plvo/bench/sequences/scaled_camera.hpp"

namespace plvo::bench {
namespace {

// Upper bounds for the cost of a frame, as ratios.
constexpr double kMostOfVga = 1 / 3.5;   // cost at a quarter of the pixels
constexpr double kMostOfHardImages = 3;  // slowest frame, relative to the median with unchanged images
constexpr double kMostOfMedian = 1.6;    // 99 % quantile of a sequence, relative to its median

class Planner {
 public:
  using Of = GrowthPlan::Bound::Of;

  Planner(const GrowthOptions& options, GrowthPlan& plan) : options_(options), plan_(plan) {
    add_case(1, {}, options.frames);
  }

  void add_sizes() {
    StageSetting tiny, qvga;
    tiny.make_tiny();
    qvga.take_limits(Limits::qvga());
    GrowthTable table{"Image size", "size", {}};
    table.rows.push_back({"320×240, tiny", add_case(0.5, tiny, options_.frames)});
    table.rows.push_back({"320×240, Limits::qvga", add_case(0.5, qvga, options_.frames)});
    for (const GrowthTable::Row& row : table.rows)
      plan_.bounds.push_back({row.name + " / 640×480", row.measured, Of::kMeanOfUsual, kMostOfVga});
    // Without a bound: as many features as of the larger image cost as much as there.
    table.rows.push_back({"320×240, capacities of VGA", add_case(0.5, {}, options_.frames)});
    table.rows.push_back({"640×480", 0});
    table.rows.push_back({"1280×960", add_case(2, {}, options_.frames)});
    plan_.tables.push_back(table);
  }

  void add_capacities(const char* title, const char* entry, int StageSetting::*capacity,
                      const std::vector<int>& sizes) {
    GrowthTable table{title, entry, {}};
    for (const int size : sizes) {
      StageSetting setting;
      const bool usual = setting.*capacity == size;
      setting.*capacity = size;
      table.rows.push_back({std::to_string(size) + (usual ? " (default)" : ""),
                            usual ? 0 : add_case(1, setting, options_.frames)});
    }
    plan_.tables.push_back(table);
  }

  void add_images() {
    GrowthTable table{"Images that are hard on a detector", "images", {{"of the sequence", 0}}};
    const auto image = [&](const char* name, Replacement replacement) {
      StageSetting setting;
      setting.replacement = replacement;
      const std::size_t measured = add_case(1, setting, options_.frames);
      table.rows.push_back({name, measured});
      plan_.bounds.push_back({fmt::format("{}, worst frame / the sequence's median", name), measured,
                              Of::kWorstOfUsual, kMostOfHardImages});
    };
    image("noise", Replacement::kNoise);
    image("stripes", Replacement::kStripes);
    image("checkerboard", Replacement::kCheckerboard);
    plan_.tables.push_back(table);
  }

  void add_sequences(const std::vector<NamedFolder>& recorded) {
    plan_.sequences = {"Frames of a sequence", "sequence", {}};
    const auto add = [&](const std::string& name, std::size_t measured) {
      plan_.sequences.rows.push_back({name, measured});
      plan_.bounds.push_back({name + ", p99 / median", measured, Of::kP99OfMedian, kMostOfMedian});
    };
    add("rendered sequence", add_case(1, {}, options_.sequence_frames));
    for (const NamedFolder& sequence : recorded) {
      plan_.cases.push_back({sequence, options_.sequence_frames, {}, {}});
      add(sequence.sequence, plan_.cases.size() - 1);
    }
  }

 private:
  std::size_t add_case(double scale, const StageSetting& setting, std::size_t frames) {
    SimulatorOptions rendering;
    rendering.scene = options_.scene;
    rendering.frames = static_cast<int>(frames);
    rendering.camera = scaled(rendering.camera, scale);
    const std::string folder = fmt::format("{}_{}x{}_{}f", to_string(rendering.scene), rendering.camera.width,
                                           rendering.camera.height, rendering.frames);
    plan_.cases.push_back({{options_.out / folder, folder, ""}, frames, setting, rendering});
    return plan_.cases.size() - 1;
  }

  const GrowthOptions& options_;
  GrowthPlan& plan_;
};

}  // namespace

Status plan_growth(const GrowthOptions& options, const std::vector<NamedFolder>& recorded, GrowthPlan& plan) {
  Planner planner(options, plan);
  for (const std::string& table : options.tables) {
    if (table == "sizes") {
      planner.add_sizes();
    } else if (table == "points") {
      planner.add_capacities("Capacity for keypoints", "Limits::keypoints", &StageSetting::keypoints,
                             {100, 200, Limits{}.keypoints, 1000, 2000});
    } else if (table == "segments") {
      planner.add_capacities("Capacity for segments", "Limits::segments", &StageSetting::segments,
                             {20, 50, 100, 200, Limits{}.segments, 400});
    } else if (table == "images") {
      planner.add_images();
    } else if (table == "sequences") {
      planner.add_sequences(recorded);
    } else {
      return {StatusCode::kInvalidArgument,
              fmt::format("there is no table \"{}\"; choose of: sizes, points, segments, images, sequences",
                          table)};
    }
  }
  return {};
}

}  // namespace plvo::bench

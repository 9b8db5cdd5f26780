// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/stages/stage_instructions.hpp"

#include <fmt/core.h>

#include <string>
#include <vector>

namespace plvo::bench {
namespace {

// The functions that a row counts. Each is called from another file, so that it exists whatever the compiler
// inlines, and none of them calls another.
struct Row {
  Stage stage;
  const char* step;
  std::vector<const char*> functions;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {Stage::kImage, "grey, lens", {"plvo::to_gray(", "plvo::UndistortionMap::undistort("}},
      {Stage::kImage, "pyramid", {"plvo::halve_binomial5("}},
      {Stage::kPoints, "detect", {"plvo::detect_keypoints("}},
      {Stage::kPoints, "smooth", {"plvo::smooth_binomial7("}},
      {Stage::kPoints, "describe", {"plvo::Describer::", "plvo::cut_patch("}},
      {Stage::kPoints, "3D", {"plvo::FeatureExtraction::lift("}},
      {Stage::kLines, "detect", {"plvo::SegmentDetector::detect("}},
      {Stage::kLines, "describe", {"plvo::describe_segment("}},
      {Stage::kLines, "depths", {"void plvo::sample_segment<"}},
      {Stage::kLines, "3D", {"plvo::fit_line3d("}},
      {Stage::kMatching, "by image", {"plvo::align_step(", "plvo::SparseAlignment::"}},
      {Stage::kMatching, "by descriptor", {"plvo::track_by_descriptor("}},
      {Stage::kMatching, "registration", {"plvo::track_by_motion("}},
      {Stage::kMatching, "lines", {"plvo::match_predicted_lines("}},
      {Stage::kMotion, "solve", {"plvo::estimate_motion("}},
      {Stage::kMotion, "noise seen", {"plvo::residual_scales("}},
  };
  return all;
}

std::uint64_t cost_of(const Row& row, const CallgrindCosts& costs) {
  std::uint64_t cost = 0;
  for (const char* function : row.functions) cost += costs.of(function);
  return cost;
}

std::string millions(double instructions) { return fmt::format("{:.2f}", instructions * 1e-6); }

}  // namespace

Table instructions_table(const CallgrindCosts& costs, std::size_t frames) {
  const double per_frame = 1.0 / static_cast<double>(frames);
  Table table;
  table.header = {"stage", "step", "M instructions a frame", "%"};
  table.text_columns = 2;
  const auto add = [&](const char* stage, const char* step, std::uint64_t cost) {
    table.rows.push_back(
        {stage, step, millions(static_cast<double>(cost) * per_frame),
         fmt::format("{:.1f}", 100.0 * static_cast<double>(cost) / static_cast<double>(costs.total))});
  };
  std::uint64_t accounted = 0;
  for (const Row& row : rows()) {
    const std::uint64_t cost = cost_of(row, costs);
    accounted += cost;
    add(to_string(row.stage), row.step, cost);
  }
  add("rest", "", costs.total - accounted);
  add("all", "", costs.total);
  return table;
}

StageInstructions stage_instructions(const CallgrindCosts& costs) {
  StageInstructions sums;
  sums.all = costs.total;
  for (const Row& row : rows()) sums.stage[static_cast<std::size_t>(row.stage)] += cost_of(row, costs);
  return sums;
}

}  // namespace plvo::bench

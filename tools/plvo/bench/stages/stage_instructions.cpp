// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/stages/stage_instructions.hpp"

#include <fmt/core.h>

#include <fstream>

#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/stages/callgrind_costs.hpp"
#include "plvo/bench/stages/track_counted.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

// What a row counts: functions that are called from other files, so that they are there whatever the compiler
// inlines, and none of which calls another.
struct Row {
  const char* stage;
  const char* step;
  std::vector<const char*> functions;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> all = {
      {"image", "grey, lens", {"plvo::to_gray(", "plvo::UndistortionMap::undistort("}},
      {"image", "pyramid", {"plvo::halve_binomial5("}},
      {"points", "detect", {"plvo::detect_keypoints("}},
      {"points", "smooth", {"plvo::smooth_binomial7("}},
      {"points", "describe", {"plvo::Describer::", "plvo::cut_patch("}},
      {"points", "3D", {"plvo::FeatureExtraction::lift_points("}},
      {"lines", "detect", {"plvo::SegmentDetector::detect("}},
      {"lines", "describe", {"plvo::describe_segment("}},
      {"lines", "depths", {"void plvo::sample_segment<"}},
      {"lines", "3D", {"plvo::fit_line3d("}},
      {"matching", "by image", {"plvo::ReferenceTracking::align("}},
      {"matching", "by descriptor", {"plvo::track_by_descriptor("}},
      {"matching", "registration", {"plvo::track_by_motion("}},
      {"matching", "lines", {"plvo::match_predicted_lines("}},
      {"motion", "solve", {"plvo::estimate_motion("}},
      {"motion", "noise seen", {"plvo::residual_scales("}},
  };
  return all;
}

std::string find_valgrind() {
  for (const char* folder : {"/usr/bin", "/usr/local/bin", "/opt/homebrew/bin"}) {
    const fs::path program = fs::path(folder) / "valgrind";
    std::error_code error;
    if (fs::exists(program, error)) return program.string();
  }
  return {};
}

std::string millions(double instructions) { return fmt::format("{:.2f}", instructions * 1e-6); }

}  // namespace

Status count_instructions(const std::vector<std::string>& command, const fs::path& out,
                          const std::string& name, std::size_t frames, Table& table) {
  const std::string valgrind = find_valgrind();
  if (valgrind.empty())
    return {StatusCode::kNotFound, "--instructions needs valgrind (the package valgrind)"};
  const fs::path profile = out / (name + ".callgrind");
  std::vector<std::string> words = {valgrind,
                                    "-q",
                                    "--tool=callgrind",
                                    "--collect-atstart=no",
                                    fmt::format("--toggle-collect={}", kCountedFunction),
                                    fmt::format("--callgrind-out-file={}", profile.string())};
  words.insert(words.end(), command.begin(), command.end());
  const auto ended = [](std::size_t, bool, std::size_t) {};
  if (run_commands({words}, 1, ended) != 0) return {StatusCode::kIo, "the run under valgrind failed"};
  std::ifstream file(profile);
  const CallgrindCosts costs = read_callgrind(file);
  if (costs.total == 0)
    return {StatusCode::kDamaged, fmt::format("{}: nothing was counted", profile.string())};
  const double per_frame = 1.0 / static_cast<double>(frames);
  table.header = {"stage", "step", "M instructions a frame", "%"};
  table.text_columns = 2;
  const auto add = [&](const char* stage, const char* step, std::uint64_t cost) {
    table.rows.push_back(
        {stage, step, millions(static_cast<double>(cost) * per_frame),
         fmt::format("{:.1f}", 100.0 * static_cast<double>(cost) / static_cast<double>(costs.total))});
  };
  std::uint64_t accounted = 0;
  for (const Row& row : rows()) {
    std::uint64_t cost = 0;
    for (const char* function : row.functions) cost += costs.of(function);
    accounted += cost;
    add(row.stage, row.step, cost);
  }
  add("rest", "", costs.total - accounted);
  add("all", "", costs.total);
  return {};
}

}  // namespace plvo::bench

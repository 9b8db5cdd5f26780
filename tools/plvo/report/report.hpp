// SPDX-License-Identifier: Apache-2.0
// One HTML file that shows a run or an evaluation. It contains its data, images and scripts, and loads
// nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/eval/evaluation.hpp"
#include "plvo/report/frame_recorder.hpp"
#include "plvo/report/run_series.hpp"
#include "plvo/report/scene_recorder.hpp"

namespace plvo::report {

struct ReportInput {
  std::string title, subtitle;
  eval::Trajectory trajectory;                               // the estimate
  std::optional<eval::Evaluation> evaluation;                // if there is ground truth
  std::vector<RunSample> series;                             // of a run
  std::vector<RecordedFrame> frames;                         // of a run
  Scene scene;                                               // of a run
  std::vector<std::pair<std::string, std::string>> summary;  // rows of two columns
};

// Returns kIo with the operating system's reason.
Status write_report(const std::filesystem::path& path, const ReportInput& input);

// Returns the text of the page.
std::string make_report(const ReportInput& input);

}  // namespace plvo::report

// SPDX-License-Identifier: Apache-2.0
// What one job found out, as it stands in its JSON file.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/eval/evaluation.hpp"

namespace plvo::bench {

// RMSE over all pairs; NaN where the sequence is too short for any.
struct Accuracy {
  double rpe_second_mm = 0, rpe_second_deg = 0;
  double rpe_frame_mm = 0, rpe_frame_deg = 0;
  double ate_mm = 0;
  double ted_mm = 0, ted_deg = 0;  // from the first pose to the last one
};

struct Result {
  std::string sequence, system;
  int repeat = 0;
  int frames = 0;     // read
  int lost = 0;       // of them: no motion was found
  double path_m = 0;  // of the truth
  Accuracy estimate;
  Accuracy identity;                         // of a camera that never moves
  double cpu_median_ms = 0, cpu_p95_ms = 0;  // per frame, the first one left out
  double peak_mb = 0;                        // resident, of the whole process
  double growth_mb = 0;  // of that, what came after the program was loaded and the sequence opened
};

void fill_accuracy(const eval::Evaluation& evaluation, Result& result);

nlohmann::ordered_json to_json(const Accuracy& accuracy);
nlohmann::ordered_json to_json(const Result& result, const nlohmann::ordered_json& job_key);

// kNotFound when there is none; kDamaged when it is not a result, or one of another job (other frames, other
// sampling of the truth): such a job is to be run again.
Status read_result(const std::filesystem::path& file, const Job& job, Result& result);
// Through a file beside it that is renamed: an interruption leaves either no result or a whole one.
Status write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace plvo::bench

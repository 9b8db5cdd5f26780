// SPDX-License-Identifier: Apache-2.0
// Result of one job, as stored in its JSON file.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "plvo/base/status.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/eval/evaluation.hpp"

namespace plvo::bench {

// RMSE over all pairs; NaN if the sequence is too short for a pair.
struct Accuracy {
  double rpe_second_mm = 0, rpe_second_deg = 0;
  double rpe_frame_mm = 0, rpe_frame_deg = 0;
  double ate_mm = 0;
  double ted_mm = 0, ted_deg = 0;  // from the first pose to the last one
};

struct Result {
  std::string sequence, system;
  int repeat = 0;
  int frames = 0;     // number of frames read
  int lost = 0;       // of these, frames without a motion estimate
  double path_m = 0;  // path length of the truth
  Accuracy estimate;
  Accuracy identity;                         // of the zero-motion baseline
  double cpu_median_ms = 0, cpu_p95_ms = 0;  // per frame, without the first one
  double peak_mb = 0;                        // resident, of the whole process
  double growth_mb = 0;  // part of the peak after the program was loaded and the sequence opened
};

void fill_accuracy(const eval::Evaluation& evaluation, Result& result);

nlohmann::ordered_json to_json(const Accuracy& accuracy);
nlohmann::ordered_json to_json(const Result& result, const nlohmann::ordered_json& job_key);

// Returns kNotFound if the file does not exist; kDamaged if it is no result or belongs to another job (other
// frames, other sampling of the truth). Such a job must run again.
Status read_result(const std::filesystem::path& file, const Job& job, Result& result);
// Writes a file beside it and renames that: an interruption leaves either no result or a complete one.
Status write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace plvo::bench

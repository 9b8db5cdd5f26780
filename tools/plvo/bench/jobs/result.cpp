// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/result.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

namespace plvo::bench {
namespace {

using nlohmann::ordered_json;

// The JSON writer stores NaN as null.
double number(const ordered_json& json, const char* name) {
  const ordered_json& value = json.at(name);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

Accuracy accuracy_from(const ordered_json& json) {
  return {number(json, "rpe_second_mm"), number(json, "rpe_second_deg"), number(json, "rpe_frame_mm"),
          number(json, "rpe_frame_deg"), number(json, "ate_mm"),         number(json, "ted_mm"),
          number(json, "ted_deg")};
}

Result result_from(const ordered_json& json) {
  Result result;
  const ordered_json& job = json.at("job");
  job.at("sequence").get_to(result.sequence);
  job.at("system").get_to(result.system);
  job.at("repeat").get_to(result.repeat);
  json.at("frames").get_to(result.frames);
  json.at("lost").get_to(result.lost);
  result.path_m = number(json, "path_m");
  result.estimate = accuracy_from(json.at("estimate"));
  result.identity = accuracy_from(json.at("identity"));
  result.cpu_median_ms = number(json, "cpu_median_ms");
  result.cpu_p95_ms = number(json, "cpu_p95_ms");
  result.peak_mb = number(json, "peak_mb");
  result.growth_mb = number(json, "growth_mb");
  return result;
}

double rmse(const eval::Statistics& statistics, double scale) {
  return statistics.count > 0 ? scale * statistics.rmse : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void fill_accuracy(const eval::Evaluation& e, Result& result) {
  const eval::RpeResult& frame = e.rpe.at(0);  // the default deltas of the evaluation: one frame, one second
  const eval::RpeResult& second = e.rpe.at(1);
  const auto fill = [](Accuracy& accuracy, const eval::RpeErrors& per_second,
                       const eval::RpeErrors& per_frame, const eval::Statistics& ate,
                       const eval::EndDrift& drift) {
    accuracy = {rmse(per_second.translation_m, 1e3),
                rmse(per_second.rotation_deg, 1),
                rmse(per_frame.translation_m, 1e3),
                rmse(per_frame.rotation_deg, 1),
                rmse(ate, 1e3),
                1e3 * drift.translation_m,
                drift.rotation_deg};
  };
  fill(result.estimate, second.estimate, frame.estimate, e.ate.position_m, e.drift);
  fill(result.identity, second.identity, frame.identity, e.ate_identity, e.drift_identity);
  result.path_m = e.path_m;
}

ordered_json to_json(const Accuracy& a) {
  return {{"rpe_second_mm", a.rpe_second_mm},
          {"rpe_second_deg", a.rpe_second_deg},
          {"rpe_frame_mm", a.rpe_frame_mm},
          {"rpe_frame_deg", a.rpe_frame_deg},
          {"ate_mm", a.ate_mm},
          {"ted_mm", a.ted_mm},
          {"ted_deg", a.ted_deg}};
}

ordered_json to_json(const Result& r, const ordered_json& job_key) {
  return {{"job", job_key},
          {"frames", r.frames},
          {"lost", r.lost},
          {"path_m", r.path_m},
          {"estimate", to_json(r.estimate)},
          {"identity", to_json(r.identity)},
          {"cpu_median_ms", r.cpu_median_ms},
          {"cpu_p95_ms", r.cpu_p95_ms},
          {"peak_mb", r.peak_mb},
          {"growth_mb", r.growth_mb}};
}

Status read_result(const std::filesystem::path& file, const Job& job, Result& result) {
  std::ifstream stream(file);
  if (!stream) return {StatusCode::kNotFound, fmt::format("{}: not there", file.string())};
  try {
    const ordered_json json = ordered_json::parse(stream);
    if (json.at("job") != job.key())
      return {StatusCode::kDamaged, fmt::format("{}: measured with other options", file.string())};
    result = result_from(json);
  } catch (const nlohmann::json::exception& error) {
    return {StatusCode::kDamaged, fmt::format("{}: not a result: {}", file.string(), error.what())};
  }
  return {};
}

Status write_text(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path part = file.string() + fmt::format(".{}.part", ::getpid());
  std::ofstream stream(part, std::ios::binary);
  stream << text;
  stream.close();
  std::error_code error;
  if (stream) std::filesystem::rename(part, file, error);
  if (!stream || error) {
    std::filesystem::remove(part, error);
    return {StatusCode::kIo, fmt::format("{}: cannot be written; is the disk full?", file.string())};
  }
  return {};
}

}  // namespace plvo::bench

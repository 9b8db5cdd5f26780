// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/jobs/job.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

namespace plvo::bench {

std::filesystem::path Job::result_file(const std::filesystem::path& out) const {
  return out / "jobs" / fmt::format("{}.{}.{}.json", sequence, system, repeat);
}

nlohmann::ordered_json Job::key() const {
  nlohmann::ordered_json key = {
      {"sequence", sequence},
      {"system", system},
      {"repeat", repeat},
      {"frames_asked", options.frames},
      {"gt_sampling", options.sampling == eval::GroundTruthSampling::kNearest ? "nearest" : "interpolated"}};
  if (!options.camera_model.empty()) key["camera_model"] = options.camera_model;
  return key;
}

std::vector<std::string> Job::command(const std::string& program, const std::filesystem::path& out) const {
  std::vector<std::string> words = {program,         "worker",
                                    "--folder",      folder.string(),
                                    "--sequence",    sequence,
                                    "--system",      system,
                                    "--repeat",      std::to_string(repeat),
                                    "--out",         out.string(),
                                    "--gt-sampling", key()["gt_sampling"].get<std::string>()};
  if (options.frames > 0) words.insert(words.end(), {"--frames", std::to_string(options.frames)});
  if (!options.camera_model.empty()) words.insert(words.end(), {"--camera-model", options.camera_model});
  return words;
}

std::vector<Job> interleaved_jobs(const std::vector<NamedFolder>& sequences,
                                  const std::vector<std::string>& systems, int repeats,
                                  const JobOptions& options) {
  std::vector<Job> jobs;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (const NamedFolder& sequence : sequences)
      for (const std::string& system : systems) {
        jobs.push_back({sequence.folder, sequence.sequence, system, repeat, options});
        if (!sequence.camera_model.empty()) jobs.back().options.camera_model = sequence.camera_model;
      }
  return jobs;
}

std::string shell_line(const std::vector<std::string>& words) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace plvo::bench

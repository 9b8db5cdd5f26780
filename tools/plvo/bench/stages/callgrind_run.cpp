// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/stages/callgrind_run.hpp"

#include <fmt/core.h>

#include <fstream>

#include "plvo/bench/jobs/process_pool.hpp"
#include "plvo/bench/stages/track_counted.hpp"

namespace plvo::bench {
namespace {

namespace fs = std::filesystem;

std::string find_valgrind() {
  for (const char* folder : {"/usr/bin", "/usr/local/bin", "/opt/homebrew/bin"}) {
    const fs::path program = fs::path(folder) / "valgrind";
    std::error_code error;
    if (fs::exists(program, error)) return program.string();
  }
  return {};
}

}  // namespace

Status callgrind_command(const NamedFolder& sequence, const JobOptions& options, const StageSetting& setting,
                         const fs::path& profile, ProfileOf what, std::vector<std::string>& command) {
  const std::string valgrind = find_valgrind();
  if (valgrind.empty())
    return {StatusCode::kNotFound, "counting instructions needs valgrind (the package valgrind)"};
  command = {valgrind,
             "-q",
             "--tool=callgrind",
             "--collect-atstart=no",
             fmt::format("--toggle-collect={}", kCountedFunction),
             fmt::format("--callgrind-out-file={}", profile.string())};
  if (what == ProfileOf::kEachFrame) command.push_back(fmt::format("--dump-after={}", kFrameEnd));
  const std::string folder = sequence.camera_model.empty()
                                 ? sequence.folder.string()
                                 : fmt::format("{}={}", sequence.folder.string(), sequence.camera_model);
  command.insert(
      command.end(),
      {own_program(), "stages", "--without-table", folder, "--out", profile.parent_path().string(), "--image",
       std::to_string(static_cast<int>(setting.replacement)), "--frames", std::to_string(options.frames),
       "--keypoints", std::to_string(setting.keypoints), "--segments", std::to_string(setting.segments),
       "--surfaces", std::to_string(setting.surfaces)});
  if (setting.tiny) command.push_back("--tiny");
  if (!options.camera_model.empty()) command.insert(command.end(), {"--camera-model", options.camera_model});
  return {};
}

Status read_frame_profiles(const fs::path& profile, std::vector<CallgrindCosts>& frames) {
  for (std::size_t i = 1;; ++i) {
    std::ifstream file(fmt::format("{}.{}", profile.string(), i));
    if (!file) break;
    frames.push_back(read_callgrind(file));
    if (frames.back().total == 0) break;
  }
  if (frames.empty() || frames.back().total == 0)
    return {StatusCode::kDamaged, fmt::format("{}: nothing was counted", profile.string())};
  return {};
}

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/sequences/named_folder.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <set>

#include "plvo/host/printable.hpp"
#include "plvo/replay/calibration/calibration.hpp"

namespace plvo::bench {

namespace fs = std::filesystem;

Status name_folders(const std::vector<std::string>& folders, std::vector<NamedFolder>& sequences) {
  std::set<std::string> seen;
  for (const std::string& text : folders) {
    std::error_code error;
    const std::size_t equals = fs::is_directory(text, error) ? std::string::npos : text.rfind('=');
    const std::string model = equals == std::string::npos ? "" : text.substr(equals + 1);
    fs::path folder = fs::absolute(text.substr(0, equals)).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    const std::string name = printable(folder.filename().string());
    Calibration known;
    if (Status status = builtin_calibration(model, known); !model.empty() && !status.ok()) return status;
    if (!fs::is_directory(folder, error))
      return {StatusCode::kNotFound, fmt::format("{}: there is no such folder", text)};
    if (!seen.insert(name).second)
      return {StatusCode::kInvalidArgument, fmt::format("two sequences are called {}; rename one", name)};
    sequences.push_back({folder, name, model});
  }
  return {};
}

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/file_roles.hpp"

#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <optional>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/files/line_file.hpp"

namespace plvo::cli {
namespace {

namespace fs = std::filesystem;

std::optional<struct stat> look_at(const fs::path& path) {
  struct stat info {};
  const int failed = is_standard_output(path) ? ::fstat(STDOUT_FILENO, &info) : ::stat(path.c_str(), &info);
  return failed == 0 ? std::optional(info) : std::nullopt;
}

// Where a file would be made that is not there yet: links that lead nowhere are followed, too.
fs::path place_of(fs::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, error); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    path = target.is_absolute() ? target : path.parent_path() / target;
  }
  const fs::path place = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : place;
}

bool same_file(const fs::path& a, const fs::path& b) {
  if (is_standard_output(a) && is_standard_output(b)) return true;
  const auto first = look_at(a), second = look_at(b);
  if (first && second) return first->st_dev == second->st_dev && first->st_ino == second->st_ino;
  return !first && !second && place_of(a) == place_of(b);
}

// A device such as /dev/null keeps nothing that could be overwritten.
bool is_device(const fs::path& path) {
  const auto info = look_at(path);
  return !is_standard_output(path) && info && S_ISCHR(info->st_mode);
}

std::string name_of(const fs::path& path) {
  return is_standard_output(path) ? "standard output" : path.string();
}

}  // namespace

void FileRoles::reads(const fs::path& file) {
  if (!file.empty()) inputs_.push_back(file);
}

void FileRoles::writes(const std::string& option, const fs::path& file) {
  if (!file.empty() && !is_device(file)) outputs_.push_back({option, file});
}

void FileRoles::writes_folder(const std::string& option, const fs::path& folder) {
  if (!folder.empty()) folders_.push_back({option, folder});
}

bool FileRoles::may_overwrite() const {
  for (const Output& output : outputs_)
    if (look_at(output.path)) return true;
  return !folders_.empty();
}

void FileRoles::check_inputs(const Output& output) const {
  for (const fs::path& input : inputs_)
    if (same_file(output.path, input))
      refuse(output.option, fmt::format("{} is an input, which would be overwritten; choose another name",
                                        output.path.string()));
}

void FileRoles::check_folders() const {
  for (const Output& folder : folders_)
    for (const fs::path& input : inputs_)
      if (same_file(folder.path, input.parent_path().empty() ? fs::path(".") : input.parent_path()))
        refuse(folder.option,
               fmt::format("{} holds inputs, which could be overwritten; choose another folder",
                           folder.path.string()));
}

void FileRoles::check() const {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    check_inputs(outputs_[i]);
    for (std::size_t j = 0; j < i; ++j)
      if (same_file(outputs_[i].path, outputs_[j].path))
        refuse(outputs_[i].option, fmt::format("{} is already written by {}; give each output its own name",
                                               name_of(outputs_[i].path), outputs_[j].option));
  }
  check_folders();
}

}  // namespace plvo::cli

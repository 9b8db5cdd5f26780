// SPDX-License-Identifier: Apache-2.0
#include "plvo/rosbag/containers/bag_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "plvo/rosbag/containers/container_kind.hpp"
#include "plvo/rosbag/containers/open_container.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 500;  // all are open at once

// The parts of recording_2.db3: recording_ and 2, without leading zeros.
struct NumberedName {
  std::string before, digits, name;
};

NumberedName numbered_name(const fs::path& path) {
  const std::string name = path.filename().string();
  const std::string stem = name.substr(0, name.find('.', name.find_last_of('_') + 1));
  const std::size_t number = stem.find_last_not_of("0123456789") + 1;
  const std::size_t digits = std::min(stem.find_first_not_of('0', number), stem.size());
  return {stem.substr(0, number), stem.substr(digits), name};
}

// recording_2.db3 comes before recording_10.db3: a shorter number is smaller.
bool comes_before(const fs::path& a, const fs::path& b) {
  const NumberedName first = numbered_name(a), second = numbered_name(b);
  return std::tuple(first.before, first.digits.size(), first.digits, first.name) <
         std::tuple(second.before, second.digits.size(), second.digits, second.name);
}

// files: sorted. Returns a sentence if a number is missing, else nothing.
std::string missing_number(const std::vector<fs::path>& files) {
  constexpr std::size_t kMostDigits = 9;
  const auto number = [](const std::string& digits) { return digits.empty() ? 0 : std::stol(digits); };
  for (std::size_t i = 1; i < files.size(); ++i) {
    const NumberedName a = numbered_name(files[i - 1]), b = numbered_name(files[i]);
    if (a.before != b.before || std::max(a.digits.size(), b.digits.size()) > kMostDigits) continue;
    if (number(b.digits) > number(a.digits) + 1)
      return fmt::format("after {} comes {}: is a file between them missing?", a.name, b.name);
  }
  return {};
}

}  // namespace

Status BagFolder::open_file(const fs::path& path) {
  std::vector<fs::path> found = bag_files_in(path);
  if (found.empty())
    return {
        StatusCode::kNotFound,
        fmt::format("{} has the metadata.yaml of rosbag2, but no .db3 and no .mcap file: copy its files here",
                    path.string())};
  const auto databases = std::count_if(found.begin(), found.end(), [](const fs::path& file) {
    return by_extension(file) == Container::kSqlite;
  });
  if (databases != 0 && databases != static_cast<std::ptrdiff_t>(found.size()))
    return {StatusCode::kInvalidArgument,
            fmt::format("{} has both .db3 and .mcap files: name one file, or move one kind elsewhere",
                        path.string())};
  // The recorder keeps a file beside its packed copy when it dies in between.
  std::erase_if(found, [&](const fs::path& file) {
    std::error_code error;
    return has_packed_name(file) && fs::exists(fs::path(file).replace_extension(), error);
  });
  if (found.size() > kMostFiles)
    return {StatusCode::kInvalidArgument,
            fmt::format("{} has {} files; at most {} are read", path.string(), found.size(), kMostFiles)};
  std::sort(found.begin(), found.end(), comes_before);
  remark_of_files_ = missing_number(found);
  Status first_failure;
  for (const fs::path& file : found) {
    std::unique_ptr<MessageFile> opened;
    if (Status status = open_container(file, opened); status.ok())
      files_.push_back(std::move(opened));
    else if (first_failure.ok())
      first_failure = status;
  }
  // One damaged file of several costs what is in it.
  if (files_.empty() || first_failure.code() != StatusCode::kDamaged) return first_failure;
  remark_of_files_ +=
      fmt::format("{}a file is left out: {}", remark_of_files_.empty() ? "" : "; ", first_failure.message());
  return {};
}

Status BagFolder::scan(const Take& take) {
  std::string remarks = remark_of_files_;
  for (std::size_t number = 0; number < files_.size(); ++number) {
    MessageFile& file = *files_[number];
    std::vector<std::size_t> topics;  // ours, for each of the file
    const Status status = file.scan([&](Found& found) -> Status {
      for (std::size_t i = topics.size(); i < file.topics().size(); ++i) {
        const BagTopic& topic = file.topics()[i];
        topics.push_back(topic_number(topic.name, topic.type, topic.wire));
      }
      if (topics[found.topic] == kNoTopic) return {};
      found.topic = topics[found.topic];
      found.place.file = static_cast<std::uint32_t>(number);
      return take(found);
    });
    if (!status.ok()) return status;
    file.release();
    if (!file.remark().empty()) remarks += (remarks.empty() ? "" : "; ") + file.remark();
  }
  set_remark(std::move(remarks));
  return {};
}

Status BagFolder::read_stored(const BagMessage& place, std::span<unsigned char> bytes) {
  if (place.file != last_read_) files_[last_read_]->release();
  last_read_ = place.file;
  return files_[place.file]->read_stored(place, bytes);
}

}  // namespace plvo

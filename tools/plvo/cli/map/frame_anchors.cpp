// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/map/frame_anchors.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "plvo/host/files/whole_write.hpp"

namespace plvo::cli {
namespace {

Status no_anchors(const std::string& folder, int reason) {
  return {StatusCode::kIo,
          fmt::format("the poses for --map-trajectory cannot be kept in {}: {}; make room, or set TMPDIR to "
                      "another folder",
                      folder, std::strerror(reason))};
}

Se3 pose_of(const double* T) {
  Se3 pose;
  for (int i = 0; i < 9; ++i) pose.R(i / 3, i % 3) = T[i];
  for (int i = 0; i < 3; ++i) pose.t[i] = T[9 + i];
  return pose;
}

}  // namespace

FrameAnchors::~FrameAnchors() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Status FrameAnchors::open() {
  const char* given = std::getenv("TMPDIR");
  folder_ = given != nullptr && *given != '\0' ? given : "/tmp";
  std::string name = folder_ + "/plvo-XXXXXX";
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) return no_anchors(folder_, errno);
  ::unlink(name.c_str());
  buffer_.reserve(kBuffered);
  return {};
}

void FrameAnchors::add_frame(std::int64_t stamp_ns, std::uint32_t keyframe, const Se3& T_keyframe_camera) {
  add({stamp_ns, keyframe, 0, {}}, T_keyframe_camera);
}

void FrameAnchors::add_removed(std::uint32_t keyframe, std::uint32_t into, const Se3& T_into_keyframe) {
  add({0, into, keyframe, {}}, T_into_keyframe);
}

void FrameAnchors::add(Record record, const Se3& T) {
  if (!is_open() || failure_ != 0) return;
  for (int i = 0; i < 9; ++i) record.T[i] = T.R(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) record.T[9 + i] = T.t[i];
  buffer_.push_back(record);
  if (buffer_.size() == kBuffered) flush();
}

void FrameAnchors::flush() {
  const std::string_view bytes(reinterpret_cast<const char*>(buffer_.data()),
                               buffer_.size() * sizeof(Record));
  failure_ = write_whole(descriptor_, bytes);
  buffer_.clear();
}

Status FrameAnchors::read_all(const std::function<Status(const Record&)>& use) {
  std::vector<Record> read(kBuffered);
  for (off_t at = 0;;) {
    const ssize_t bytes = ::pread(descriptor_, read.data(), kBuffered * sizeof(Record), at);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) return no_anchors(folder_, errno);
    // A regular file gives all that it has: whole records.
    const std::size_t count = static_cast<std::size_t>(bytes) / sizeof(Record);
    if (count == 0) return {};
    for (std::size_t i = 0; i < count; ++i)
      if (Status status = use(read[i]); !status.ok()) return status;
    at += static_cast<off_t>(count * sizeof(Record));
  }
}

Status FrameAnchors::for_each(const Map& map, const Use& use) {
  if (!is_open()) return {};
  if (failure_ == 0) flush();
  if (failure_ != 0) return no_anchors(folder_, failure_);
  struct Place {
    std::uint32_t keyframe;
    Se3 T;  // relative to it
  };
  // A keyframe that was removed, in one that stays. One that it was joined with may have gone later: from the
  // last to the first, each is joined with one whose place is final.
  std::vector<Record> removed;
  Status status = read_all([&removed](const Record& record) {
    if (record.removed != 0) removed.push_back(record);
    return Status();
  });
  if (!status.ok()) return status;
  std::unordered_map<std::uint32_t, Place> places;
  const auto place_of = [&places](std::uint32_t keyframe) {
    const auto found = places.find(keyframe);
    return found == places.end() ? Place{keyframe, Se3()} : found->second;
  };
  for (auto record = removed.rbegin(); record != removed.rend(); ++record) {
    const Place place = place_of(record->of);
    places.insert_or_assign(record->removed, Place{place.keyframe, place.T * pose_of(record->T)});
  }
  // Consecutive frames have the same keyframe.
  std::uint32_t keyframe = 0;
  std::optional<Se3> T_map_keyframe;
  return read_all([&](const Record& record) {
    if (record.removed != 0) return Status();
    if (record.of != keyframe) {
      keyframe = record.of;
      const Place place = place_of(keyframe);
      T_map_keyframe = map.keyframe_pose(place.keyframe);
      if (T_map_keyframe) *T_map_keyframe = *T_map_keyframe * place.T;
    }
    return T_map_keyframe ? use(record.stamp_ns, *T_map_keyframe * pose_of(record.T)) : Status();
  });
}

}  // namespace plvo::cli

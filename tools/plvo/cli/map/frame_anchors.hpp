// SPDX-License-Identifier: Apache-2.0
// The frames of a session, each relative to a keyframe of the map, so that their poses in the map can be
// written at the end, with all corrections. They are kept in a temporary file, 112 bytes a frame: a session
// may last for hours, and the memory stays. The file has no name; it goes when the program ends, however it
// ends.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/map/map.hpp"

namespace plvo::cli {

class FrameAnchors {
 public:
  FrameAnchors() = default;
  FrameAnchors(const FrameAnchors&) = delete;
  FrameAnchors& operator=(const FrameAnchors&) = delete;
  ~FrameAnchors();

  // Makes the file in the folder TMPDIR, or /tmp. Until then nothing is kept.
  Status open();
  bool is_open() const { return descriptor_ >= 0; }

  // Neither allocates. What a full disk does not take is said by for_each().
  void add_frame(std::int64_t stamp_ns, std::uint32_t keyframe, const Se3& T_keyframe_camera);
  void add_removed(std::uint32_t keyframe, std::uint32_t into, const Se3& T_into_keyframe);

  // Calls use for each frame of which the map knows the place now, in their order; its failure ends it.
  using Use = std::function<Status(std::int64_t stamp_ns, const Se3& T_map_camera)>;
  Status for_each(const Map& map, const Use& use);

 private:
  // A frame, relative to keyframe `of`; or a keyframe that was removed, relative to one that stays.
  struct Record {
    std::int64_t stamp_ns = 0;
    std::uint32_t of = 0;
    std::uint32_t removed = 0;  // 0: it is a frame
    double T[12] = {};          // rotation by rows, translation
  };
  static constexpr std::size_t kBuffered = 64;

  void add(Record record, const Se3& T);
  void flush();
  Status read_all(const std::function<Status(const Record&)>& use);

  int descriptor_ = -1;
  std::string folder_;
  std::vector<Record> buffer_;  // not yet in the file
  int failure_ = 0;             // errno
};

}  // namespace plvo::cli

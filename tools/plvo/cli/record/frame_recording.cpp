// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/record/frame_recording.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "plvo/host/files/line_file.hpp"

namespace plvo::cli {

namespace fs = std::filesystem;

namespace {

// is_new: it was not there before.
Status make_folder(const fs::path& path, bool& is_new) {
  std::error_code error;
  is_new = fs::create_directory(path, error);
  std::string reason;
  if (!error && ::access(path.c_str(), W_OK | X_OK) != 0) reason = std::strerror(errno);
  if (error) reason = error.message();
  if (fs::exists(path, error) && !fs::is_directory(path, error)) reason = "it is a file";
  if (reason.empty()) return {};
  return {StatusCode::kIo, fmt::format("cannot make the folder {}: {}; choose a path that can be written",
                                       path.string(), reason)};
}

}  // namespace

FrameRecording::~FrameRecording() { [[maybe_unused]] const Status nobody_asks_any_more = stop(); }

Status FrameRecording::check(const std::string& path) {
  std::error_code error;
  if (is_oni_file(path)) {
    if (fs::exists(path, error))
      return {StatusCode::kInvalidArgument,
              fmt::format("{} exists already: remove it or choose another name", path)};
    return LineFile::check(path);
  }
  for (const char* list : {"rgb.txt", "depth.txt"})
    if (fs::exists(fs::path(path) / list, error))
      return {StatusCode::kInvalidArgument,
              fmt::format("{} holds a recording already: remove it or choose another folder", path)};
  bool is_new = false;
  if (Status status = make_folder(path, is_new); !status.ok()) return status;
  if (is_new) fs::remove(path, error);
  return {};
}

Status FrameRecording::open(const std::string& path, LiveCamera& camera, bool every_frame,
                            std::uint64_t max_frames) {
  path_ = path;
  max_frames_ = max_frames;
  oni_ = is_oni_file(path);
  if (Status status = check(path); !status.ok()) return status;
  if (oni_) {
    const Status status = camera.start_oni(path);
    if (status.ok()) camera_ = &camera;
    return status;
  }
  // What is in the folder waits for the first frame, which says what unit depth is in.
  bool is_new = false;
  if (Status status = make_folder(path, is_new); !status.ok()) return status;
  camera_ = &camera;
  model_ = camera.model();
  ring_ = std::make_unique<FrameRing>(model_.width, model_.height, kSlots,
                                      every_frame ? RingPolicy::kEvery : RingPolicy::kInOrder);
  thread_ = std::thread([this] { write_frames(); });
  return {};
}

void FrameRecording::push(const RgbdFrame& frame) {
  if (camera_ == nullptr || ended_ || offered_ >= max_frames_) return;
  ++offered_;
  if (oni_) {
    ++frames_;
  } else {
    ring_->push(frame, 0);
  }
}

Status FrameRecording::poll() {
  if (camera_ == nullptr || ended_) return {};
  const Status status = oni_ ? camera_->poll_oni() : take_failure();
  if (!status.ok()) ended_ = true;
  return status;
}

Status FrameRecording::take_failure() {
  const std::lock_guard lock(mutex_);
  return std::exchange(failure_, Status());
}

Status FrameRecording::stop() {
  if (camera_ == nullptr) return {};
  if (oni_) {
    camera_->stop_oni();
  } else if (thread_.joinable()) {
    ring_->close();
    thread_.join();
  }
  return take_failure();
}

std::uint64_t FrameRecording::dropped() const { return ring_ ? ring_->counters().dropped : 0; }

void FrameRecording::write_frames() {
  TumWriter writer;
  bool made = false;
  RgbdFrame frame;
  std::int64_t arrival_ns = 0;
  for (;;) {
    const FrameRing::Take take = ring_->take(frame, arrival_ns, 1000);
    if (take == FrameRing::Take::kClosed) return;
    if (take == FrameRing::Take::kTimeout) continue;
    Status status;
    if (!made) status = writer.open(path_, model_, std::round(1 / frame.depth.metres_per_unit));
    made = true;
    if (status.ok()) status = writer.write(frame);
    if (status.ok()) {
      ++frames_;
      continue;
    }
    {
      const std::lock_guard lock(mutex_);
      failure_ = Status(status.code(), "the recording ends here, what was written is whole: ")
                     .append(status.message());
    }
    ring_->close();  // nobody waits for room that will never come
    return;
  }
}

}  // namespace plvo::cli

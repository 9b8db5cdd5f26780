// SPDX-License-Identifier: Apache-2.0
// A device that plays an .oni recording in a child process. The child is another instance of this program (or
// the named program), started with only a socket open. If it crashes, hangs or sends an invalid message, this
// class returns a Status. Internal to this module; oni_player_process.cpp is the child's side.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>

#include "plvo/openni2/image_device.hpp"
#include "plvo/openni2/oni_messages.hpp"

namespace plvo {

// Mark the child process: its argv[0], and an environment variable that keeps a program without
// play_oni_if_asked() from starting itself recursively.
inline constexpr const char* kOniPlayerName = "plvo-oni-player";
inline constexpr const char* kOniPlayerVariable = "PLVO_ONI_PLAYER";

class OniPlayer final : public ImageDevice {
 public:
  OniPlayer() = default;
  ~OniPlayer() override { close(); }
  OniPlayer(const OniPlayer&) = delete;
  OniPlayer& operator=(const OniPlayer&) = delete;

  // program: empty for this program. patience: longest silence before the child counts as hanging. Returns
  // kNotFound, kInvalidArgument (not a regular file), kDamaged (also if the reader crashes on the file), or
  // the child's error on opening the recording.
  Status open(const std::string& path, const std::string& program, std::chrono::milliseconds patience);
  void close();

  Status start() override { return {}; }
  Wait wait(int timeout_ms, DeviceImage& image) override;
  Status failure() const override { return failure_; }
  const StreamFormat& colour_format() const override { return recording().colour; }
  const StreamFormat& depth_format() const override { return recording().depth; }
  const OpenNi2DeviceInfo& info() const override { return recording().info; }
  bool is_file() const override { return true; }
  bool registered() const override { return true; }
  bool at_end() const override { return at_end_; }
  int recorded_frames() override { return recording().frames; }

 private:
  Status spawn(const std::string& path, const std::string& program);
  OniMessageReader::Message receive(std::chrono::steady_clock::time_point deadline);
  void break_off(const Status& failure);
  Status obituary();
  const OniRecording& recording() const { return *reader_.recording(); }

  std::string path_;
  std::chrono::milliseconds patience_{0};
  pid_t child_ = -1;
  int socket_ = -1;
  OniMessageReader reader_;
  std::chrono::steady_clock::time_point last_heard_;
  bool at_end_ = false;
  bool closed_by_child_ = false;
  Status failure_;
};

}  // namespace plvo

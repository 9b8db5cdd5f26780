// SPDX-License-Identifier: Apache-2.0
// Messages from the process that plays an .oni file to its parent, over a socket: one description of the
// recording, then the images, then the final result. The reader does not trust the sender: the file may be
// maliciously damaged, so every value is checked against limits before it is used or memory is allocated.
// Internal to this module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plvo/openni2/image_device.hpp"

namespace plvo {

struct OniRecording {
  StreamFormat colour, depth;
  OpenNi2DeviceInfo info;
  int frames = 0;  // pairs
};

// The bytes of each message, to be written to the socket in sequence.
std::vector<std::uint8_t> oni_hello(const OniRecording& recording);
// If the image's data is null, no pixels follow the head.
std::vector<std::uint8_t> oni_image_head(const DeviceImage& image);
std::vector<std::uint8_t> oni_end();
std::vector<std::uint8_t> oni_failure(const Status& status);

// Assembles messages from bytes that arrive in blocks of any size. Memory: the sizes of the two images, known
// (and bounded) after the first message.
class OniMessageReader {
 public:
  enum class Message : std::uint8_t {
    kPartial,  // more bytes are needed
    kHello,    // recording() is known
    kImage,    // image() is valid until the next call
    kEnd,      // end of the recording
    kFailure,  // failure() is the player's status
    kInvalid,  // not a valid message: failure() describes it, and reading cannot continue
  };

  // The memory for the next bytes, never empty. Call advance() with the number of bytes received.
  std::span<std::uint8_t> space();
  Message advance(std::size_t bytes);

  const std::optional<OniRecording>& recording() const { return recording_; }
  const DeviceImage& image() const { return image_; }
  const Status& failure() const { return failure_; }

 private:
  Message begin();     // called when a head is complete
  Message complete();  // called when a body is complete
  Message read_hello();
  Message begin_image();
  Message read_failure();
  Message invalid(const char* what);

  std::vector<std::uint8_t> head_ = std::vector<std::uint8_t>(kHeadBytes);
  std::vector<std::uint8_t> body_;
  std::size_t filled_ = 0;  // bytes of the head received, or of the body if in_body_
  std::size_t wanted_ = 0;  // size of the body
  bool in_body_ = false;
  bool over_ = false;
  std::optional<OniRecording> recording_;
  DeviceImage image_;
  int indices_[2] = {0, 0};
  Status failure_;

 public:
  static constexpr std::size_t kHeadBytes = 40;
};

}  // namespace plvo

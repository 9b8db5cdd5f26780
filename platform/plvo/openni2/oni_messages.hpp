// SPDX-License-Identifier: Apache-2.0
// What the process that plays an .oni file says to the one that asked for it, over a socket: once what the
// recording is, then image after image, then how it ended. The reader believes nothing: the player works on a
// file that may be damaged on purpose, so whatever it sends is checked against limits before it is used or
// allocated. Internal to this room.
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

// Bytes of messages, to be written to the socket one after the other.
std::vector<std::uint8_t> oni_hello(const OniRecording& recording);
// An image whose data is null has no pixels after its head.
std::vector<std::uint8_t> oni_image_head(const DeviceImage& image);
std::vector<std::uint8_t> oni_end();
std::vector<std::uint8_t> oni_failure(const Status& status);

// Puts messages together from bytes that come as they like. Memory: the two images' sizes, known (and
// bounded) from the first message on.
class OniMessageReader {
 public:
  enum class Message : std::uint8_t {
    kPartial,  // more bytes are needed
    kHello,    // recording() is known
    kImage,    // image(): until the next call
    kEnd,      // the recording is over
    kFailure,  // failure(): what the player said
    kInvalid,  // not what a player says: failure() names it, and nothing more can be read
  };

  // Where the next bytes go: never empty. Then advance() by as many as came.
  std::span<std::uint8_t> space();
  Message advance(std::size_t bytes);

  const std::optional<OniRecording>& recording() const { return recording_; }
  const DeviceImage& image() const { return image_; }
  const Status& failure() const { return failure_; }

 private:
  Message begin();     // a head is complete
  Message complete();  // a body is complete
  Message read_hello();
  Message begin_image();
  Message read_failure();
  Message invalid(const char* what);

  std::vector<std::uint8_t> head_ = std::vector<std::uint8_t>(kHeadBytes);
  std::vector<std::uint8_t> body_;
  std::size_t filled_ = 0;  // of the head, or of the body once in_body_
  std::size_t wanted_ = 0;  // of the body
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

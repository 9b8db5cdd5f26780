// SPDX-License-Identifier: Apache-2.0
// Failure as a value. A Status says what went wrong and tells the user what to do about it. It contains its
// text, so it owns no memory, needs no other object to stay alive, and can be copied across any boundary.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace plvo {

enum class StatusCode : std::uint8_t {
  kOk,
  kInvalidArgument,  // the caller passed a NaN, a wrong size or a null pointer
  kOutOfMemory,      // the caller's memory block is too small
  kNotFound,         // a file, folder or device does not exist
  kPermission,       // it exists, but access is denied
  kBusy,             // it is in use elsewhere
  kDamaged,          // the data is corrupt; the next item may be good
  kEndOfStream,      // no further data will come
  kTimeout,          // no data came in time; more may come later
  kUnplugged,        // the device was disconnected; it may come back
  kUnsupported,      // valid, but this build or device does not support it
  kIo,               // the operating system reported a read or write error
  kTooFewFeatures,   // the frame has too few features to solve for a motion
  kNoConsensus,      // RANSAC found no motion that enough matches agree on
  kDegenerate,       // the constraints do not determine all six degrees of freedom
  kNotConverged,     // an iteration reached its limit
};

// Name of a code, for logs and tables ("ok", "invalid_argument", …).
const char* to_string(StatusCode code);

class [[nodiscard]] Status {
 public:
  static constexpr std::size_t kCapacity = 248;

  constexpr Status() = default;
  // Text beyond the capacity is cut off at a UTF-8 character boundary.
  constexpr Status(StatusCode code, std::string_view message) : code_(code) { append(message); }

  constexpr bool ok() const { return code_ == StatusCode::kOk; }
  constexpr StatusCode code() const { return code_; }
  constexpr const char* message() const { return message_; }

  // Both overloads of append() return *this, so that one expression can build a message.
  constexpr Status& append(std::string_view text) {
    std::size_t count = text.size();
    const std::size_t room = kCapacity - 1 - length_;
    if (count > room) {
      count = room;
      while (count > 0 && (static_cast<unsigned char>(text[count]) & 0xc0U) == 0x80U) --count;
    }
    for (std::size_t i = 0; i < count; ++i) message_[length_++] = text[i];
    message_[length_] = '\0';
    return *this;
  }
  constexpr Status& append(std::ptrdiff_t value) {  // as wide as a pointer
    if (value < 0) append("-");
    std::size_t rest = value < 0 ? ~static_cast<std::size_t>(value) + 1 : static_cast<std::size_t>(value);
    char digits[20] = {};
    std::size_t n = 0;
    do {
      digits[n++] = static_cast<char>('0' + rest % 10);
      rest /= 10;
    } while (rest != 0);
    while (n > 0) append(std::string_view(&digits[--n], 1));
    return *this;
  }

 private:
  StatusCode code_ = StatusCode::kOk;
  std::size_t length_ = 0;
  char message_[kCapacity] = {};
};

}  // namespace plvo

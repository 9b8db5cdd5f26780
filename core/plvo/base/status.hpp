// SPDX-License-Identifier: Apache-2.0
// Failure as a value. A Status says what went wrong and, in words a user can act on, what to do. It holds its
// text itself, so it owns no memory, outlives whatever caused it, and can be copied across any boundary.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace plvo {

enum class StatusCode : std::uint8_t {
  kOk,
  kInvalidArgument,  // the caller passed nonsense: a NaN, a wrong size, a null pointer
  kOutOfMemory,      // the caller's block is too small
  kNotFound,         // a file, folder or device is not there
  kPermission,       // it is there, but may not be used
  kBusy,             // somebody else holds it
  kDamaged,          // the data is broken; the next item may be good
  kEndOfStream,      // nothing more will come
  kTimeout,          // nothing came in time; something may come later
  kUnplugged,        // the device went away; it may come back
  kUnsupported,      // understood, but this build or device cannot
  kIo,               // the operating system refused to read or write
  kTooFewFeatures,   // the frame offers too little to solve for a motion
  kNoConsensus,      // RANSAC found no motion that enough matches agree on
  kDegenerate,       // the constraints do not determine all six degrees of freedom
  kNotConverged,     // an iteration reached its bound
};

// Name of a code, for logs and tables ("ok", "invalid_argument", …).
const char* to_string(StatusCode code);

class [[nodiscard]] Status {
 public:
  static constexpr std::size_t kCapacity = 248;

  constexpr Status() = default;
  // Text beyond the capacity is cut off between two characters of UTF-8, never written past the end.
  constexpr Status(StatusCode code, std::string_view message) : code_(code) { append(message); }

  constexpr bool ok() const { return code_ == StatusCode::kOk; }
  constexpr StatusCode code() const { return code_; }
  constexpr const char* message() const { return message_; }

  // Append to the message; they return *this so that a message can be built in one expression.
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
  constexpr Status& append(std::ptrdiff_t value) {  // as wide as any size, and no wider than the processor
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

// SPDX-License-Identifier: Apache-2.0
#include "plvo/openni2/oni_messages.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "plvo/image/undistortion.hpp"

namespace plvo {
namespace {

// Both ends are the same program on the same machine, so numbers are sent in their memory representation.
enum Kind : std::uint32_t { kHello = 1, kImage = 2, kEnd = 3, kFailure = 4 };
constexpr std::uint32_t kMark = 0x504c564f;

struct Head {
  std::uint32_t mark, kind, body_bytes, stream;
  std::int32_t width, height;
  std::int64_t stamp_us;
  std::uint64_t code;  // status code of a failure
};
static_assert(sizeof(Head) == OniMessageReader::kHeadBytes && std::is_trivially_copyable_v<Head>);

struct WireFormat {
  std::int32_t width, height, fps;
  std::uint32_t format, mirrored, unused;
  double fov_x_rad, fov_y_rad;
};
struct Hello {
  std::array<WireFormat, 2> streams;  // colour, depth
  std::int32_t frames;
  std::uint32_t unused;
  std::array<char, 256> uri, vendor, name;
};
static_assert(std::is_trivially_copyable_v<Hello>);

constexpr std::int64_t kLongest_us =
    1'000'000'000'000'000;  // 31 years; keeps arithmetic on stamps from overflowing
constexpr std::size_t kMaxFailureBytes = Status::kCapacity;

std::vector<std::uint8_t> message(const Head& head, const void* body = nullptr) {
  std::vector<std::uint8_t> bytes(sizeof head + (body == nullptr ? 0 : head.body_bytes));
  std::memcpy(bytes.data(), &head, sizeof head);
  if (body != nullptr) std::memcpy(bytes.data() + sizeof head, body, head.body_bytes);
  return bytes;
}

Head head_of(Kind kind, std::size_t body_bytes) {
  return {kMark, kind, static_cast<std::uint32_t>(body_bytes), 0, 0, 0, 0, 0};
}

WireFormat to_wire(const StreamFormat& f) {
  return {f.width, f.height,    f.fps,      static_cast<std::uint32_t>(f.format), f.mirrored ? 1u : 0u,
          0,       f.fov_x_rad, f.fov_y_rad};
}

void put(std::array<char, 256>& to, const std::string& text) {
  std::copy_n(text.begin(), std::min(text.size(), to.size() - 1), to.begin());
}

// The text up to the first zero byte, without terminal control characters.
std::string text_of(const char* begin, std::size_t size) {
  std::string text(begin, std::find(begin, begin + size, '\0'));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  return text;
}

bool from_wire(const WireFormat& wire, bool colour, StreamFormat& f) {
  constexpr int kSide = UndistortionMap::kMaxSide;
  const bool known = colour ? wire.format <= 1 : wire.format == 2 || wire.format == 3;
  if (!known || wire.mirrored > 1 || wire.width < 1 || wire.width > kSide || wire.height < 1 ||
      wire.height > kSide || wire.fps < 0 || wire.fps > 10000)
    return false;
  f = {wire.width,     wire.height,    wire.fps,          static_cast<ImageFormat>(wire.format),
       wire.fov_x_rad, wire.fov_y_rad, wire.mirrored == 1};
  return true;
}

// True for a status that opening or playing a file can return. Any other code is invalid.
bool is_failure(std::uint64_t code) {
  constexpr std::array kCodes = {StatusCode::kNotFound,    StatusCode::kPermission,     StatusCode::kBusy,
                                 StatusCode::kDamaged,     StatusCode::kUnsupported,    StatusCode::kIo,
                                 StatusCode::kOutOfMemory, StatusCode::kInvalidArgument};
  return std::any_of(kCodes.begin(), kCodes.end(),
                     [code](StatusCode known) { return static_cast<std::uint64_t>(known) == code; });
}

}  // namespace

std::vector<std::uint8_t> oni_hello(const OniRecording& recording) {
  Hello hello{};
  hello.streams = {to_wire(recording.colour), to_wire(recording.depth)};
  hello.frames = recording.frames;
  put(hello.uri, recording.info.uri);
  put(hello.vendor, recording.info.vendor);
  put(hello.name, recording.info.name);
  return message(head_of(kHello, sizeof hello), &hello);
}

std::vector<std::uint8_t> oni_image_head(const DeviceImage& image) {
  Head head = head_of(kImage, image.data == nullptr ? 0 : 1);
  head.stream = image.stream;
  head.width = image.width;
  head.height = image.height;
  head.stamp_us = image.stamp_us;
  return message(head);
}

std::vector<std::uint8_t> oni_end() { return message(head_of(kEnd, 0)); }

std::vector<std::uint8_t> oni_failure(const Status& status) {
  const std::string_view text = status.message();
  Head head = head_of(kFailure, text.size());
  head.code = static_cast<std::uint64_t>(status.code());
  return message(head, text.data());
}

std::span<std::uint8_t> OniMessageReader::space() {
  return in_body_ ? std::span(body_).subspan(filled_, wanted_ - filled_) : std::span(head_).subspan(filled_);
}

OniMessageReader::Message OniMessageReader::advance(std::size_t bytes) {
  if (over_) return Message::kInvalid;
  filled_ += bytes;
  if (!in_body_) {
    if (filled_ < head_.size()) return Message::kPartial;
    filled_ = 0;
    return begin();
  }
  if (filled_ < wanted_) return Message::kPartial;
  filled_ = 0;
  in_body_ = false;
  return complete();
}

OniMessageReader::Message OniMessageReader::invalid(const char* what) {
  over_ = true;
  failure_ = Status(StatusCode::kIo, "the recording's player sent ").append(what);
  return Message::kInvalid;
}

OniMessageReader::Message OniMessageReader::begin() {
  Head head{};
  std::memcpy(&head, head_.data(), sizeof head);
  if (head.mark != kMark) return invalid("something that is not a message");
  switch (head.kind) {
    case kHello:
      if (recording_.has_value() || head.body_bytes != sizeof(Hello)) return invalid("a wrong greeting");
      break;
    case kImage: return begin_image();
    case kEnd: return recording_.has_value() ? Message::kEnd : invalid("an end without a beginning");
    case kFailure:
      if (head.body_bytes >= kMaxFailureBytes || !is_failure(head.code)) return invalid("a wrong failure");
      if (head.body_bytes == 0) return read_failure();
      break;
    default: return invalid("a message of no known kind");
  }
  wanted_ = head.body_bytes;
  body_.resize(std::max(body_.size(), wanted_));
  in_body_ = true;
  return Message::kPartial;
}

OniMessageReader::Message OniMessageReader::begin_image() {
  Head head{};
  std::memcpy(&head, head_.data(), sizeof head);
  if (!recording_.has_value()) return invalid("an image without a greeting");
  if (head.stream > 1 || head.body_bytes > 1) return invalid("a wrong image");
  const bool colour = head.stream == FramePairer::kColour;
  const StreamFormat& format = colour ? recording_->colour : recording_->depth;
  image_ = {};
  image_.stream = colour ? FramePairer::kColour : FramePairer::kDepth;
  image_.index = ++indices_[head.stream];
  image_.width = head.width;
  image_.height = head.height;
  image_.stamp_us = head.stamp_us;
  // An image with a stamp out of range is damaged.
  const bool usable_stamp = head.stamp_us >= 0 && head.stamp_us <= kLongest_us;
  if (!usable_stamp) image_.stamp_us = 0;
  if (head.body_bytes == 0) return Message::kImage;
  if (head.width != format.width || head.height != format.height) return invalid("an image of a wrong size");
  image_.stride_bytes = static_cast<std::ptrdiff_t>(format.row_bytes());
  wanted_ = format.image_bytes();
  body_.resize(std::max(body_.size(), wanted_));
  image_.data = usable_stamp ? body_.data() : nullptr;
  in_body_ = true;
  return Message::kPartial;
}

OniMessageReader::Message OniMessageReader::complete() {
  Head head{};
  std::memcpy(&head, head_.data(), sizeof head);
  if (head.kind == kHello) return read_hello();
  if (head.kind == kFailure) return read_failure();
  return Message::kImage;
}

OniMessageReader::Message OniMessageReader::read_hello() {
  Hello hello{};
  std::memcpy(&hello, body_.data(), sizeof hello);
  OniRecording recording;
  if (!from_wire(hello.streams[0], true, recording.colour) ||
      !from_wire(hello.streams[1], false, recording.depth) ||
      recording.colour.width != recording.depth.width || recording.colour.height != recording.depth.height)
    return invalid("a greeting with impossible images");
  recording.frames = std::max(hello.frames, -1);
  recording.info.uri = text_of(hello.uri.data(), hello.uri.size());
  recording.info.vendor = text_of(hello.vendor.data(), hello.vendor.size());
  recording.info.name = text_of(hello.name.data(), hello.name.size());
  recording_ = recording;
  return Message::kHello;
}

OniMessageReader::Message OniMessageReader::read_failure() {
  Head head{};
  std::memcpy(&head, head_.data(), sizeof head);
  const std::string text = text_of(reinterpret_cast<const char*>(body_.data()), head.body_bytes);
  failure_ = Status(static_cast<StatusCode>(head.code),
                    text.empty() ? "the recording cannot be played, and its player does not say why" : text);
  over_ = true;
  return Message::kFailure;
}

}  // namespace plvo

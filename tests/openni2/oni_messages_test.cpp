// SPDX-License-Identifier: Apache-2.0
// The messages of a player of .oni files: the reader reassembles them from fragments of any size and
// validates every field.
#include "plvo/openni2/oni_messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace plvo {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Message = OniMessageReader::Message;

OniRecording small() {
  OniRecording recording;
  recording.colour = {4, 3, 30, ImageFormat::kRgb888, 1.0, 0.8, false};
  recording.depth = {4, 3, 30, ImageFormat::kDepth1Mm, 1.1, 0.9, true};
  recording.info = {"recording.oni", "PrimeSense", "oni\x1b[31m File", 0, 0};
  recording.frames = 7;
  return recording;
}

DeviceImage image_of(FramePairer::Stream stream, std::int64_t stamp_us, const Bytes& pixels) {
  DeviceImage image;
  image.stream = stream;
  image.width = 4;
  image.height = 3;
  image.stamp_us = stamp_us;
  image.data = pixels.data();
  return image;
}

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

// Messages decoded from `bytes`, in fragments of at most `step` bytes; kPartial is omitted.
std::vector<Message> read(OniMessageReader& reader, const Bytes& bytes, std::size_t step) {
  std::vector<Message> messages;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::span<std::uint8_t> space = reader.space();
    const std::size_t n = std::min({space.size(), bytes.size() - at, step});
    std::memcpy(space.data(), bytes.data() + at, n);
    at += n;
    const Message message = reader.advance(n);
    if (message != Message::kPartial) messages.push_back(message);
    if (message == Message::kInvalid) break;
  }
  return messages;
}

TEST(OniMessages, AreReassembledFromAnyFragments) {
  Bytes colour(36), depth(24);
  for (std::size_t i = 0; i < colour.size(); ++i) colour[i] = static_cast<std::uint8_t>(i);
  Bytes bytes = oni_hello(small());
  append(bytes, oni_image_head(image_of(FramePairer::kDepth, 90, depth)));
  append(bytes, depth);
  append(bytes, oni_image_head(image_of(FramePairer::kColour, 100, colour)));
  append(bytes, colour);
  for (const std::size_t step : {std::size_t{1}, std::size_t{7}, std::size_t{100000}}) {
    OniMessageReader reader;
    EXPECT_EQ(read(reader, bytes, step),
              (std::vector<Message>{Message::kHello, Message::kImage, Message::kImage}));
    EXPECT_EQ(reader.recording()->frames, 7);
    EXPECT_EQ(reader.recording()->info.name, "oni [31m File") << "no commands for a terminal";
    EXPECT_TRUE(reader.recording()->depth.mirrored);
    EXPECT_EQ(reader.image().stamp_us, 100);
    EXPECT_EQ(reader.image().index, 1);
    EXPECT_TRUE(std::equal(colour.begin(), colour.end(), reader.image().data));
    EXPECT_EQ(read(reader, oni_end(), step), std::vector<Message>{Message::kEnd});
  }
}

TEST(OniMessages, CarryFailuresAndImagesWithoutPixels) {
  OniMessageReader reader;
  DeviceImage odd;
  odd.width = 9;
  Bytes bytes = oni_hello(small());
  append(bytes, oni_image_head(odd));
  append(bytes, oni_failure(Status(StatusCode::kDamaged, "broken")));
  EXPECT_EQ(read(reader, bytes, 50),
            (std::vector<Message>{Message::kHello, Message::kImage, Message::kFailure}));
  EXPECT_EQ(reader.image().data, nullptr);
  EXPECT_EQ(reader.image().width, 9);
  EXPECT_EQ(reader.failure().code(), StatusCode::kDamaged);
  EXPECT_STREQ(reader.failure().message(), "broken");
}

// Found by fuzz_oni_messages: a failure has a message even if the player sends none.
TEST(OniMessages, FailureWithoutTextGetsADefaultText) {
  for (const char* words : {"", "\n"}) {
    OniMessageReader reader;
    EXPECT_EQ(read(reader, oni_failure(Status(StatusCode::kIo, words)), 50),
              std::vector<Message>{Message::kFailure});
    EXPECT_FALSE(std::string_view(reader.failure().message()).empty());
  }
}

TEST(OniMessages, InvalidMessagesAreRefused) {
  const auto refused = [](const Bytes& bytes) {
    OniMessageReader reader;
    const std::vector<Message> messages = read(reader, bytes, 100000);
    return !messages.empty() && messages.back() == Message::kInvalid && !reader.failure().ok();
  };
  const Bytes pixels(36);
  EXPECT_TRUE(refused(Bytes(40, 'x')));
  EXPECT_TRUE(refused(oni_end())) << "before it began";
  EXPECT_TRUE(refused(oni_image_head(image_of(FramePairer::kColour, 1, pixels))));
  Bytes twice = oni_hello(small());
  append(twice, oni_hello(small()));
  EXPECT_TRUE(refused(twice));
  for (const int side : {0, -1, 2048, 1 << 30}) {
    OniRecording recording = small();
    recording.colour.width = recording.depth.width = side;
    EXPECT_TRUE(refused(oni_hello(recording))) << side;
  }
  OniRecording swapped = small();
  std::swap(swapped.colour.format, swapped.depth.format);
  EXPECT_TRUE(refused(oni_hello(swapped)));
  OniRecording unlike = small();
  unlike.depth.height = 2;
  EXPECT_TRUE(refused(oni_hello(unlike)));
  Bytes larger = oni_hello(small());
  DeviceImage image = image_of(FramePairer::kColour, 1, pixels);
  image.height = 4000;
  append(larger, oni_image_head(image));
  EXPECT_TRUE(refused(larger));
  EXPECT_TRUE(refused(oni_failure(Status())));  // a failure message with an ok status
}

// Arithmetic on stamps must not overflow for any value in a file: an image with such a stamp counts as
// damaged.
TEST(OniMessages, ImagesWithImpossibleStampsCountAsDamaged) {
  const Bytes pixels(24);
  for (const std::int64_t stamp : {std::int64_t{-1}, std::int64_t{1} << 60, std::int64_t{-1} << 62}) {
    OniMessageReader reader;
    Bytes bytes = oni_hello(small());
    append(bytes, oni_image_head(image_of(FramePairer::kDepth, stamp, pixels)));
    append(bytes, pixels);
    EXPECT_EQ(read(reader, bytes, 1000).back(), Message::kImage);
    EXPECT_EQ(reader.image().data, nullptr) << stamp;
  }
}

}  // namespace
}  // namespace plvo

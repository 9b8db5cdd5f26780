// SPDX-License-Identifier: Apache-2.0
// The container: complete, compressed, truncated at any byte, damaged, and of another format.
#include "plvo/rosbag/containers/bag_file.hpp"

#include <gtest/gtest.h>

#include "bag_writer.hpp"
#include "plvo/rosbag/messages/messages.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::BagWriter;
using test::says;
using test::TemporaryFolder;
using test::write_file;

std::string image_of(int number) {
  return test::image_message(number * 1'000'000'000LL, 4, 1, "rgb8", 12,
                             std::string(12, static_cast<char>('a' + number)));
}

// Six images and six messages of another type, two of each per chunk.
BagWriter small_bag(const std::string& compression) {
  BagWriter writer;
  writer.connection(3, "/camera/rgb/image_color", "sensor_msgs/Image");
  writer.connection(9, "/tf", "tf2_msgs/TFMessage");
  for (int i = 0; i < 6; ++i) {
    writer.message(3, 50 + i, image_of(i));
    writer.message(9, 50 + i, "any bytes");
    if (i % 2 == 1) writer.end_chunk(compression);
  }
  return writer;
}

// The messages of the only image topic; empty if its connection is missing.
std::vector<BagMessage> images_of(const BagFile& bag) {
  std::vector<BagMessage> messages;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
    if (is_image_type(bag.topics()[i].type))
      messages.insert(messages.end(), bag.messages(i).begin(), bag.messages(i).end());
  return messages;
}

TEST(BagFile, ReadsMessagesWithEveryCompression) {
  const TemporaryFolder folder;
  for (const char* compression : {"none", "bz2", "lz4"}) {
    write_file(folder / "a.bag", small_bag(compression).file());
    BagFile bag;
    const Status status = bag.open(folder / "a.bag");
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(bag.remark(), "") << compression;
    ASSERT_EQ(bag.topics().size(), 2u);
    EXPECT_EQ(bag.topics()[0].name, "/camera/rgb/image_color");
    EXPECT_EQ(bag.topics()[0].type, "sensor_msgs/Image");
    EXPECT_EQ(bag.topics()[0].messages, 6u);
    EXPECT_EQ(bag.topics()[1].messages, 6u);
    ASSERT_EQ(bag.messages(0).size(), 6u);
    std::vector<unsigned char> bytes;
    // Backwards, so that chunks are unpacked again.
    for (int i = 5; i >= 0; --i) {
      const BagMessage& message = bag.messages(0)[static_cast<std::size_t>(i)];
      EXPECT_EQ(message.stamp_ns, i * 1'000'000'000LL) << "of the header";
      ASSERT_TRUE(bag.read(message, bytes).ok());
      EXPECT_EQ(std::string(bytes.begin(), bytes.end()), image_of(i)) << compression << i;
    }
  }
}

TEST(BagFile, KeepsMessagesBeforeAnyTruncation) {
  const TemporaryFolder folder;
  const std::string whole = small_bag("none").file();
  std::size_t last = 0;
  for (std::size_t size = 13; size < whole.size(); size += 3) {
    write_file(folder / "a.bag", whole.substr(0, size));
    BagFile bag;
    ASSERT_TRUE(bag.open(folder / "a.bag").ok());
    EXPECT_TRUE(bag.remark().starts_with("a.bag is cut short; what lies before byte ") ||
                (bag.remark().empty() && images_of(bag).size() == 6))
        << size << bag.remark();
    // All messages whose last byte is still in the file, and no others.
    std::size_t expected = 0;
    for (int i = 0; i < 6; ++i) {
      const std::size_t start = whole.find(image_of(i));
      expected += start + image_of(i).size() <= size ? 1 : 0;
    }
    ASSERT_EQ(images_of(bag).size(), expected) << size;
    std::vector<unsigned char> bytes;
    for (const BagMessage& message : images_of(bag)) ASSERT_TRUE(bag.read(message, bytes).ok());
    last = expected;
  }
  EXPECT_EQ(last, 6u);
  // A truncated compressed chunk is lost; the chunks before it are kept.
  for (const char* compression : {"bz2", "lz4"}) {
    const std::string packed = small_bag(compression).file();
    write_file(folder / "a.bag", packed.substr(0, packed.rfind("compression=") + 100));
    BagFile bag;
    ASSERT_TRUE(bag.open(folder / "a.bag").ok());
    EXPECT_EQ(images_of(bag).size(), 4u) << compression;
    EXPECT_NE(bag.remark(), "");
  }
}

TEST(BagFile, ReadsTheBagOfACrashedRecorder) {
  const TemporaryFolder folder;
  BagWriter writer = small_bag("none");
  writer.message(3, 99, image_of(6));
  writer.message(3, 99, image_of(7));
  write_file(folder / "a.bag", writer.file(false));
  BagFile bag;
  ASSERT_TRUE(bag.open(folder / "a.bag").ok());
  EXPECT_EQ(images_of(bag).size(), 8u);
  EXPECT_TRUE(bag.remark().starts_with("a.bag is cut short")) << bag.remark();
}

// Any byte may change: the reader does not read beyond the data (the sanitizers check this), and every
// message that it returns is complete.
TEST(BagFile, LosesOnlyDamagedMessages) {
  const TemporaryFolder folder;
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::string whole = small_bag(compression).file();
    std::size_t most = 0;
    for (std::size_t i = 13; i < whole.size(); i += 13) {
      for (const char byte : {'\0', '\xff', static_cast<char>(whole[i] ^ 1)}) {
        std::string damaged = whole;
        damaged[i] = byte;
        write_file(folder / "a.bag", damaged);
        BagFile bag;
        ASSERT_TRUE(bag.open(folder / "a.bag").ok());
        std::vector<unsigned char> bytes;
        for (const BagMessage& message : images_of(bag)) ASSERT_TRUE(bag.read(message, bytes).ok());
        most = std::max(most, images_of(bag).size());
      }
    }
    EXPECT_EQ(most, 6u);
  }
}

TEST(BagFile, SkipsAChunkThatDoesNotUnpack) {
  const TemporaryFolder folder;
  for (const char* compression : {"bz2", "lz4"}) {
    std::string file = small_bag(compression).file();
    const std::size_t second = file.find("compression=", file.find("compression=") + 1);
    for (std::size_t i = 60; i < 80; ++i) file[second + i] = 'x';
    write_file(folder / "a.bag", file);
    BagFile bag;
    ASSERT_TRUE(bag.open(folder / "a.bag").ok());
    EXPECT_EQ(images_of(bag).size(), 4u) << compression;
    EXPECT_EQ(bag.remark(), "1 damaged pieces of a.bag are left out") << compression;
  }
}

// A small chunk that claims to unpack to 4 GB.
TEST(BagFile, BoundsTheClaimedSizeOfAChunk) {
  const TemporaryFolder folder;
  std::string file = small_bag("bz2").file();
  file.replace(file.find("size=") + 5, 4, "\xff\xff\xff\xff");
  write_file(folder / "a.bag", file);
  BagFile bag;
  ASSERT_TRUE(bag.open(folder / "a.bag").ok());
  EXPECT_EQ(images_of(bag).size(), 0u) << "the connections were in the first piece";
  EXPECT_NE(bag.remark(), "");
}

// A recursive reader would overflow the stack.
TEST(BagFile, RejectsNestedChunks) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](const std::string& file) {
    write_file(folder / "a.bag", file);
    BagFile bag;
    const Status status = bag.open(folder / "a.bag");
    EXPECT_EQ(status.code(), StatusCode::kDamaged);
    EXPECT_TRUE(says(status, "a chunk lies within another")) << status.message();
  };
  for (const char* outer : {"none", "bz2", "lz4"})
    for (const char* inner : {"none", "bz2", "lz4"}) {
      BagWriter writer = small_bag(inner);
      writer.put(small_bag("none").packed_chunk(inner));
      writer.end_chunk(outer);
      expect_refused(writer.file());
    }
  constexpr std::size_t kDepth = 14'000;
  const std::size_t level = BagWriter::claim("none", 0, 0).size();
  std::string deep = small_bag("none").file(), wild = deep;
  for (std::size_t i = kDepth; i > 0; --i) {
    deep += BagWriter::claim("none", 0, static_cast<std::uint32_t>(level * (i - 1)));
    wild += BagWriter::claim("none", UINT32_MAX, UINT32_MAX);
  }
  expect_refused(deep);
  // Chunks with lengths that overrun the next one are damaged; only they are lost.
  write_file(folder / "a.bag", wild);
  BagFile bag;
  ASSERT_TRUE(bag.open(folder / "a.bag").ok());
  EXPECT_EQ(images_of(bag).size(), 6u);
  EXPECT_NE(bag.remark(), "");
}

// A chunk with a damaged length does not affect the chunks after it.
TEST(BagFile, LosesOnlyAChunkThatOverrunsTheNext) {
  const TemporaryFolder folder;
  std::string file = small_bag("none").file();
  const std::size_t second = file.find("compression=none", file.find("compression=none") + 1);
  const std::size_t length = second + std::string("compression=none").size() + 4 + 5 + 4;
  file[length + 3] = '\x7f';
  write_file(folder / "a.bag", file);
  BagFile bag;
  ASSERT_TRUE(bag.open(folder / "a.bag").ok());
  EXPECT_EQ(images_of(bag).size(), 6u);
  EXPECT_EQ(bag.remark(), "1 damaged pieces of a.bag are left out");
}

TEST(BagFile, RejectsFilesThatAreNotBags) {
  const TemporaryFolder folder;
  EXPECT_EQ(BagFile().open(folder / "none.bag").code(), StatusCode::kNotFound);
  EXPECT_TRUE(says(BagFile().open(folder.path()), "is not a regular file"));
  EXPECT_TRUE(says(BagFile().open("/dev/zero"), "is not a regular file"));
  write_file(folder / "a.bag", "");
  EXPECT_TRUE(says(BagFile().open(folder / "a.bag"), "is not a ROS 1 bag"));
  write_file(folder / "a.bag", "SQLite format 3 and so on");
  EXPECT_TRUE(says(BagFile().open(folder / "a.bag"), "is not a ROS 1 bag"));
  write_file(folder / "a.bag", "#ROSRECORD V1.2\n and so on");
  EXPECT_TRUE(
      says(BagFile().open(folder / "a.bag"), "of another version than 2.0; convert it with rosbag migrate"));
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Bags that are small on disk but large in memory: the largest number of messages, one more, and records that
// claim gigabytes, with and without holes in the file. All stay below the memory ceiling of a reader.
#include <gtest/gtest.h>

#include "bag_writer.hpp"
#include "peak_memory.hpp"
#include "plvo/rosbag/bag_camera.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::BagWriter;
using test::expect_within_the_ceiling;
using test::says;
using test::TemporaryFolder;
using test::wire_time;
using test::wire_u32;
using test::write_file;

constexpr const char* kColour = "/camera/rgb/image_color";
constexpr const char* kDepthTopic = "/camera/depth/image";

// The shortest message with a readable stamp, in the shortest record.
std::string shortest_record(std::uint32_t connection, std::int64_t stamp_ns) {
  return BagWriter::record({{"op", "\2"}, {"conn", wire_u32(connection)}}, wire_u32(0) + wire_time(stamp_ns));
}

class BagMemory : public ::testing::Test {
 protected:
  // Writes colour and depth alternately, with stamps that pair.
  void write_images(std::size_t count) const {
    BagWriter writer;
    writer.connection(0, kColour, kImageType);
    writer.connection(1, kDepthTopic, kImageType);
    for (std::size_t i = 0; i < count; ++i)
      writer.put(shortest_record(i % 2, static_cast<std::int64_t>(i / 2) * 33'000'000));
    writer.end_chunk("lz4");
    write_file(path_, writer.file());
    EXPECT_LT(fs::file_size(path_), 32u << 20);
  }
  // Extends the file with a hole to the size `bytes` that `text` claims.
  void write_with_holes(const std::string& text, std::uintmax_t bytes) const {
    write_file(path_, text);
    fs::resize_file(path_, bytes);
  }

  const TemporaryFolder folder_;
  const fs::path path_ = folder_ / "a.bag";
};

TEST_F(BagMemory, ReadsTheLargestNumberOfImages) {
  write_images(kMostImages);
  expect_within_the_ceiling("images", [&] {
    BagCamera camera;
    Calibration calibration;
    return camera.index(path_, {}).ok() &&
           says(camera.open(calibration, {}, {}), "no image of the bag can be read");
  });
}

TEST_F(BagMemory, RejectsOneImageMore) {
  write_images(kMostImages + 1);
  expect_within_the_ceiling("too many images", [&] {
    const Status status = BagFile().open(path_);
    return status.code() == StatusCode::kInvalidArgument && says(status, "holds more than 1048576 images");
  });
}

// Repeats the same chunk of readings.
TEST_F(BagMemory, ReadsTheLargestNumberOfReadings) {
  constexpr std::size_t kChunks = 64, kMessages = kMostReadings / 2 / kChunks;
  BagWriter writer;
  writer.connection(0, "/imu", kImuType);
  for (std::size_t i = 0; i < kMessages; ++i)
    writer.message(
        0, 0,
        test::imu_message(static_cast<std::int64_t>(i + 1) * 1'000'000, {1, 2, 3}, true, {4, 5, 6}, true));
  const std::string chunk = writer.packed_chunk("lz4");
  std::string chunks;
  for (std::size_t i = 0; i < kChunks; ++i) chunks += chunk;
  writer.put_chunks(chunks);
  write_file(path_, writer.file());
  const auto read = [&](ImuRecording& recording) {
    BagFile bag;
    const Status status = bag.open(path_);
    return status.ok() ? read_bag_imu(bag, {}, recording) : status;
  };
  expect_within_the_ceiling("readings", [&] {
    ImuRecording recording;
    return read(recording).ok() && recording.gyro.size() == kMessages &&
           recording.ignored == kMostReadings - 2 * kMessages;
  });
  writer.put_chunks(chunk);
  write_file(path_, writer.file());
  expect_within_the_ceiling("too many readings", [&] {
    ImuRecording recording;
    return says(read(recording), "more than 4194304 readings");
  });
}

TEST_F(BagMemory, BoundsClaimsOfGigabytes) {
  constexpr std::uint32_t kMost = UINT32_MAX;
  constexpr std::uintmax_t kHoles = std::uintmax_t{1} << 33;
  BagWriter writer;
  writer.connection(0, kColour, kImageType);
  writer.end_chunk();
  const std::string start = writer.file();
  for (const char* compression : {"bz2", "lz4"})
    for (const std::uint32_t unpacked : {100u, kMost}) {
      write_with_holes(start + BagWriter::claim(compression, unpacked, kMost), kHoles);
      expect_within_the_ceiling("a chunk of holes", [&] {
        BagFile bag;
        return bag.open(path_).ok() && bag.messages(0).empty() &&
               bag.remark().find("are larger than the 72 MiB that are read") != std::string::npos;
      });
    }
  // A message in an uncompressed chunk, which is read in place.
  std::string message = shortest_record(0, 7);
  message.replace(message.size() - 16, 4, wire_u32(kMost - 1000));
  write_with_holes(start + BagWriter::claim("none", kMost, kMost) + message, kHoles);
  expect_within_the_ceiling("a message of holes", [&] {
    BagFile bag;
    std::vector<unsigned char> bytes;
    return bag.open(path_).ok() && bag.messages(0).size() == 1 &&
           says(bag.read(bag.messages(0)[0], bytes), "the message has 4294966295 bytes, and at most");
  });
}

// Names have a length limit, because a bag may have ten thousand topics.
TEST_F(BagMemory, RejectsTopicNamesOfKilobytes) {
  BagWriter writer;
  writer.connection(0, std::string("/").append(1000, 'x'), kImageType);
  writer.connection(1, kColour, std::string(1000, 'x'));
  writer.end_chunk("none");
  write_file(path_, writer.file());
  BagFile bag;
  ASSERT_TRUE(bag.open(path_).ok());
  EXPECT_TRUE(bag.topics().empty());
}

}  // namespace
}  // namespace plvo

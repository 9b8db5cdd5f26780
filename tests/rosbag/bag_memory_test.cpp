// SPDX-License-Identifier: Apache-2.0
// Bags that are small on disk but large in memory: the largest number of messages, one more, and records that
// claim gigabytes, with and without holes in the file. All stay below the memory ceiling of a reader.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "bag_writer.hpp"
#include "peak_memory.hpp"
#include "plvo/rosbag/bag_camera.hpp"
#include "plvo/rosbag/containers/bag_file.hpp"
#include "plvo/rosbag/containers/mcap_file.hpp"
#include "plvo/rosbag/containers/sqlite_file.hpp"
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

std::string mcap_record(char op, const std::string& data) {
  return std::string(1, op).append(test::wire(data.size(), 8)).append(data);
}

// An MCAP file with one compressed chunk: the shortest messages with a readable stamp, colour and depth
// alternately.
std::string mcap_of_images(std::size_t count) {
  std::string records;
  for (const auto& [number, topic] : {std::pair<std::uint64_t, const char*>{1, kColour}, {2, kDepthTopic}})
    records += mcap_record(3, test::wire(number, 2) + test::wire_text("sensor_msgs/msg/Image") +
                                  test::wire_text("ros2msg") + wire_u32(0)) +
               mcap_record(4, test::wire(number, 2) + test::wire(number, 2) + test::wire_text(topic) +
                                  test::wire_text("cdr") + wire_u32(0));
  for (std::size_t i = 0; i < count; ++i)
    records +=
        mcap_record(5, test::wire(1 + i % 2, 2) + std::string(4 + 8 + 8, '\0') + std::string("\0\1\0\0", 4) +
                           wire_time(static_cast<std::int64_t>(i / 2) * 33'000'000));
  std::string packed(LZ4F_compressFrameBound(records.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
  return "\x89MCAP0\r\n" +
         mcap_record(6, std::string(16, '\0') + test::wire(records.size(), 8) + wire_u32(0) +
                            test::wire_text("lz4") + test::wire(packed.size(), 8) + packed) +
         mcap_record(15, wire_u32(0));
}

TEST_F(BagMemory, ReadsTheLargestNumberOfImagesOfMcap) {
  write_file(folder_ / "a.mcap", mcap_of_images(kMostImages));
  expect_within_the_ceiling("images of MCAP", [&] {
    BagCamera camera;
    Calibration calibration;
    return camera.index(folder_ / "a.mcap", {}).ok() &&
           says(camera.open(calibration, {}, {}), "no image of the bag can be read");
  });
  write_file(folder_ / "a.mcap", mcap_of_images(kMostImages + 1));
  expect_within_the_ceiling("too many images of MCAP", [&] {
    return says(McapFile().open(folder_ / "a.mcap"), "holds more than 1048576 images");
  });
}

// A small file that claims to unpack to gigabytes.
TEST_F(BagMemory, BoundsWhatMcapUnpacksTo) {
  for (const std::uint64_t claimed : {std::uint64_t{1} << 33, std::uint64_t{1} << 62}) {
    const std::string chunk = std::string(16, '\0') + test::wire(claimed, 8) + wire_u32(0) +
                              test::wire_text("zstd") + test::wire(4, 8) + "\x28\xb5\x2f\xfd";
    write_file(folder_ / "a.mcap", "\x89MCAP0\r\n" + mcap_record(6, chunk) + mcap_record(15, wire_u32(0)));
    expect_within_the_ceiling("a claim of MCAP", [&] {
      McapFile file;
      return file.open(folder_ / "a.mcap").ok() &&
             file.remark().find("are larger than the 72 MiB that are read") != std::string::npos;
    });
  }
}

TEST_F(BagMemory, BoundsTheCellsOfADatabase) {
  const fs::path path = folder_ / "a.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const std::string statements =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
      "INSERT INTO topics VALUES (1, '/a', 'sensor_msgs/msg/Image', 'cdr');"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
      "INSERT INTO messages VALUES (1, 1, 1, zeroblob(100000000)), (2, 1, 2, zeroblob(12));";
  EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  expect_within_the_ceiling("cells", [&] {
    SqliteFile file;
    std::vector<unsigned char> bytes;
    return file.open(path).ok() && file.messages(0).size() == 2 &&
           file.read(file.messages(0)[1], bytes).ok() &&
           says(file.read(file.messages(0)[0], bytes), "the message has 100000000 bytes, and at most");
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

// SPDX-License-Identifier: Apache-2.0
// Malicious files: headers that claim more than the file holds, and paths that are not regular files. Every
// reader rejects them with a message, in bounded memory and without waiting.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <string>

#include "plvo/eval/uncertainty_file.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/index/tum_index.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::says;

namespace fs = std::filesystem;
using test::TemporaryFolder;
using test::write_file;

// Peak memory of this process, in KiB.
long peak_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long value = 0;
    if (word == "VmPeak:" && status >> value) return value;
  }
  return -1;
}

std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc32(type + data));
}

// A small PNG that is valid except for its pixels: the deflated data are empty.
std::string png(std::uint32_t width, std::uint32_t height, int bits, int colour_type) {
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(bits) +
                             static_cast<char>(colour_type) + std::string(3, '\0');
  const std::string nothing("\x78\x9c\x03\x00\x00\x00\x00\x01", 8);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", nothing) + chunk("IEND", "");
}

std::string jpeg(int width, int height) {
  std::string file("\xff\xd8\xff\xc0\x00\x11\x08", 7);
  for (const int side : {height, width})
    file += {static_cast<char>(side >> 8), static_cast<char>(side & 255)};
  return file + std::string(
                    "\x03\x01\x22\x00\x02\x11\x01\x03\x11\x01\xff\xda\x00\x0c\x03\x01\x00\x02\x11\x03\x11\x00"
                    "\x3f\x00",
                    24);
}

TEST(HostileFiles, AHeaderOf16384PixelsAllocatesNothing) {
  const TemporaryFolder folder;
  write_file(folder / "rgb.txt", "1.0 rgb.png\n");
  write_file(folder / "depth.txt", "1.0 depth.png\n");
  write_file(folder / "rgb.png", png(16384, 16384, 8, 2));
  write_file(folder / "depth.png", png(16384, 16384, 16, 0));
  ASSERT_LT(fs::file_size(folder / "rgb.png"), 80u);
  Calibration calibration;
  ASSERT_TRUE(builtin_calibration("kinect-v1-default", calibration).ok());
  calibration.has_size = false;
  const long before = peak_kib();
  RecordedCamera camera;
  const Status status = camera.open(folder.path(), calibration);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(says(status, "says that it is 16384x16384; images of at most 4096x4096 are read"))
      << status.message();
  EXPECT_LT(peak_kib() - before, 64 * 1024);
}

TEST(HostileFiles, SizesAreJudgedByTheHeaderAlone) {
  const TemporaryFolder folder;
  const fs::path path = folder / "image";
  ImageDecoder decoder;
  ImageInfo info;
  for (const std::uint32_t side : {4097u, 65535u, 0x7fffffffu}) {
    write_file(path, png(side, 480, 8, 2));
    EXPECT_FALSE(decoder.read_header(path, info).ok()) << side;
    write_file(path, png(640, side, 16, 0));
    EXPECT_FALSE(decoder.read_header(path, info).ok()) << side;
  }
  write_file(path, png(4096, 4096, 8, 2));
  EXPECT_TRUE(decoder.read_header(path, info).ok());
  for (const int side : {4097, 65500}) {
    write_file(path, jpeg(side, 64));
    EXPECT_TRUE(says(decoder.read_header(path, info), "images of at most 4096x4096")) << side;
  }
  write_file(path, jpeg(4096, 64));
  EXPECT_TRUE(decoder.read_header(path, info).ok());
  // Later images must have the size of the first one; their headers are checked, too.
  std::vector<std::uint8_t> rgb(std::size_t{3} * 64 * 64);
  write_file(path, png(16384, 16384, 8, 2));
  const long before = peak_kib();
  EXPECT_EQ(decoder.decode_rgb(path, 64, 64, rgb).code(), StatusCode::kInvalidArgument);
  EXPECT_LT(peak_kib() - before, 64 * 1024);
}

// If each word of such a row were stored, it would take fifty times its size.
TEST(HostileFiles, DoesNotStoreATableOfShortestRows) {
  const TemporaryFolder folder;
  std::string rows(16u << 20, '\n');
  for (std::size_t i = 0; i < rows.size(); i += 2) rows[i] = '1';
  write_file(folder / "t.txt", rows);
  const long before = peak_kib();
  Trajectory trajectory;
  const Status status = read_trajectory({folder / "t.txt", {}, {}}, trajectory);
  EXPECT_TRUE(says(status, "line 1: has 1 columns where 8 are needed")) << status.message();
  EXPECT_LT(peak_kib() - before, 64 * 1024);
}

// A zlib stream of one zero and `matches` runs of 258 zeros: deflate's fixed codes, 13 bits for 258 bytes.
std::string zeros_in_zlib(std::uint32_t matches) {
  std::string bits = "110";  // last block, fixed codes (the lower bit of a number first)
  bits += "00110000";        // a zero
  for (std::uint32_t i = 0; i < matches; ++i) bits += "1100010100000";  // 258 bytes from one byte back
  bits += "0000000";
  bits.append((8 - bits.size() % 8) % 8, '0');
  std::string stream("\x78\x9c", 2);
  for (std::size_t i = 0; i < bits.size(); i += 8) {
    int byte = 0;
    for (std::size_t k = 0; k < 8; ++k) byte |= (bits[i + k] - '0') << k;
    stream += static_cast<char>(byte);
  }
  return stream + big_endian((((258 * matches + 1) % 65521) << 16) | 1);  // Adler-32 of zeros
}

// The texts of a PNG of 100 kB that unpack to 256 MB.
TEST(HostileFiles, UnpackedTextsOfAPngAreBounded) {
  std::string file = png(64, 64, 8, 2);
  const std::string text = chunk("zTXt", std::string("x\0\0", 3) + zeros_in_zlib(62'500));
  for (int i = 0; i < 16; ++i) file.insert(33, text);  // after IHDR
  const TemporaryFolder folder;
  write_file(folder / "image", file);
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(std::size_t{3} * 64 * 64);
  const long before = peak_kib();
  const Status status = decoder.decode_rgb(folder / "image", 64, 64, rgb);
  EXPECT_EQ(status.code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(status, "limits")) << status.message();
  EXPECT_LT(peak_kib() - before, 32 * 1024);
}

// The bound on unpacked texts does not limit the pixels, even if they come in a single chunk.
TEST(HostileFiles, ReadsTheLargestImage) {
  constexpr int kSide = kMaxImageSide;
  const std::size_t row = 1 + 3 * std::size_t{kSide};
  // Stored blocks of zlib, in one chunk of 50 MB.
  std::string pixels("\x78\x01", 2);
  for (std::size_t left = row * kSide; left > 0;) {
    const std::size_t size = std::min<std::size_t>(left, 65535);
    left -= size;
    const std::string length = {static_cast<char>(size & 255), static_cast<char>(size >> 8)};
    pixels += std::string(1, left == 0 ? '\1' : '\0') + length + static_cast<char>(~length[0]) +
              static_cast<char>(~length[1]) + std::string(size, '\0');
  }
  pixels += big_endian((static_cast<std::uint32_t>(row * kSide % 65521) << 16) | 1);
  std::string file = png(kSide, kSide, 8, 2);
  file.replace(33, 20, chunk("IDAT", pixels));
  const TemporaryFolder folder;
  write_file(folder / "image", file);
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(std::size_t{3} * kSide * kSide, 1);
  const Status status = decoder.decode_rgb(folder / "image", kSide, kSide, rgb);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(rgb.back(), 0);
}

struct Reader {
  const char* name;
  std::function<Status(const fs::path&)> read;
};

const std::array<Reader, 11>& readers() {
  static const std::array<Reader, 11> all = {{
      {"calibration.txt",
       [](const fs::path& path) {
         Calibration calibration;
         return read_calibration(path, calibration);
       }},
      {"calibration.yaml",
       [](const fs::path& path) {
         Calibration calibration;
         return read_calibration(path, calibration);
       }},
      {"associations.txt",
       [](const fs::path& path) {
         SequenceIndex index;
         return read_tum_index(path.parent_path(), path, 1, index);
       }},
      {"rgb.txt",
       [](const fs::path& path) {
         SequenceIndex index;
         return read_tum_index(path.parent_path(), {}, 1, index);
       }},
      {"colour.png",
       [](const fs::path& path) {
         ImageDecoder decoder;
         ImageInfo info;
         return decoder.read_header(path, info);
       }},
      {"depth.png",
       [](const fs::path& path) {
         ImageDecoder decoder;
         std::vector<std::uint16_t> depth(64);
         return decoder.decode_depth(path, 8, 8, depth);
       }},
      {"groundtruth.txt",
       [](const fs::path& path) {
         Trajectory trajectory;
         return read_ground_truth(path.parent_path(), {}, trajectory);
       }},
      {"times.txt",
       [](const fs::path& path) {
         const fs::path poses = path.parent_path() / "poses.txt";
         write_file(poses, "1 0 0 0 0 1 0 0 0 0 1 0\n");
         Trajectory trajectory;
         return read_trajectory({poses, TrajectoryFormat::kKitti, path}, trajectory);
       }},
      {"covariance.txt",
       [](const fs::path& path) {
         std::vector<eval::StampedCovariance> covariances;
         return eval::read_covariances(path, covariances);
       }},
      {"motions.txt",
       [](const fs::path& path) {
         std::vector<eval::UncertainMotion> motions;
         return eval::read_motions(path, motions);
       }},
      {kGyroFile,
       [](const fs::path& path) {
         ImuRecording recording;
         return read_imu_files(path.parent_path(), recording);
       }},
  }};
  return all;
}

TEST(HostileFiles, EveryReaderRefusesWhatIsNoFile) {
  for (const Reader& reader : readers()) {
    const TemporaryFolder folder;
    const fs::path path = folder / reader.name;
    const auto refused = [&](std::string_view words) {
      const long before = peak_kib();
      const Status status = reader.read(path);
      EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << reader.name << ": " << status.message();
      EXPECT_TRUE(says(status, words)) << reader.name << ": " << status.message();
      EXPECT_TRUE(says(status, reader.name)) << status.message();
      EXPECT_LT(peak_kib() - before, 16 * 1024) << reader.name;
      fs::remove_all(path);
    };
    fs::create_directory(path);
    refused("it is a folder");
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    refused("it is a pipe");
    fs::create_symlink("/dev/zero", path);
    refused("it is a device");
    write_file(path, "");
    fs::resize_file(path, std::uintmax_t{1} << 40);
    refused("1099511627776 bytes");
  }
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Files of the largest size and density that a reader accepts, and with one row or image more. They are read,
// or rejected with a message, always below the ceiling that reader_limits.hpp states. Bags:
// tests/rosbag/bag_memory_test.cpp.
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <memory>
#include <string>

#include "peak_memory.hpp"
#include "plvo/eval/uncertainty_file.hpp"
#include "plvo/host/files/input_file.hpp"
#include "plvo/host/files/trajectory_reader.hpp"
#include "plvo/recording/recording.hpp"
#include "plvo/replay/calibration/calibration.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/imu_files.hpp"
#include "plvo/replay/index/tum_index.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::expect_within_the_ceiling;
using test::says;
using test::TemporaryFolder;
using test::write_file;

// Rows that differ only in their stamp.
std::string rows(std::size_t count, const std::string& rest) {
  std::string text;
  for (std::size_t i = 1; i <= count; ++i) text += std::to_string(i) + rest + '\n';
  EXPECT_LE(text.size(), kMaxTextBytes);
  return text;
}

class ReaderMemory : public ::testing::Test {
 protected:
  const TemporaryFolder folder_;
};

TEST_F(ReaderMemory, ListsOfImages) {
  const auto write_lists = [&](std::size_t count, const std::string& name) {
    write_file(folder_ / "rgb.txt", rows(count, name));
    write_file(folder_ / "depth.txt", rows(count, name));
  };
  const auto open = [&] {
    const auto choose = [](const OwnCalibration&, Calibration& calibration) {
      return builtin_calibration("tum-fr3", calibration);
    };
    return Recording().open(folder_.path(), choose);
  };
  // Names that are too long for a string's internal buffer.
  write_lists(kMostImages, " the_longest_name_that_fits_in_the_file.png");
  expect_within_the_ceiling("lists", [&] { return says(open(), "no image of the sequence can be read"); });
  write_lists(kMostImages + 1, " a");
  expect_within_the_ceiling("too long lists", [&] { return says(open(), "lists more than 1048576 images"); });
  write_file(folder_ / "rgb.txt", "1 " + std::string(kMaxTextBytes - 10, '/') + "\n");
  expect_within_the_ceiling("a path of slashes",
                            [&] { return says(open(), "rgb.txt line 1: a name of more than 4096 bytes"); });
}

TEST_F(ReaderMemory, TablesStayWithinTheCeiling) {
  const fs::path path = folder_ / "table.txt";
  const auto trajectory = [&] {
    Trajectory read;
    return read_trajectory({path, {}, {}}, read);
  };
  write_file(path, rows(kMostRows, " 0 0 0 0 0 0 1"));
  expect_within_the_ceiling("a trajectory", [&] { return trajectory().ok(); });
  write_file(path, rows(kMostRows + 1, " 0 0 0 0 0 0 1"));
  expect_within_the_ceiling("a longer trajectory",
                            [&] { return says(trajectory(), "has more than 2097152 rows"); });
  std::string words(kMaxTextBytes, ' ');
  for (std::size_t i = 0; i < words.size(); i += 2) words[i] = '1';
  write_file(path, words);
  expect_within_the_ceiling("a row of words",
                            [&] { return says(trajectory(), "line 1: has more than 256 columns"); });
  write_file(folder_ / kGyroFile, rows(kMostRows, " 0 0 0"));
  write_file(folder_ / kAccelerometerFile, rows(kMostRows, " 0 0 0"));
  expect_within_the_ceiling("readings", [&] {
    ImuRecording recording;
    return read_imu_files(folder_.path(), recording).ok() && recording.gyro.size() == kMostRows;
  });
  write_file(folder_ / kGyroFile, rows(kMostRows + 1, " 0 0 0"));
  expect_within_the_ceiling("more readings", [&] {
    ImuRecording recording;
    return says(read_imu_files(folder_.path(), recording), "has more than 2097152 rows");
  });
}

TEST_F(ReaderMemory, CovariancesOfTheShortestNumbersStayWithinTheCeiling) {
  constexpr std::size_t kMost = kMostRows / 4;
  const auto zeros = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += " 0";
    return text;
  };
  std::vector<eval::StampedCovariance> covariances;
  write_file(folder_ / "c.txt", rows(kMost, zeros(21)));
  expect_within_the_ceiling("covariances", [&] {
    return eval::read_covariances(folder_ / "c.txt", covariances).ok() && covariances.size() == kMost;
  });
  write_file(folder_ / "c.txt", rows(kMost + 1, zeros(21)));
  expect_within_the_ceiling("more covariances", [&] {
    return says(eval::read_covariances(folder_ / "c.txt", covariances), "has more than 524288 rows");
  });
  write_file(folder_ / "m.txt", rows(kMost, " 1" + zeros(6) + " 1" + zeros(21)));
  expect_within_the_ceiling("motions", [&] {
    std::vector<eval::UncertainMotion> motions;
    return eval::read_motions(folder_ / "m.txt", motions).ok() && !motions.empty();
  });
}

TEST_F(ReaderMemory, CalibrationsOfTheShortestEntriesStayWithinTheCeiling) {
  const auto fill = [](const std::string& start, const std::string& entry) {
    std::string text = start;
    while (text.size() + entry.size() < kMaxCalibrationBytes) text += entry;
    return text;
  };
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"brackets", fill("a: ", "[")},
                                   {"a list", fill("K: [0", ",0") + "]"},
                                   {"keys", fill("{", "a,") + "}"},
                                   {"aliases", fill("a: &a [0]\nb: [*a", ",*a") + "]"}}) {
    write_file(folder_ / "c.yaml", text);
    expect_within_the_ceiling(name, [&] {
      Calibration calibration;
      return read_calibration(folder_ / "c.yaml", calibration).code() == StatusCode::kDamaged;
    });
  }
}

// The decoder keeps the coefficients of the whole image until the last scan.
TEST_F(ReaderMemory, LargestProgressiveJpegStaysWithinTheCeiling) {
  constexpr int kSide = kMaxImageSide;
  {
    const std::vector<unsigned char> pixels(std::size_t{3} * kSide * kSide, 99);
    const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    ASSERT_EQ(tjCompress2(encoder.get(), pixels.data(), kSide, 0, kSide, TJPF_RGB, &bytes, &size, TJSAMP_444,
                          90, TJFLAG_PROGRESSIVE),
              0);
    write_file(folder_ / "a.jpg", {reinterpret_cast<const char*>(bytes), size});
    tjFree(bytes);
  }
  expect_within_the_ceiling("an image", [&] {
    ImageDecoder decoder;
    std::vector<std::uint8_t> rgb(std::size_t{3} * kSide * kSide);
    return decoder.decode_rgb(folder_ / "a.jpg", kSide, kSide, rgb).ok();
  });
}

}  // namespace
}  // namespace plvo

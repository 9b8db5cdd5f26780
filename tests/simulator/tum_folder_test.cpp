// SPDX-License-Identifier: Apache-2.0
// The folder that the simulator writes: its pictures hold the camera's bytes, its lists name files that
// exist, and a disk that runs full leaves a folder that is valid up to there.
#include <spng.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "plvo/simulator/tum_folder.hpp"
#include "simulator_support.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Pixels of a PNG in the machine's byte order; empty when it is damaged.
std::vector<std::uint8_t> decode(const fs::path& path, int format) {
  const std::vector<std::uint8_t> png = read_bytes(path);
  spng_ctx* context = spng_ctx_new(0);
  std::size_t size = 0;
  std::vector<std::uint8_t> pixels;
  if (spng_set_png_buffer(context, png.data(), png.size()) == 0 &&
      spng_decoded_image_size(context, format, &size) == 0) {
    pixels.resize(size);
    if (spng_decode_image(context, pixels.data(), size, format, 0) != 0) pixels.clear();
  }
  spng_ctx_free(context);
  return pixels;
}

std::vector<std::string> lines(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> result;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line[0] != '#') result.push_back(line);
  }
  return result;
}

class TumFolder : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/plvo_folder_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    root_ = name;
    options_ = test::small_options(SceneName::kDesk);
    options_.frames = 3;
    ASSERT_TRUE(SimulatedCamera::create(options_, camera_).ok());
  }
  void TearDown() override { fs::remove_all(root_); }

  fs::path root_;
  SimulatorOptions options_;
  std::unique_ptr<SimulatedCamera> camera_;
};

TEST_F(TumFolder, HoldsWhatTheCameraSaw) {
  int last = 0;
  const Status status = write_tum_folder(*camera_, (root_ / "a/b").string(), [&](int written, int total) {
    EXPECT_EQ(written, last + 1);
    EXPECT_EQ(total, 3);
    last = written;
    return true;
  });
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(last, 3);
  const fs::path folder = root_ / "a/b";
  const std::vector<test::Shot> shots = test::shoot(options_);
  const std::vector<std::string> rgb = lines(folder / "rgb.txt");
  const std::vector<std::string> depth = lines(folder / "depth.txt");
  const std::vector<std::string> truth = lines(folder / "groundtruth.txt");
  ASSERT_EQ(rgb.size(), 3U);
  ASSERT_EQ(depth.size(), 3U);
  ASSERT_EQ(truth.size(), 3U);
  EXPECT_EQ(lines(folder / "calibration.txt").at(0), "131.25 131.25 79.5 59.5 5000 0 0 0 0 0 0");
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string rgb_name = rgb[k].substr(rgb[k].find(' ') + 1);
    const std::string depth_name = depth[k].substr(depth[k].find(' ') + 1);
    EXPECT_EQ(decode(folder / rgb_name, SPNG_FMT_RGB8), shots[k].colour);
    const std::vector<std::uint8_t> raw = decode(folder / depth_name, SPNG_FMT_RAW);
    ASSERT_EQ(raw.size(), 2 * shots[k].depth.size());
    for (std::size_t i = 0; i < shots[k].depth.size(); ++i)
      ASSERT_EQ(raw[2 * i] * 256 + raw[2 * i + 1], shots[k].depth[i]);  // a PNG is big-endian
    double v[8] = {};
    std::istringstream text(truth[k]);
    for (double& x : v) text >> x;
    EXPECT_EQ(static_cast<std::int64_t>(v[0] * 1e6 + 0.5), shots[k].stamp_ns / 1000);
    EXPECT_LT((Vector3(v[1], v[2], v[3]) - shots[k].T_world_camera.t).norm(), 2e-9);
    EXPECT_LT((to_rotation({v[4], v[5], v[6], v[7]}) - shots[k].T_world_camera.R).norm(), 1e-8);
  }
}

TEST_F(TumFolder, DepthHasItsOwnStamps) {
  options_.depth_schedule.stamp_offset_s = -0.007;
  ASSERT_TRUE(SimulatedCamera::create(options_, camera_).ok());
  ASSERT_TRUE(write_tum_folder(*camera_, (root_ / "x").string()).ok());
  const std::vector<std::string> rgb = lines(root_ / "x/rgb.txt");
  const std::vector<std::string> depth = lines(root_ / "x/depth.txt");
  ASSERT_EQ(depth.size(), rgb.size());
  for (std::size_t k = 0; k < rgb.size(); ++k) {
    EXPECT_NEAR(std::stod(depth[k]) - std::stod(rgb[k]), -0.007, 1e-6);
    const std::size_t space = depth[k].find(' ');
    EXPECT_EQ(depth[k].substr(space + 1), "depth/" + depth[k].substr(0, space) + ".png");
    EXPECT_TRUE(fs::exists(root_ / "x" / depth[k].substr(space + 1)));
  }
}

TEST_F(TumFolder, StopsWhenAsked) {
  const Status status = write_tum_folder(*camera_, (root_ / "x").string(), [](int, int) { return false; });
  EXPECT_TRUE(status.ok());
  EXPECT_EQ(lines(root_ / "x/rgb.txt").size(), 1U);
}

TEST_F(TumFolder, DoesNotOverwriteARecording) {
  fs::create_directories(root_ / "x");
  std::ofstream(root_ / "x/rgb.txt") << "mine\n";
  const Status status = write_tum_folder(*camera_, (root_ / "x").string());
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(lines(root_ / "x/rgb.txt").at(0), "mine");
}

TEST_F(TumFolder, ReportsWriteErrors) {
  std::ofstream(root_ / "file") << "not a folder";
  const Status status = write_tum_folder(*camera_, (root_ / "file/inside").string());
  EXPECT_EQ(status.code(), StatusCode::kIo);
  EXPECT_NE(std::strstr(status.message(), "cannot make the folder"), nullptr) << status.message();
  EXPECT_EQ(write_tum_folder(*camera_, "/proc/plvo").code() == StatusCode::kOk, false);
}

TEST_F(TumFolder, WhatWasWrittenBeforeTheDiskWasFullStaysValid) {
  // A limit on the size of a file stands for the full disk: colour pictures exceed it, lists and depths do
  // not.
  const std::size_t limit = 6000;
  ASSERT_TRUE(write_tum_folder(*camera_, (root_ / "whole").string()).ok());
  ASSERT_TRUE(SimulatedCamera::create(options_, camera_).ok());
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  // The first frame fits, the second does not.
  const Status status = write_tum_folder(*camera_, (root_ / "cut").string(), [&](int, int) {
    const rlimit small{limit, before.rlim_max};
    return setrlimit(RLIMIT_FSIZE, &small) == 0;
  });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(status.code(), StatusCode::kIo);
  const std::vector<std::string> rgb = lines(root_ / "cut/rgb.txt");
  ASSERT_EQ(rgb.size(), 1U);
  EXPECT_EQ(rgb[0], lines(root_ / "whole/rgb.txt").at(0));
  EXPECT_EQ(lines(root_ / "cut/depth.txt").size(), 1U);
  int pictures = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root_ / "cut")) {
    if (entry.path().extension() != ".png") continue;
    EXPECT_FALSE(decode(entry.path(), SPNG_FMT_RAW).empty()) << entry.path();
    ++pictures;
  }
  EXPECT_EQ(pictures, 2);
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Recorded folders for C: the frames of RecordedCamera, and the program of docs/user/c.md, which tracks them
// as C++ does.
#include "plvo/c/sequence.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "command.hpp"
#include "plvo/host/files/trajectory_file.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "procedural_sequence.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

plvo_camera empty_camera() {
  plvo_camera camera;
  plvo_camera_init(&camera, sizeof camera);
  return camera;
}

TEST(CSequence, GivesTheFramesOfTheFolder) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder.path(), 3).ok());
  plvo_sequence* sequence = nullptr;
  plvo_status status = plvo_sequence_open(folder.path().c_str(), nullptr, &sequence);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  EXPECT_EQ(plvo_sequence_frame_count(sequence), 3U);
  plvo_camera camera = empty_camera();
  ASSERT_EQ(plvo_sequence_camera(sequence, &camera).code, PLVO_OK);
  EXPECT_EQ(camera.width, test::kTinyWidth);
  EXPECT_EQ(camera.fx, 80);

  plvo_frame frame = {};
  frame.struct_size = sizeof frame;
  for (int i = 0; i < 3; ++i) {
    status = plvo_sequence_next(sequence, &frame);
    ASSERT_EQ(status.code, PLVO_OK) << status.message;
    const test::TinyFrame truth(i);
    EXPECT_EQ(frame.stamp_ns, test::tiny_stamp(i));
    EXPECT_EQ(frame.depth_stamp_ns, truth.frame.depth_stamp_ns);
    EXPECT_EQ(frame.colour_format, PLVO_PIXELS_RGB8);
    EXPECT_EQ(std::memcmp(frame.colour, truth.rgb.data(), truth.rgb.size()), 0);
    EXPECT_EQ(std::memcmp(frame.depth, truth.depth.data(), 2 * truth.depth.size()), 0);
    EXPECT_EQ(frame.metres_per_unit, 1.0 / 5000);
  }
  EXPECT_EQ(plvo_sequence_next(sequence, &frame).code, PLVO_END_OF_STREAM);
  plvo_sequence_close(sequence);
}

TEST(CSequence, GivesNumberedFrames) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_png(folder / "frame-000003.color.png", test::TinyFrame(3).frame.colour).ok());
  ASSERT_TRUE(write_png(folder / "frame-000003.depth.png", test::TinyFrame(3).frame.depth).ok());
  test::write_file(folder / "calibration.txt", "80 80 47.5 31.5");
  plvo_sequence* sequence = nullptr;
  const plvo_status status = plvo_sequence_open(folder.path().c_str(), nullptr, &sequence);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  plvo_frame frame = {};
  frame.struct_size = sizeof frame;
  EXPECT_EQ(plvo_sequence_next(sequence, &frame).code, PLVO_OK);
  EXPECT_EQ(frame.stamp_ns, 100'000'000);
  EXPECT_EQ(frame.metres_per_unit, 1.0 / 1000);
  plvo_sequence_close(sequence);
}

TEST(CSequence, ScalesDownWhatIsTooLarge) {
  const test::TemporaryFolder folder;
  const test::TinyFrame large(0, 2400, 1000);
  CameraModel camera = test::tiny_camera();
  camera.width = 2400;
  camera.height = 1000;
  camera.pinhole = {2000, 2000, 1199.5, 499.5};
  TumWriter writer;
  ASSERT_TRUE(writer.open(folder.path(), camera, 5000).ok());
  ASSERT_TRUE(writer.write(large.frame).ok());
  plvo_sequence* sequence = nullptr;
  const plvo_status status = plvo_sequence_open(folder.path().c_str(), nullptr, &sequence);
  ASSERT_EQ(status.code, PLVO_OK) << status.message;
  plvo_camera small = empty_camera();
  ASSERT_EQ(plvo_sequence_camera(sequence, &small).code, PLVO_OK);
  EXPECT_EQ(small.width, 1200);
  EXPECT_EQ(small.cx, 599.5);
  plvo_frame frame = {};
  frame.struct_size = sizeof frame;
  EXPECT_EQ(plvo_sequence_next(sequence, &frame).code, PLVO_OK);
  EXPECT_EQ(frame.height, 500);
  EXPECT_EQ(frame.colour_stride_bytes, 3600);
  plvo_sequence_close(sequence);
}

TEST(CSequence, ADamagedImageCostsItsFrame) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder.path(), 3).ok());
  plvo_sequence* sequence = nullptr;
  ASSERT_EQ(plvo_sequence_open(folder.path().c_str(), nullptr, &sequence).code, PLVO_OK);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "depth"))
    test::write_file(entry.path(), "no picture");
  plvo_frame frame = {};
  frame.struct_size = sizeof frame;
  EXPECT_EQ(plvo_sequence_next(sequence, &frame).code, PLVO_DAMAGED);
  EXPECT_EQ(frame.colour, nullptr);
  plvo_sequence_close(sequence);
}

TEST(CSequence, FindsCalibrationsByNameAndInFiles) {
  plvo_camera camera = empty_camera();
  double metres_per_unit = 0;
  ASSERT_EQ(plvo_camera_builtin("tum-fr1", &camera, &metres_per_unit).code, PLVO_OK);
  EXPECT_NEAR(camera.fx, 517.3, 0.1);
  EXPECT_EQ(metres_per_unit, 1.0 / 5000);
  plvo_status status = plvo_camera_builtin("tum-fr9", &camera, nullptr);
  EXPECT_EQ(status.code, PLVO_NOT_FOUND);
  EXPECT_NE(std::strstr(status.message, "tum-fr1"), nullptr) << "lists the names: " << status.message;

  const test::TemporaryFolder folder;
  test::write_file(folder / "camera.txt", "300 301 160 120 1000\n");
  camera = empty_camera();
  camera.width = 320;
  camera.height = 240;
  ASSERT_EQ(plvo_camera_read((folder / "camera.txt").c_str(), &camera, &metres_per_unit).code, PLVO_OK);
  EXPECT_EQ(camera.fy, 301);
  EXPECT_EQ(camera.width, 320) << "the file names no size";
  EXPECT_EQ(metres_per_unit, 0.001);
  EXPECT_EQ(plvo_camera_read((folder / "none.txt").c_str(), &camera, nullptr).code, PLVO_NOT_FOUND);
}

// A lens that a program of an older version cannot be told must not reach it as another one.
TEST(CSequence, ALensThatTheCallersStructHasNoRoomForIsRefused) {
  const test::TemporaryFolder folder;
  test::write_file(folder / "camera.txt", "300 301 160 120 1000\ndistortion_model equidistant\nk1 0.1\n");
  plvo_camera camera = empty_camera();
  ASSERT_EQ(plvo_camera_read((folder / "camera.txt").c_str(), &camera, nullptr).code, PLVO_OK);
  EXPECT_EQ(camera.lens, PLVO_LENS_EQUIDISTANT);
  EXPECT_EQ(camera.distortion[0], 0.1);
  camera = empty_camera();
  const double before = camera.fx;
  camera.struct_size = 112;  // of version 0.1
  const plvo_status status = plvo_camera_read((folder / "camera.txt").c_str(), &camera, nullptr);
  EXPECT_EQ(status.code, PLVO_INVALID_ARGUMENT);
  EXPECT_NE(std::strstr(status.message, "compile the program for this plvo"), nullptr) << status.message;
  EXPECT_EQ(camera.fx, before);
  EXPECT_EQ(plvo_camera_builtin("tum-fr1", &camera, nullptr).code, PLVO_OK);
  EXPECT_NEAR(camera.fx, 517.3, 0.1);
}

TEST(CSequence, RefusesFoldersWithoutASequence) {
  const test::TemporaryFolder folder;
  plvo_sequence* sequence = nullptr;
  const plvo_status status = plvo_sequence_open((folder / "nowhere").c_str(), nullptr, &sequence);
  EXPECT_EQ(status.code, PLVO_NOT_FOUND);
  EXPECT_NE(status.message[0], '\0');
  EXPECT_EQ(sequence, nullptr);
  EXPECT_EQ(plvo_sequence_open(nullptr, nullptr, &sequence).code, PLVO_INVALID_ARGUMENT);
  EXPECT_EQ(plvo_sequence_next(nullptr, nullptr).code, PLVO_INVALID_ARGUMENT);
  EXPECT_EQ(plvo_camera_builtin("tum-fr1", nullptr, nullptr).code, PLVO_INVALID_ARGUMENT);
  plvo_sequence_close(nullptr);
}

// The poses of the C++ public API, to the nine decimals that the program prints.
TEST(CSequence, TheProgramOfThePageTracksAFolder) {
  constexpr int kFrames = 6;
  const test::TemporaryFolder folder;
  ProceduralSequence rendered(320, 240);
  TumWriter writer;
  ASSERT_TRUE(writer.open(folder / "sequence", rendered.camera(), 1000).ok());
  for (int i = 0; i < kFrames; ++i) ASSERT_TRUE(writer.write(rendered.render(i)).ok());

  Calibration calibration;
  ASSERT_TRUE(read_calibration(folder / "sequence" / "calibration.txt", calibration).ok());
  RecordedCamera camera;
  ASSERT_TRUE(camera.open(folder / "sequence", calibration).ok());
  Limits limits;
  limits.width = 320;
  limits.height = 240;
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, camera.model(), {}, limits).ok());
  std::vector<std::string> expected;
  for (RgbdFrame frame; camera.next(frame).ok();) {
    const TrackResult result = odometry.track(frame);
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    const std::string line = trajectory_line(result.stamp_ns, result.T_world_camera);
    expected.push_back(line.substr(line.find(' ')));
  }
  ASSERT_EQ(expected.size(), static_cast<std::size_t>(kFrames));

  const test::CommandResult run =
      test::run_command(std::string(PLVO_C_EXAMPLE) + ' ' + (folder / "sequence").string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::istringstream lines(run.out);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    ASSERT_LT(count, expected.size());
    EXPECT_EQ(line.substr(line.find(' ')), expected[count]);
  }
  EXPECT_EQ(count, expected.size());
  EXPECT_EQ(test::run_command(PLVO_C_EXAMPLE).exit_code, 2);
}

}  // namespace
}  // namespace plvo

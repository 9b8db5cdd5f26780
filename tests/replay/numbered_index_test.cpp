// SPDX-License-Identifier: Apache-2.0
// Folders of numbered frames give the same trajectory as a TUM folder with the same images and stamps. Every
// malformed folder is rejected with a message.
#include "plvo/replay/index/numbered_index.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <filesystem>
#include <vector>

#include "numbered_sequence.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "says.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::NumberedSequence;
using test::says;
using test::scannet_file;
using test::seven_scenes_file;
using test::TemporaryFolder;
using test::write_file;

Status open_alone(RecordedCamera& camera, const fs::path& folder) {
  Calibration calibration;
  std::string guess;
  if (Status status = sequence_calibration(folder, calibration, guess); !status.ok()) return status;
  return camera.open(folder, calibration);
}

struct Pose {
  std::int64_t stamp_ns;
  double numbers[12 + 36];
};

std::vector<Pose> track(const fs::path& folder) {
  RecordedCamera camera;
  const Status opened = open_alone(camera, folder);
  EXPECT_TRUE(opened.ok()) << opened.message();
  Limits limits = Limits::qvga();
  std::vector<std::byte> memory(required_bytes(limits));
  Odometry odometry;
  EXPECT_TRUE(odometry.init(memory, camera.model(), Config(), limits).ok());
  std::vector<Pose> poses;
  for (RgbdFrame frame; camera.next(frame).ok();) {
    const TrackResult result = odometry.track(frame);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    Pose pose{result.stamp_ns, {}};
    std::memcpy(pose.numbers, result.T_world_camera.R.data(), 9 * sizeof(double));
    std::memcpy(pose.numbers + 9, result.T_world_camera.t.data(), 3 * sizeof(double));
    std::memcpy(pose.numbers + 12, result.pose_covariance.data(), 36 * sizeof(double));
    poses.push_back(pose);
  }
  return poses;
}

TEST(NumberedFolder, EqualsTheTumFolderWithTheSameStamps) {
  const NumberedSequence sequence;
  ASSERT_TRUE(sequence.good());
  const std::vector<Pose> expected = track(sequence.tum());
  ASSERT_EQ(expected.size(), std::size_t{test::kNumberedFrames});
  EXPECT_EQ(expected[1].stamp_ns, 33'333'333);
  EXPECT_NE(expected[5].numbers[9], 0);
  for (const fs::path& folder : {sequence.seven_scenes(), sequence.scannet()}) {
    const std::vector<Pose> poses = track(folder);
    ASSERT_EQ(poses.size(), expected.size()) << folder;
    EXPECT_EQ(std::memcmp(poses.data(), expected.data(), poses.size() * sizeof(Pose)), 0) << folder;
  }
}

TEST(NumberedFolder, ReadsDepthInMillimetres) {
  const NumberedSequence sequence;
  RecordedCamera camera;
  ASSERT_TRUE(open_alone(camera, sequence.scannet()).ok());
  EXPECT_EQ(camera.calibration().depth_units_per_metre, 1000);
  EXPECT_EQ(camera.calibration().assumptions().size(), 1u);  // the readout time
  fs::rename(sequence.scannet() / "color", sequence.scannet() / "rgb");
  ASSERT_TRUE(open_alone(camera, sequence.scannet()).ok());
  EXPECT_EQ(camera.calibration().assumptions().size(), 2u) << "of nobody's layout the unit is a guess";
  EXPECT_EQ(camera.calibration().depth_units_per_metre, 1000);
  fs::rename(sequence.scannet() / "rgb", sequence.scannet() / "color");
  ASSERT_TRUE(open_alone(camera, sequence.scannet()).ok());
  RgbdFrame frame;
  ASSERT_TRUE(camera.next(frame).ok());
  EXPECT_EQ(frame.depth.metres_per_unit, 1.0 / 1000);
  Calibration calibration;
  ASSERT_TRUE(builtin_calibration("7scenes", calibration).ok());
  EXPECT_EQ(calibration.depth_camera.pinhole.fx, 585);
  EXPECT_EQ(calibration.depth_camera.pinhole.cy, 240);
  EXPECT_EQ(calibration.depth_units_per_metre, 1000);
  // A value in the calibration takes precedence.
  calibration.has_size = false;
  calibration.depth_camera = {};
  calibration.camera.pinhole = {290, 290, 160, 120};
  calibration.depth_units_per_metre = 5000;
  ASSERT_TRUE(camera.open(sequence.scannet(), calibration).ok());
  EXPECT_EQ(camera.calibration().depth_units_per_metre, 5000);
}

TEST(NumberedFolder, ReadsPosesAsGroundTruth) {
  const NumberedSequence sequence;
  write_file(sequence.scannet() / scannet_file("pose", 2),
             "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
  write_file(sequence.scannet() / scannet_file("pose", 3), "nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  SequenceOptions options;
  options.frames_per_s = 10;
  Trajectory truth;
  const Status status = read_ground_truth(sequence.scannet(), options, truth);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(truth.ignored_rows, 2u);
  ASSERT_EQ(truth.poses.size(), 4u);
  EXPECT_EQ(truth.poses[2].stamp_ns, 400'000'000);
  const Se3 expected = ProceduralRenderer::T_world_camera(4);
  EXPECT_EQ(truth.poses[2].T_world_camera.R, expected.R);
  EXPECT_EQ(truth.poses[2].T_world_camera.t, expected.t);
  // A trajectory beside the frames takes precedence.
  fs::copy(sequence.tum() / "groundtruth.txt", sequence.scannet() / "groundtruth.txt");
  ASSERT_TRUE(read_ground_truth(sequence.scannet(), options, truth).ok());
  EXPECT_EQ(truth.poses.size(), 6u);
  fs::remove_all(sequence.scannet() / "pose");
  fs::remove(sequence.scannet() / "groundtruth.txt");
  EXPECT_EQ(read_ground_truth(sequence.scannet(), options, truth).code(), StatusCode::kNotFound);
}

TEST(NumberedFolder, ReportsDamagedPoses) {
  const NumberedSequence sequence;
  const fs::path file = sequence.seven_scenes() / seven_scenes_file("pose", 4);
  Trajectory truth;
  const auto refused = [&](std::string_view content, std::string_view words) {
    fs::remove(file);
    write_file(file, content);
    const Status status = read_ground_truth(sequence.seven_scenes(), {}, truth);
    EXPECT_EQ(status.code(), StatusCode::kDamaged) << content;
    EXPECT_TRUE(says(status, words)) << status.message();
    EXPECT_TRUE(says(status, "frame-000004.pose.txt")) << status.message();
  };
  refused("", "expected four rows of four numbers");
  refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n", "expected four rows of four numbers");
  refused("1 0 0\n0 1 0\n0 0 1\n0 0 0\n", "expected four rows of four numbers");
  refused("1 0 0 0\n0 1 0 x\n0 0 1 0\n0 0 0 1\n", "line 2: 'x' is not a number");
  refused("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "not a rotation");
  refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n4 5 6 1\n", "line 4: the last row of a pose must be 0 0 0 1");
  fs::remove(file);
  ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
  EXPECT_TRUE(says(read_ground_truth(sequence.seven_scenes(), {}, truth), "it is a pipe"));
  fs::remove(file);
  write_file(file, "");
  fs::resize_file(file, std::uintmax_t{1} << 40);
  EXPECT_TRUE(says(read_ground_truth(sequence.seven_scenes(), {}, truth), "1099511627776 bytes"));
}

// File names only, for decisions that precede the reading of images.
class NumberedNames : public ::testing::Test {
 protected:
  void touch(const std::string& name) {
    fs::create_directories((folder_ / name).parent_path());
    write_file(folder_ / name, "");
  }
  Status read() { return read_sequence_index(folder_.path(), {}, index_); }

  TemporaryFolder folder_;
  SequenceIndex index_;
};

TEST_F(NumberedNames, AreOrderedByNumberAndPaired) {
  for (const char* name : {"color/10.jpg", "color/9.JPG", "color/100.png", "depth/9.png", "depth/10.png",
                           "depth/11.png", "pose/9.txt", "color/.hidden.jpg", "color/Thumbs.db", "notes.txt"})
    touch(name);
  const Status status = read();
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(index_.pairs.size(), 2u);
  EXPECT_EQ(index_.pairs[0].colour.file, "color/9.JPG");
  EXPECT_EQ(index_.pairs[0].colour.stamp_ns, 300'000'000);
  EXPECT_EQ(index_.pairs[1].depth.file, "depth/10.png");
  EXPECT_EQ(index_.pairs[1].depth.stamp_ns, 333'333'333);
  EXPECT_EQ(index_.unpaired_colour, 1u);
  EXPECT_EQ(index_.unpaired_depth, 1u);
  EXPECT_EQ(index_.poses.size(), 1u);
}

TEST_F(NumberedNames, ReportUnevenGaps) {
  for (int number : {0, 20, 40, 60}) {
    touch(seven_scenes_file("color", number));
    touch(seven_scenes_file("depth", number));
  }
  ASSERT_TRUE(read().ok());
  EXPECT_EQ(index_.remark, "");
  fs::remove(folder_ / seven_scenes_file("depth", 20));
  touch(seven_scenes_file("color", 80));
  touch(seven_scenes_file("depth", 80));
  ASSERT_TRUE(read().ok());
  EXPECT_NE(index_.remark.find("numbers without a pair of images between the frames 0 and 80: 1, the first "
                               "is 20"),
            std::string::npos)
      << index_.remark;
}

TEST_F(NumberedNames, RejectImagesWithoutANumber) {
  for (const char* name : {"frame-000000.color.png", "frame-000000.depth.png"}) touch(name);
  for (const char* name :
       {"frame-00000x.color.png", "frame--1.depth.png", "frame-.pose.txt", "frame-123456789.color.jpg"}) {
    touch(name);
    const Status status = read();
    EXPECT_EQ(status.code(), StatusCode::kDamaged) << name;
    EXPECT_TRUE(says(status, std::string(name) + ": expected a number of at most 8 digits")) << name;
    fs::remove(folder_ / name);
  }
  EXPECT_TRUE(read().ok());
}

TEST_F(NumberedNames, RejectRepeatedNumbers) {
  for (const char* name : {"color/7.jpg", "color/007.png", "depth/7.png"}) touch(name);
  const Status status = read();
  EXPECT_EQ(status.code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(status, "color/007.png and color/7.jpg have the same number")) << status.message();
}

TEST_F(NumberedNames, RejectFoldersWithoutPairs) {
  for (const char* name : {"color/1.jpg", "depth/2.png"}) touch(name);
  EXPECT_TRUE(says(read(), "no colour image has a depth image of the same number"));
  fs::remove_all(folder_ / "depth");
  EXPECT_TRUE(says(read(), "rgb.txt; a sequence needs rgb.txt")) << "half a layout is none";
}

// Common names for colour and depth.
TEST_F(NumberedNames, AcceptCommonNames) {
  const std::pair<const char*, const char*> kinds[] = {{"rgb/%.png", "depth/%.png"},
                                                       {"rgb_png/%.png", "depth_png/%.png"},
                                                       {"image/%.jpg", "depth/%.png"},
                                                       {"images/%.ppm", "depth/%.pgm"},
                                                       {"color/color_%.jpg", "depth/depth_%.png"},
                                                       {"rgb/frame%_rgb.png", "depth/frame%_depth.png"},
                                                       {"color_%.png", "depth_%.png"},
                                                       {"rgb%.png", "depth%.png"},
                                                       {"RGB_%.png", "Depth_%.png"},
                                                       {"RGB/%.png", "Depth/%.png"},
                                                       {"%-color.png", "%-depth.png"},
                                                       {"%.jpg", "%.png"},
                                                       {"frame%.jpeg", "frame%.pgm"}};
  const auto name = [](std::string form, int number) {
    return form.replace(form.find('%'), 1, fmt::format("{:04}", number));
  };
  for (const auto& [colour, depth] : kinds) {
    for (int number : {1, 2, 12}) touch(name(colour, number));
    for (int number : {2, 12, 13}) touch(name(depth, number));
    const Status status = read();
    ASSERT_TRUE(status.ok()) << colour << ": " << status.message();
    EXPECT_TRUE(index_.numbered && !index_.in_millimetres) << "the unit is a guess";
    ASSERT_EQ(index_.pairs.size(), 2u) << colour;
    EXPECT_EQ(index_.pairs[1].colour.file, name(colour, 12));
    EXPECT_EQ(index_.pairs[1].depth.file, name(depth, 12));
    EXPECT_EQ(index_.pairs[1].depth.stamp_ns, 400'000'000);
    for (const auto& entry : fs::directory_iterator(folder_.path())) fs::remove_all(entry.path());
  }
  for (const char* file : {"color/1.png", "depth/1.png"}) touch(file);
  ASSERT_TRUE(read().ok());
  EXPECT_TRUE(index_.in_millimetres) << "ScanNet says so";
}

TEST_F(NumberedNames, RejectAmbiguousNames) {
  for (const char* name : {"rgb_left/1.png", "rgb_right/1.png", "depth/1.png"}) touch(name);
  EXPECT_TRUE(says(read(), "rgb_left and rgb_right may both be meant; name the right one color"));
  touch("rgb/1.png");
  EXPECT_TRUE(read().ok()) << "one has the word alone";
  EXPECT_EQ(index_.pairs[0].colour.file, "rgb/1.png");
  // Folders without numbered images do not count; stamps are not frame numbers.
  fs::remove_all(folder_ / "rgb");
  fs::remove_all(folder_ / "rgb_right");
  touch("rgb_notes/a.png");
  EXPECT_TRUE(read().ok());
  fs::remove_all(folder_ / "rgb_left");
  touch("rgb/1305031102.175304.png");
  EXPECT_TRUE(says(read(), "or numbered images, as rgb/0.png and depth/0.png, or rgb_0.png and depth_0.png"));
}

// Lists, and files that the user names, take precedence over file names.
TEST_F(NumberedNames, YieldToLists) {
  for (const char* name : {"color/1.png", "depth/1.png"}) touch(name);
  EXPECT_TRUE(is_numbered_folder(folder_.path()));
  SequenceOptions options;
  options.associations = folder_ / "pairs.txt";
  write_file(options.associations, "5.0 color/1.png 5.0 depth/1.png\n");
  ASSERT_TRUE(read_sequence_index(folder_.path(), options, index_).ok());
  EXPECT_EQ(index_.pairs[0].colour.stamp_ns, 5'000'000'000);
  fs::rename(folder_ / "pairs.txt", folder_ / "associations.txt");
  EXPECT_FALSE(is_numbered_folder(folder_.path()));
}

TEST(NumberedFolder, LosesOnlyTheFrameOfADamagedImage) {
  const NumberedSequence sequence;
  const fs::path victim = sequence.scannet() / scannet_file("depth", 2);
  fs::resize_file(victim, fs::file_size(victim) / 2);
  fs::remove(sequence.scannet() / scannet_file("color", 3));
  ASSERT_EQ(::mkfifo((sequence.scannet() / scannet_file("color", 3)).c_str(), 0600), 0);
  RecordedCamera camera;
  ASSERT_TRUE(open_alone(camera, sequence.scannet()).ok());
  RgbdFrame frame;
  EXPECT_TRUE(camera.next(frame).ok());
  EXPECT_TRUE(camera.next(frame).ok());
  EXPECT_TRUE(says(camera.next(frame), "depth/2.png: damaged or cut off"));
  EXPECT_TRUE(says(camera.next(frame), "color/3.png: it is a pipe"));
  EXPECT_TRUE(camera.next(frame).ok());
  EXPECT_EQ(frame.stamp_ns, 133'333'333);
}

TEST(NumberedFolder, RejectsColourAndDepthOfDifferentSizes) {
  const NumberedSequence sequence;
  const std::vector<std::uint8_t> large(3 * 640 * 480, 80);
  for (int i = 0; i < test::kNumberedFrames; ++i)
    ASSERT_TRUE(write_png(sequence.scannet() / scannet_file("color", i),
                          ColourView{large.data(), 640, 480, 3 * 640, PixelFormat::kRgb8})
                    .ok());
  RecordedCamera camera;
  const Status status = open_alone(camera, sequence.scannet());
  EXPECT_TRUE(says(status, "colour is 640x480 but depth is 320x240")) << status.message();
  EXPECT_TRUE(says(status, "export colour at the size of depth")) << status.message();
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/recorded_camera.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "plvo/replay/images/image_writer.hpp"
#include "plvo/replay/paced_camera.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

using test::says;

namespace fs = std::filesystem;
using test::TemporaryFolder;
using test::tiny_stamp;
using test::TinyFrame;
using test::write_tiny_sequence;

Status open(RecordedCamera& camera, const fs::path& folder, const SequenceOptions& options = {}) {
  Calibration calibration;
  if (Status status = read_calibration(folder / "calibration.txt", calibration); !status.ok()) return status;
  return camera.open(folder, calibration, options);
}

TEST(RecordedCamera, RoundTripsFrames) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 3).ok());
  RecordedCamera camera;
  const Status status = open(camera, folder.path());
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(camera.frame_count(), 3u);
  EXPECT_EQ(camera.model().width, 96);
  EXPECT_EQ(camera.model().pinhole.cx, 47.5);
  for (int i = 0; i < 3; ++i) {
    const TinyFrame expected(i);
    RgbdFrame frame;
    ASSERT_TRUE(camera.next(frame).ok());
    EXPECT_EQ(frame.stamp_ns, tiny_stamp(i));
    EXPECT_EQ(frame.depth_stamp_ns, tiny_stamp(i) + 5'000'000);
    EXPECT_EQ(frame.depth.metres_per_unit, 1.0 / 5000);
    EXPECT_TRUE(std::equal(expected.rgb.begin(), expected.rgb.end(), frame.colour.data));
    EXPECT_TRUE(std::equal(expected.depth.begin(), expected.depth.end(), frame.depth.data));
  }
  RgbdFrame frame;
  EXPECT_EQ(camera.next(frame).code(), StatusCode::kEndOfStream);
}

TEST(RecordedCamera, DeliversOnlyTheFramesOfARange) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 5).ok());
  SequenceOptions options;
  options.first_frame = 2;
  options.end_frame = 4;
  RecordedCamera camera;
  ASSERT_TRUE(open(camera, folder.path(), options).ok());
  EXPECT_EQ(camera.frame_count(), 2u);
  RgbdFrame frame;
  ASSERT_TRUE(camera.next(frame).ok());
  EXPECT_EQ(frame.stamp_ns, tiny_stamp(2));
  options.first_frame = 5;
  options.end_frame = 9;
  EXPECT_TRUE(says(open(camera, folder.path(), options), "the frame range is empty"));
}

TEST(RecordedCamera, DamagedFrameIsSkippedNotFatal) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 3).ok());
  const fs::path victim = folder.path() / "depth" / "100.038333.png";
  ASSERT_TRUE(fs::exists(victim));
  fs::resize_file(victim, fs::file_size(victim) / 2);
  RecordedCamera camera;
  ASSERT_TRUE(open(camera, folder.path()).ok());
  RgbdFrame frame;
  EXPECT_TRUE(camera.next(frame).ok());
  const Status status = camera.next(frame);
  EXPECT_EQ(status.code(), StatusCode::kDamaged);
  EXPECT_TRUE(says(status, "depth/100.038333.png: damaged or cut off")) << status.message();
  ASSERT_TRUE(camera.next(frame).ok());
  EXPECT_EQ(frame.stamp_ns, tiny_stamp(2));
}

TEST(RecordedCamera, RejectsUnreadableSequenceAtOpen) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 2).ok());
  fs::remove_all(folder / "rgb");
  RecordedCamera camera;
  EXPECT_TRUE(says(open(camera, folder.path()), "no image of the sequence can be read; rgb/100.000000.png"));
}

TEST(RecordedCamera, RejectsEightBitDepthAtOpen) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 2).ok());
  const std::vector<std::uint8_t> grey(96 * 64, 80);
  ASSERT_TRUE(write_png(folder.path() / "depth" / "100.005000.png",
                        ColourView{grey.data(), 96, 64, 96, PixelFormat::kGray8})
                  .ok());
  RecordedCamera camera;
  EXPECT_TRUE(says(open(camera, folder.path()), "has 8 bits per channel; depth must be a 16-bit grey PNG"));
}

TEST(RecordedCamera, RejectsDifferentSizesAtOpen) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 2).ok());
  ASSERT_TRUE(write_png(folder.path() / "depth" / "100.005000.png", TinyFrame(0, 48, 32).frame.depth).ok());
  RecordedCamera camera;
  EXPECT_TRUE(says(open(camera, folder.path()), "colour is 96x64 but depth is 48x32"));
}

TEST(RecordedCamera, EnlargesSmallerDepthOfTheSameView) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 1).ok());
  const TinyFrame small(0, 48, 32);
  ASSERT_TRUE(write_png(folder.path() / "depth" / "100.005000.png", small.frame.depth).ok());
  Calibration calibration;
  calibration.camera = {96, 64, {80, 80, 47.5, 31.5}, {}};
  calibration.has_size = true;  // the size is colour's; depth has half its width and height
  RecordedCamera camera;
  const Status status = camera.open(folder.path(), calibration);
  ASSERT_TRUE(status.ok()) << status.message();
  RgbdFrame frame;
  ASSERT_TRUE(camera.next(frame).ok());
  EXPECT_EQ(frame.depth.width, 96);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x)
      ASSERT_EQ(frame.depth.data[y * frame.depth.stride + x],
                small.depth[static_cast<std::size_t>(y / 2 * 48 + x / 2)])
          << x << ' ' << y;
}

// Each pixel of a tiny sequence becomes a block. Scaling down by the same factor restores the sequence and
// its camera.
void write_magnified(const fs::path& folder, int factor) {
  const TinyFrame small(0);
  TinyFrame large(0, factor * test::kTinyWidth, factor * test::kTinyHeight);
  for (int y = 0; y < factor * test::kTinyHeight; ++y)
    for (int x = 0; x < factor * test::kTinyWidth; ++x) {
      const auto to = static_cast<std::size_t>(y * factor * test::kTinyWidth + x);
      const auto from = static_cast<std::size_t>(y / factor * test::kTinyWidth + x / factor);
      large.depth[to] = small.depth[from];
      for (std::size_t c = 0; c < 3; ++c) large.rgb[3 * to + c] = small.rgb[3 * from + c];
    }
  CameraModel camera = test::tiny_camera();
  camera.width *= factor;
  camera.height *= factor;
  camera.pinhole = {80.0 * factor, 80.0 * factor, 48.0 * factor - 0.5, 32.0 * factor - 0.5};
  TumWriter writer;
  ASSERT_TRUE(writer.open(folder, camera, 5000).ok());
  ASSERT_TRUE(writer.write(large.frame).ok());
}

TEST(RecordedCamera, ScalesDownWhatOneAsksFor) {
  const TemporaryFolder folder;
  write_magnified(folder.path(), 3);
  SequenceOptions options;
  options.scale_down = 3;
  RecordedCamera camera;
  const Status status = open(camera, folder.path(), options);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(camera.remark(), "") << "nothing that nobody asked for";
  EXPECT_EQ(camera.model().width, 96);
  EXPECT_EQ(camera.model().pinhole.cx, 47.5);
  EXPECT_EQ(camera.model().pinhole.fy, 80);
  EXPECT_EQ(camera.whole_image().width, 288);
  const TinyFrame expected(0);
  RgbdFrame frame;
  ASSERT_TRUE(camera.next(frame).ok());
  EXPECT_EQ(frame.colour.width, 96);
  EXPECT_EQ(frame.depth.height, 64);
  EXPECT_TRUE(std::equal(expected.rgb.begin(), expected.rgb.end(), frame.colour.data));
  EXPECT_TRUE(std::equal(expected.depth.begin(), expected.depth.end(), frame.depth.data));
  options.scale_down = 5;
  EXPECT_TRUE(says(open(camera, folder.path(), options), "scaled down by 5 are 57x38, and plvo takes 64x64"));
}

TEST(RecordedCamera, ScalesDownWhatIsTooLarge) {
  const TemporaryFolder folder;
  write_magnified(folder.path(), 22);
  RecordedCamera camera;
  const Status status = open(camera, folder.path());
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(camera.model().width, 1056);
  EXPECT_EQ(camera.model().height, 704);
  EXPECT_EQ(camera.calibration().camera.pinhole.fx, 880);
  EXPECT_EQ(camera.remark(),
            "the images of 2112x1408 are larger than plvo takes: they are scaled down by 2, to 1056x704, and "
            "the calibration with them");
  const TinyFrame expected(0);
  RgbdFrame frame;
  ASSERT_TRUE(camera.next(frame).ok());
  for (int y = 0; y < 704; y += 10)
    for (int x = 0; x < 1056; x += 10)
      ASSERT_EQ(frame.depth.data[y * frame.depth.stride + x],
                expected.depth[static_cast<std::size_t>(y / 11 * 96 + x / 11)]);
}

// Depth keeps its size and camera; the colour camera is scaled down.
TEST(RecordedCamera, ScalesOnlyColourWhenDepthHasItsOwnCamera) {
  const TemporaryFolder folder;
  write_magnified(folder.path(), 3);
  const TinyFrame expected(0);
  ASSERT_TRUE(write_png(folder.path() / "depth" / "100.005000.png", expected.frame.depth).ok());
  Calibration calibration;
  ASSERT_TRUE(read_calibration(folder / "calibration.txt", calibration).ok());
  calibration.depth_camera = {.known = true, .pinhole = {80, 80, 47.5, 31.5}};
  SequenceOptions options;
  options.scale_down = 3;
  RecordedCamera camera;
  const Status status = camera.open(folder.path(), calibration, options);
  ASSERT_TRUE(status.ok()) << status.message();
  RgbdFrame frame;
  ASSERT_TRUE(camera.next(frame).ok());
  EXPECT_TRUE(std::equal(expected.depth.begin(), expected.depth.end(), frame.depth.data));
}

// In 7-Scenes, and in folders of any layout from other programs.
TEST(RecordedCamera, TreatsTheLargestValueAsNoDepth) {
  for (const bool own_camera : {false, true}) {
    const TemporaryFolder folder;
    TinyFrame tiny(0);
    tiny.depth[5] = 65535;
    tiny.depth[6] = 65534;
    TumWriter writer;
    ASSERT_TRUE(writer.open(folder.path(), test::tiny_camera(), 5000).ok());
    ASSERT_TRUE(writer.write(tiny.frame).ok());
    Calibration calibration;
    ASSERT_TRUE(read_calibration(folder / "calibration.txt", calibration).ok());
    if (own_camera) calibration.depth_camera = {.known = true, .pinhole = calibration.camera.pinhole};
    RecordedCamera camera;
    ASSERT_TRUE(camera.open(folder.path(), calibration).ok());
    RgbdFrame frame;
    ASSERT_TRUE(camera.next(frame).ok());
    EXPECT_EQ(frame.depth.data[5], 0);
    EXPECT_EQ(frame.depth.data[6], 65534);
    EXPECT_EQ(frame.depth.data[4], tiny.depth[4]);
  }
}

// Only the offset of the depth camera is given; its pinhole is colour's.
TEST(RecordedCamera, AppliesADepthOffsetWithoutPinhole) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 1).ok());
  const std::string numbers = test::read_file(folder / "calibration.txt");
  const auto depth_of = [&](const std::string& keys) {
    test::write_file(folder / "calibration.txt", numbers + keys);
    RecordedCamera camera;
    const Status status = open(camera, folder.path());
    EXPECT_TRUE(status.ok()) << status.message();
    RgbdFrame frame;
    EXPECT_TRUE(camera.next(frame).ok());
    return std::vector<std::uint16_t>(frame.depth.data, frame.depth.data + 96 * 64);
  };
  const std::vector<std::uint16_t> moved = depth_of("\ndepth_tx -0.025\n");
  EXPECT_NE(moved, depth_of(""));
  EXPECT_EQ(moved, depth_of("\ndepth_tx -0.025\ndepth_fx 80\ndepth_fy 80\ndepth_cx 47.5\ndepth_cy 31.5\n"));
  // Images of another size have another pinhole.
  const std::vector<std::uint16_t> half(48 * 32, 5000);
  for (const auto& entry : fs::directory_iterator(folder / "depth"))
    ASSERT_TRUE(write_png(entry.path(), DepthView{half.data(), 48, 32, 48, 0.0002}).ok());
  test::write_file(folder / "calibration.txt", numbers + "\ndepth_tx -0.025\n");
  RecordedCamera camera;
  EXPECT_TRUE(says(open(camera, folder.path()),
                   "colour is 96x64 but depth is 48x32; where they differ, say depth's own "));
}

// The images reveal the order, not the names.
TEST(RecordedCamera, ReportsDepthFirstAssociations) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 1).ok());
  fs::rename(folder / "rgb", folder / "a");
  fs::rename(folder / "depth", folder / "b");
  test::write_file(folder / "pairs.txt", "100.0 b/100.005000.png 100.0 a/100.000000.png\n");
  SequenceOptions options;
  options.associations = folder / "pairs.txt";
  RecordedCamera camera;
  const Status status = open(camera, folder.path(), options);
  EXPECT_TRUE(says(status, "the associations name depth first")) << status.message();
}

// Only the two lists are exchanged; everything else is consistent.
TEST(RecordedCamera, ReportsExchangedLists) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 2).ok());
  fs::rename(folder / "rgb.txt", folder / "list");
  fs::rename(folder / "depth.txt", folder / "rgb.txt");
  fs::rename(folder / "list", folder / "depth.txt");
  RecordedCamera camera;
  Status status = open(camera, folder.path());
  EXPECT_TRUE(says(status, "the two lists are exchanged: rename rgb.txt to depth.txt")) << status.message();
  fs::copy_file(folder / "rgb.txt", folder / "depth.txt", fs::copy_options::overwrite_existing);
  status = open(camera, folder.path());
  EXPECT_TRUE(says(status, "is listed as colour and as depth")) << status.message();
}

TEST(RecordedCamera, KeepsEveryPropertyOfTheSensor) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 1).ok());
  fs::remove(folder / "calibration.txt");
  test::write_file(folder / "camera.yaml",
                   "fx: 80\nfy: 81\ncx: 47\ncy: 31\ndepth_scale: 1000\nreadout_s: 0.02\n");
  Calibration calibration;
  ASSERT_EQ(calibration_file_in(folder.path()), folder / "camera.yaml");
  ASSERT_TRUE(read_calibration(*calibration_file_in(folder.path()), calibration).ok());
  RecordedCamera camera;
  ASSERT_TRUE(camera.open(folder.path(), calibration).ok());
  EXPECT_EQ(camera.model().pinhole.fy, 81);
  EXPECT_EQ(camera.model().readout_s, 0.02);
  EXPECT_EQ(camera.model().width, 96);
  EXPECT_EQ(camera.calibration().depth_units_per_metre, 1000);
}

TEST(RecordedCamera, RejectsUnsuitableCalibration) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 1).ok());
  Calibration calibration;
  ASSERT_TRUE(builtin_calibration("tum-fr1", calibration).ok());
  RecordedCamera camera;
  EXPECT_TRUE(says(camera.open(folder.path(), calibration), "is for 640x480 images, these are 96x64"));
  calibration.has_size = false;
  EXPECT_TRUE(says(camera.open(folder.path(), calibration),
                   "the principal point (318.6, 255.3) lies outside the 96x64 images: the calibration is of "
                   "another size"));
}

TEST(RecordedCamera, ReadsARealSequence) {
  const char* shared = std::getenv("PLVO_SHARED");
  const fs::path folder = fs::path(shared == nullptr ? "" : shared) / "data" / "fr1_xyz_10f";
  if (!fs::exists(folder)) GTEST_SKIP() << "the shared sequences are not here: " << folder;
  RecordedCamera camera;
  ASSERT_TRUE(open(camera, folder).ok());
  // The two lists are offset by half a period, so that the closest-first rule leaves one image of each
  // unpaired.
  EXPECT_EQ(camera.frame_count(), 9u);
  EXPECT_EQ(camera.index().unpaired_colour, 1u);
  RgbdFrame frame;
  std::int64_t last = 0;
  for (int i = 0; i < 9; ++i) {
    ASSERT_TRUE(camera.next(frame).ok());
    EXPECT_GT(frame.stamp_ns, last);
    EXPECT_LE(std::abs(frame.depth_stamp_ns - frame.stamp_ns), 20'000'000);
    last = frame.stamp_ns;
  }
  EXPECT_EQ(camera.next(frame).code(), StatusCode::kEndOfStream);
}

class FakeClock final : public Clock {
 public:
  std::int64_t monotonic_ns() const override { return now_ns; }
  void sleep_until_ns(std::int64_t time) override { now_ns = std::max(now_ns, time); }
  std::int64_t now_ns = 5'000;
};

TEST(PacedCamera, RealtimeKeepsStampIntervals) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 3).ok());
  RecordedCamera camera;
  ASSERT_TRUE(open(camera, folder.path()).ok());
  FakeClock clock;
  PacedCamera paced(camera, Pace::kRealtime, clock, {});
  RgbdFrame frame;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(paced.next(frame).ok());
    EXPECT_EQ(clock.now_ns, 5'000 + i * test::kTinyStep);
  }
}

TEST(PacedCamera, StepAsksBeforeEachFrame) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tiny_sequence(folder.path(), 3).ok());
  RecordedCamera camera;
  ASSERT_TRUE(open(camera, folder.path()).ok());
  FakeClock clock;
  int steps = 0;
  PacedCamera paced(camera, Pace::kStep, clock, [&steps] { return ++steps <= 2; });
  RgbdFrame frame;
  EXPECT_TRUE(paced.next(frame).ok());
  EXPECT_TRUE(paced.next(frame).ok());
  EXPECT_EQ(paced.next(frame).code(), StatusCode::kEndOfStream);
  EXPECT_EQ(clock.now_ns, 5'000);
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Data that are readable but wrong: each fault is found, and recordings without a fault give no message.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/checks/calibration_check.hpp"
#include "plvo/replay/checks/frame_check.hpp"
#include "plvo/replay/recorded_camera.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;

constexpr int kImageWidth = 320, kImageHeight = 240;

std::string doubts(double fx, double fy, double cx, double cy, int width = 640, int height = 480) {
  CameraModel camera;
  camera.pinhole = {fx, fy, cx, cy};
  std::string text;
  for (const std::string& sentence : doubts_about(camera, width, height)) text += sentence + '\n';
  return text;
}

bool contains(const std::string& text, std::string_view words) {
  return text.find(words) != std::string::npos;
}

TEST(CalibrationCheck, AcceptsPlausibleCameras) {
  EXPECT_EQ(doubts(525, 525, 319.5, 239.5), "");
  EXPECT_EQ(doubts(615.2, 615.2, 298.4, 247.5), "") << "a RealSense's";
  EXPECT_EQ(doubts(505, 505, 320, 288, 640, 576), "") << "an Azure Kinect's";
  EXPECT_EQ(doubts(131, 131, 79.5, 59.5, 160, 120), "");
  for (const std::string_view name : builtin_calibration_names()) {
    Calibration calibration;
    ASSERT_TRUE(builtin_calibration(name, calibration).ok());
    EXPECT_TRUE(doubts_about(calibration.camera, 640, 480).empty()) << name;
  }
}

TEST(CalibrationCheck, ReportsImplausibleGeometry) {
  EXPECT_TRUE(contains(doubts(525, 525, 0, 0), "a coordinate of 0 was probably never filled in"));
  EXPECT_TRUE(contains(doubts(525, 525, 319.5, 0), "(319.5, 0.0) is far from the middle of 640x480 images"));
  EXPECT_TRUE(contains(doubts(525, 525, 239.5, 319.5), "cx and cy look exchanged"));
  EXPECT_TRUE(
      contains(doubts(525, 525, 319.5, 239.5, 1280, 720), "it is the middle of images of about 640x480"));
  EXPECT_TRUE(contains(doubts(525, 525, 319.5, 239.5, 848, 480), "of another size"));
  EXPECT_TRUE(contains(doubts(500, 277, 319.5, 239.5), "fx 500.0 and fy 277.0 differ by 81 %"));
  EXPECT_TRUE(contains(doubts(0.82, 0.82, 319.5, 239.5), "are fx and fy in pixels"));
  EXPECT_TRUE(contains(doubts(5250, 5250, 319.5, 239.5), "shows 7.0 degrees"));
}

// Boxes before a wall: each is nearer than the wall and has its own brightness.
struct BoxScene {
  std::vector<std::uint8_t> grey = std::vector<std::uint8_t>(kImageWidth * kImageHeight, 120);
  std::vector<std::uint16_t> depth = std::vector<std::uint16_t>(kImageWidth * kImageHeight, 10000);  // 2 m

  explicit BoxScene(std::uint64_t seed) {
    Random random(seed);
    const auto up_to = [&random](int n) { return static_cast<int>(random.uniform() * n); };
    for (int k = 0; k < 40; ++k) {
      const int x0 = up_to(kImageWidth - 40), y0 = up_to(kImageHeight - 40), w = 10 + up_to(30),
                h = 10 + up_to(30);
      const auto value = static_cast<std::uint8_t>(up_to(256));
      const auto units = static_cast<std::uint16_t>(9000 - 150 * k);
      for (int y = y0; y < y0 + h; ++y)
        for (int x = x0; x < x0 + w; ++x) {
          grey[static_cast<std::size_t>(y * kImageWidth + x)] = value;
          depth[static_cast<std::size_t>(y * kImageWidth + x)] = units;
        }
    }
  }
};

using Edit = std::function<void(std::vector<std::uint8_t>& grey, std::vector<std::uint16_t>& depth)>;

// Applies the edit to this many frames and returns the findings.
std::string findings(const Edit& edit, double units_per_metre = 5000, int frames = 40) {
  FrameCheck check;
  std::string text;
  const auto keep = [&text](const std::vector<std::string>& found) {
    for (const std::string& sentence : found) text += sentence + '\n';
  };
  for (int i = 0; i < frames; ++i) {
    BoxScene scene(static_cast<std::uint64_t>(i / 4));
    edit(scene.grey, scene.depth);
    RgbdFrame frame;
    frame.colour = {scene.grey.data(), kImageWidth, kImageHeight, kImageWidth, PixelFormat::kGray8};
    frame.depth = {scene.depth.data(), kImageWidth, kImageHeight, kImageWidth, 1 / units_per_metre};
    keep(check.add(frame));
  }
  keep(check.finish());
  return text;
}

void as_it_is(std::vector<std::uint8_t>&, std::vector<std::uint16_t>&) {}

TEST(FrameCheck, AcceptsGoodFrames) {
  EXPECT_EQ(findings(as_it_is), "");
  EXPECT_EQ(findings(as_it_is, 5000, 3), "");
  EXPECT_EQ(findings(as_it_is, 5000, 0), "");
}

TEST(FrameCheck, DistinguishesBlackColourFromEmptyDepth) {
  const std::string black =
      findings([](auto& grey, auto&) { std::fill(grey.begin(), grey.end(), std::uint8_t{7}); });
  EXPECT_TRUE(
      contains(black, "the colour images are black: of the first 40 frames no pixel is brighter than 7"));
  EXPECT_FALSE(contains(black, "depth"));
  const std::string white =
      findings([](auto& grey, auto&) { std::fill(grey.begin(), grey.end(), std::uint8_t{255}); });
  EXPECT_TRUE(contains(white, "all pixels lie between 255 and 255"));
  const std::string empty =
      findings([](auto&, auto& depth) { std::fill(depth.begin(), depth.end(), std::uint16_t{0}); }, 5000, 6);
  EXPECT_TRUE(contains(empty, "the depth images are empty: of the first 6 frames 0.00 % of the pixels"));
  EXPECT_FALSE(contains(empty, "colour images")) << empty;
  // A few black frames are not reported.
  int frame = 0;
  EXPECT_EQ(findings([&frame](auto& grey, auto& depth) {
              if (frame++ > 20) return;
              std::fill(grey.begin(), grey.end(), std::uint8_t{0});
              std::fill(depth.begin(), depth.end(), std::uint16_t{0});
            }),
            "");
}

TEST(FrameCheck, ReportsDepthInAnotherUnit) {
  EXPECT_TRUE(contains(findings(as_it_is, 1000), "1000 units per metre are used"));
  EXPECT_TRUE(contains(findings(as_it_is, 25000), "no depth lies beyond 0.42 m"));
}

// Every second row and column is empty, starting with the first or the second.
TEST(FrameCheck, AcceptsDepthWithEmptyRowsAndColumns) {
  for (const int first : {0, 1})
    EXPECT_EQ(findings([first](auto&, auto& depth) {
                for (int y = 0; y < kImageHeight; ++y)
                  for (int x = 0; x < kImageWidth; ++x)
                    if (x % 2 == first || y % 2 == first)
                      depth[static_cast<std::size_t>(y * kImageWidth + x)] = 0;
              }),
              "")
        << first;
}

// Each edit of depth, with the expected words.
TEST(FrameCheck, ReportsMirroredDepth) {
  const auto flip = [](bool left_right, bool up_down) {
    return findings([=](auto&, auto& depth) {
      const std::vector<std::uint16_t> copy = depth;
      for (int y = 0; y < kImageHeight; ++y)
        for (int x = 0; x < kImageWidth; ++x)
          depth[static_cast<std::size_t>(y * kImageWidth + x)] = copy[static_cast<std::size_t>(
              (up_down ? kImageHeight - 1 - y : y) * kImageWidth + (left_right ? kImageWidth - 1 - x : x))];
    });
  };
  EXPECT_TRUE(contains(flip(true, false), "depth looks mirrored left to right against colour"))
      << flip(true, false);
  EXPECT_TRUE(contains(flip(false, true), "depth looks upside down against colour"));
  EXPECT_TRUE(contains(flip(true, true), "depth looks turned by 180 degrees against colour"));
  EXPECT_EQ(flip(false, false), "");
  // Depth of an unrelated scene fits in no orientation and is not reported as mirrored.
  for (std::uint64_t seed = 100; seed < 130; ++seed)
    EXPECT_EQ(findings([seed](auto&, auto& depth) { depth = BoxScene(seed).depth; }, 5000, 10), "") << seed;
}

// The recorded sequences give no message; when mirrored, those with enough evidence are reported.
TEST(FrameCheck, ReportsRecordedSequencesOnlyWhenMirrored) {
  const char* shared = std::getenv("PLVO_SHARED");
  const fs::path data = fs::path(shared == nullptr ? "" : shared) / "data";
  if (!fs::exists(data)) GTEST_SKIP() << "the shared sequences are not here: " << data;
  for (const char* name : {"fr1_rpy_150", "fr1_desk_9f", "fr1_xyz_10f", "fr1_360_5f", "fr3_notexture_120",
                           "corridor_constant", "corridor_varying", "realsense_shelf_50"}) {
    SCOPED_TRACE(name);
    Calibration calibration;
    std::string guess;
    ASSERT_TRUE(sequence_calibration(data / name, calibration, guess).ok());
    RecordedCamera camera;
    SequenceOptions options;
    options.end_frame = 40;
    ASSERT_TRUE(camera.open(data / name, calibration, options).ok());
    EXPECT_EQ(camera.index().remark, "");
    EXPECT_TRUE(doubts_about(camera.model(), 640, 480).empty());
    FrameCheck as_is, mirrored;
    std::vector<std::string> of_as_is, of_mirrored;
    RgbdFrame frame;
    std::vector<std::uint16_t> flipped(640 * 480);
    const auto keep = [](std::vector<std::string>& to, const std::vector<std::string>& found) {
      to.insert(to.end(), found.begin(), found.end());
    };
    while (camera.next(frame).ok()) {
      keep(of_as_is, as_is.add(frame));
      for (int y = 0; y < 480; ++y)
        std::reverse_copy(frame.depth.data + y * frame.depth.stride,
                          frame.depth.data + y * frame.depth.stride + 640, flipped.begin() + y * 640);
      frame.depth.data = flipped.data();
      frame.depth.stride = 640;
      keep(of_mirrored, mirrored.add(frame));
    }
    keep(of_as_is, as_is.finish());
    keep(of_mirrored, mirrored.finish());
    EXPECT_TRUE(of_as_is.empty()) << of_as_is.front();
    // Five frames give too little evidence, and the depth of the shelf has holes in a comb pattern.
    const std::string_view n = name;
    if (n == "fr1_360_5f" || n == "realsense_shelf_50") continue;
    ASSERT_EQ(of_mirrored.size(), 1u);
    EXPECT_TRUE(contains(of_mirrored.front(), "mirrored left to right")) << of_mirrored.front();
  }
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// ScanNet's two cameras give bit for bit the same as a calibration.txt with the same numbers. A sequence
// with depth of half the size gives about the poses of the full size.
#include "plvo/replay/calibration/scannet_cameras.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "numbered_sequence.hpp"
#include "plvo/odometry/odometry.hpp"
#include "plvo/replay/calibration/sequence_calibration.hpp"
#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "says.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::says;
using test::scannet_file;
using test::write_file;

constexpr int kWidth = 160, kHeight = 120;  // of the depth

std::string matrix(const Pinhole& k) {
  return fmt::format("{} 0 {} 0\n0 {} {} 0\n0 0 1 0\n0 0 0 1\n", k.fx, k.cx, k.fy, k.cy);
}

// Colour has 320×240 pixels; depth has every second pixel, as a camera in the same place sees it.
class ScanNetCameras : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(sequence_.good());
    ASSERT_TRUE(read_calibration(folder_ / "intrinsic/intrinsic_depth.txt", colour_).ok());
    const Pinhole& k = colour_.camera.pinhole;
    depth_ = {k.fx / 2, k.fy / 2, k.cx / 2, k.cy / 2};
    write_file(folder_ / "intrinsic/intrinsic_color.txt", matrix(k));
    write_file(folder_ / "intrinsic/intrinsic_depth.txt", matrix(depth_));
    ImageDecoder decoder;
    std::vector<std::uint16_t> whole(4 * kWidth * kHeight), half(kWidth * kHeight);
    for (int i = 0; i < test::kNumberedFrames; ++i) {
      const fs::path file = folder_ / scannet_file("depth", i);
      ASSERT_TRUE(decoder.decode_depth(file, 2 * kWidth, 2 * kHeight, whole).ok());
      for (std::size_t v = 0; v < kHeight; ++v)
        for (std::size_t u = 0; u < kWidth; ++u) half[v * kWidth + u] = whole[4 * v * kWidth + 2 * u];
      ASSERT_TRUE(write_png(file, DepthView{half.data(), kWidth, kHeight, kWidth, 0.001}).ok());
    }
  }
  Status open(RecordedCamera& camera) const {
    Calibration calibration;
    std::string guess;
    if (Status status = sequence_calibration(folder_, calibration, guess); !status.ok()) return status;
    return camera.open(folder_, calibration);
  }
  // Concatenates all images of the camera, colour and depth.
  std::string bytes() const {
    RecordedCamera camera;
    const Status status = open(camera);
    EXPECT_TRUE(status.ok()) << status.message();
    std::string all;
    for (RgbdFrame frame; camera.next(frame).ok();) {
      all.append(reinterpret_cast<const char*>(frame.colour.data), 3 * 320 * 240);
      all.append(reinterpret_cast<const char*>(frame.depth.data), 2 * 320 * 240);
    }
    EXPECT_EQ(all.size(), 5u * 320 * 240 * test::kNumberedFrames);
    return all;
  }

  test::NumberedSequence sequence_;
  fs::path folder_ = sequence_.scannet();
  Calibration colour_;
  Pinhole depth_;
};

TEST_F(ScanNetCameras, EqualACalibrationWithADepthCamera) {
  // Depth is 4 cm right of the shared frame and rotated by some degrees; colour is 1 cm below it.
  const Se3 T_shared_depth = {rotation_exp({0.02, -0.05, 0.01}), {0.04, 0, 0}};
  const Se3 T_shared_colour = {Matrix3::Identity(), {0, 0.01, 0}};
  write_file(folder_ / "intrinsic/extrinsic_depth.txt", test::matrix_text(T_shared_depth));
  write_file(folder_ / "intrinsic/extrinsic_color.txt", test::matrix_text(T_shared_colour));
  RecordedCamera camera;
  const Status status = open(camera);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(camera.model().pinhole.fx, colour_.camera.pinhole.fx);
  EXPECT_EQ(camera.model().width, 320);
  EXPECT_EQ(camera.calibration().depth_units_per_metre, 1000);
  const DepthCamera& d = camera.calibration().depth_camera;
  ASSERT_TRUE(d.known);
  EXPECT_EQ(d.pinhole.fx, depth_.fx);
  EXPECT_EQ(d.pinhole.cy, depth_.cy);
  // Position of depth in the frame of colour: to the right and above.
  EXPECT_NEAR(d.tx, 0.04, 1e-12);
  EXPECT_NEAR(d.ty, -0.01, 1e-12);
  EXPECT_LT((to_rotation({d.qx, d.qy, d.qz, d.qw}) - T_shared_depth.R).norm(), 1e-9);

  const std::string expected = bytes();
  write_file(folder_ / "calibration.txt",
             fmt::format("{} {} {} {} 1000\ndepth_fx {}\ndepth_fy {}\ndepth_cx {}\ndepth_cy {}\ndepth_tx {}\n"
                         "depth_ty {}\ndepth_tz {}\ndepth_qx {}\ndepth_qy {}\ndepth_qz {}\ndepth_qw {}\n",
                         camera.model().pinhole.fx, camera.model().pinhole.fy, camera.model().pinhole.cx,
                         camera.model().pinhole.cy, d.pinhole.fx, d.pinhole.fy, d.pinhole.cx, d.pinhole.cy,
                         d.tx, d.ty, d.tz, d.qx, d.qy, d.qz, d.qw));
  EXPECT_TRUE(bytes() == expected);
  fs::remove(folder_ / "calibration.txt");
  fs::remove(folder_ / "intrinsic/extrinsic_depth.txt");
  EXPECT_TRUE(bytes() != expected) << "the extrinsics matter";
}

TEST_F(ScanNetCameras, TrackWithDepthOfHalfTheSize) {
  RecordedCamera camera;
  ASSERT_TRUE(open(camera).ok());
  std::vector<std::byte> memory(required_bytes(Limits::qvga()));
  Odometry odometry;
  ASSERT_TRUE(odometry.init(memory, camera.model(), Config(), Limits::qvga()).ok());
  TrackResult result;
  for (RgbdFrame frame; camera.next(frame).ok();) {
    result = odometry.track(frame);
    ASSERT_TRUE(result.status.ok()) << result.status.message();
  }
  const Se3 truth = ProceduralSequence::T_world_camera(0).inverse() *
                    ProceduralSequence::T_world_camera(test::kNumberedFrames - 1);
  EXPECT_GT(truth.t.norm(), 0.05);
  EXPECT_LT((result.T_world_camera.t - truth.t).norm(), 0.005);
}

TEST_F(ScanNetCameras, UseOneCameraForImagesOfOneSize) {
  for (int i = 0; i < test::kNumberedFrames; ++i) {
    const std::vector<std::uint8_t> small(3 * kWidth * kHeight, 80);
    ASSERT_TRUE(write_png(folder_ / scannet_file("color", i),
                          ColourView{small.data(), kWidth, kHeight, 3 * kWidth, PixelFormat::kRgb8})
                    .ok());
  }
  RecordedCamera camera;
  ASSERT_TRUE(open(camera).ok());
  EXPECT_EQ(camera.model().pinhole.fx, depth_.fx);
  EXPECT_FALSE(camera.calibration().depth_camera.known);
}

TEST_F(ScanNetCameras, RejectInvalidExtrinsics) {
  RecordedCamera camera;
  write_file(folder_ / "intrinsic/extrinsic_depth.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
  EXPECT_TRUE(says(open(camera), "extrinsic_depth.txt: expected four rows of four numbers"));
  write_file(folder_ / "intrinsic/extrinsic_depth.txt", "1 0 0 inf\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_TRUE(says(open(camera), "extrinsic_depth.txt: the numbers must be finite"));
  write_file(folder_ / "intrinsic/extrinsic_depth.txt", "1 0 0 40\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  EXPECT_TRUE(says(open(camera), "are metres, at most 1 m from the colour camera"));
  // Each of these files is an input that no output may overwrite.
  EXPECT_EQ(calibration_files_in(folder_).size(), 3u);
  write_file(folder_ / "calibration.txt", "277 277 160 120");
  EXPECT_EQ(calibration_files_in(folder_), std::vector<fs::path>{folder_ / "calibration.txt"});
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Serialised ROS messages, complete and truncated at every byte.
#include "plvo/rosbag/messages/messages.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "bag_writer.hpp"
#include "plvo/rosbag/messages/image_conversion.hpp"
#include "says.hpp"

namespace plvo {
namespace {

using test::camera_info_message;
using test::image_message;
using test::says;

std::vector<unsigned char> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

TEST(Messages, ReadsColourImages) {
  // Two rows of two pixels, each row with a padding byte.
  const std::string rows = "abcdef_ABCDEF_";
  for (const auto& [encoding, expected] :
       {std::pair<const char*, std::string>{"rgb8", "abcdefABCDEF"}, {"bgr8", "cbafedCBAFED"}}) {
    const auto bytes = bytes_of(image_message(1'500'000'007, 2, 2, encoding, 7, rows));
    ImageMessage image;
    const Status status = parse_image(WireFormat::kRos1, bytes, image);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(image.stamp_ns, 1'500'000'007);
    std::vector<std::uint8_t> rgb(12);
    ASSERT_TRUE(ImageConversion().colour(image, rgb).ok());
    EXPECT_EQ(std::string(rgb.begin(), rgb.end()), expected);
  }
  const auto grey = bytes_of(image_message(0, 3, 1, "mono8", 3, "xyz"));
  ImageMessage image;
  ASSERT_TRUE(parse_image(WireFormat::kRos1, grey, image).ok());
  std::vector<std::uint8_t> rgb(9);
  ASSERT_TRUE(ImageConversion().colour(image, rgb).ok());
  EXPECT_EQ(std::string(rgb.begin(), rgb.end()), "xxxyyyzzz");
}

TEST(Messages, ReadsColourWithFourOrUnnamedChannels) {
  for (const auto& [encoding, rows, expected] :
       {std::tuple<const char*, const char*, const char*>{"rgba8", "abc.def.", "abcdef"},
        {"bgra8", "abc.def.", "cbafed"},
        {"8UC3", "abcdef", "cbafed"}}) {
    const std::string pixels = rows;
    const auto bytes = bytes_of(image_message(0, 2, 1, encoding, pixels.size(), pixels));
    ImageMessage image;
    std::vector<std::uint8_t> rgb(6);
    ASSERT_TRUE(parse_image(WireFormat::kRos1, bytes, image).ok());
    EXPECT_TRUE(is_colour_encoding(encoding));
    ASSERT_TRUE(ImageConversion().colour(image, rgb).ok());
    EXPECT_EQ(std::string(rgb.begin(), rgb.end()), expected) << encoding;
    EXPECT_FALSE(parse_image(WireFormat::kRos1,
                             bytes_of(image_message(0, 2, 1, encoding, pixels.size() - 1, pixels.substr(1))),
                             image)
                     .ok())
        << "a byte too few";
  }
}

TEST(Messages, ReadsDepthImages) {
  ImageMessage image;
  std::vector<std::uint16_t> depth(2);
  for (const bool big_endian : {false, true})
    for (const char* encoding : {"16UC1", "mono16"}) {
      const auto whole = bytes_of(image_message(
          0, 2, 1, encoding, 4, big_endian ? "\x12\x34\x56\x78" : "\x34\x12\x78\x56", big_endian));
      EXPECT_TRUE(is_depth_encoding(encoding));
      ASSERT_TRUE(parse_image(WireFormat::kRos1, whole, image).ok());
      ASSERT_TRUE(ImageConversion().depth(image, depth).ok());
      EXPECT_EQ(depth, (std::vector<std::uint16_t>{0x1234, 0x5678}));
    }
  std::string rows;
  for (const float metres : {1.2345F, 0.00012F, -1.0F, 13.2F, std::bit_cast<float>(0x7fc00000u),
                             std::bit_cast<float>(0x7f800000u), 13.107F, 0.0F})
    rows += test::wire_u32(std::bit_cast<std::uint32_t>(metres));
  const auto metres = bytes_of(image_message(0, 8, 1, "32FC1", 32, rows));
  ASSERT_TRUE(parse_image(WireFormat::kRos1, metres, image).ok());
  depth.resize(8);
  ASSERT_TRUE(ImageConversion().depth(image, depth).ok());
  // Rounded to a fifth of a millimetre. Missing depth, and depth beyond 16 bits, become 0.
  EXPECT_EQ(depth, (std::vector<std::uint16_t>{6173, 1, 0, 0, 0, 0, 65535, 0}));
}

// A scene of one colour, seen through the pattern of each sensor; and one row of a checkerboard.
TEST(Messages, InterpolatesBayerPatterns) {
  ImageMessage image;
  constexpr int kWidth = 6, kHeight = 4;
  for (const auto& [encoding, block] : {std::pair<const char*, const char*>{"bayer_rggb8", "rggb"},
                                        {"bayer_grbg8", "grbg"},
                                        {"bayer_gbrg8", "gbrg"},
                                        {"bayer_bggr8", "bggr"}}) {
    std::string rows;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) rows += block[2 * (y % 2) + x % 2];
    const auto bytes = bytes_of(image_message(0, kWidth, kHeight, encoding, kWidth, rows));
    ASSERT_TRUE(parse_image(WireFormat::kRos1, bytes, image).ok());
    std::vector<std::uint8_t> rgb(3 * kWidth * kHeight);
    ASSERT_TRUE(ImageConversion().colour(image, rgb).ok());
    std::string expected;
    for (int i = 0; i < kWidth * kHeight; ++i) expected += "rgb";
    EXPECT_EQ(std::string(rgb.begin(), rgb.end()), expected) << encoding;
  }
  // Green between two red pixels of 10 and 30, above and below blue ones of 5 and 8.
  const auto bytes = bytes_of(
      image_message(0, 3, 3, "bayer_gbrg8", 3, {'\1', '\5', '\1', '\12', '\2', '\36', '\1', '\10', '\1'}));
  ASSERT_TRUE(parse_image(WireFormat::kRos1, bytes, image).ok());
  std::vector<std::uint8_t> rgb(27);
  ASSERT_TRUE(ImageConversion().colour(image, rgb).ok());
  EXPECT_EQ((std::vector<std::uint8_t>{rgb.begin() + 12, rgb.begin() + 15}),
            (std::vector<std::uint8_t>{20, 2, 7}));
}

// BT.601's black, white and primary colours.
TEST(Messages, ConvertsYuv) {
  ImageMessage image;
  for (const auto& [y, u, v, red, green, blue] : {std::array<int, 6>{16, 128, 128, 0, 0, 0},
                                                  {235, 128, 128, 255, 255, 255},
                                                  {81, 90, 240, 255, 0, 0},
                                                  {145, 54, 34, 0, 255, 1},
                                                  {41, 240, 110, 0, 0, 255}})
    for (const char* encoding : {"yuv422", "uyvy", "yuv422_yuy2", "yuyv"}) {
      const bool uyvy = encoding == std::string("yuv422") || encoding == std::string("uyvy");
      std::string pair;
      for (const int value : uyvy ? std::array{u, y, v, y} : std::array{y, u, y, v})
        pair += static_cast<char>(value);
      const auto bytes = bytes_of(image_message(0, 3, 1, encoding, 6, pair + pair.substr(0, 2)));
      ASSERT_TRUE(parse_image(WireFormat::kRos1, bytes, image).ok());
      std::vector<std::uint8_t> rgb(9);
      ASSERT_TRUE(ImageConversion().colour(image, rgb).ok());
      for (const std::size_t pixel : {0u, 1u}) {
        EXPECT_NEAR(rgb[3 * pixel], red, 1) << encoding;
        EXPECT_NEAR(rgb[3 * pixel + 1], green, 1) << encoding;
        EXPECT_NEAR(rgb[3 * pixel + 2], blue, 1) << encoding;
      }
    }
}

TEST(Messages, ReportsCompressedImagesThatAreNone) {
  const auto compressed = [](const std::string& format, const std::string& data) {
    return bytes_of(test::header_message(0) + test::wire_text(format) + test::wire_text(data));
  };
  ImageConversion conversion;
  const auto parse = [&](const std::vector<unsigned char>& bytes) {
    ImageMessage image;
    return conversion.parse(kCompressedImageType, WireFormat::kRos1, bytes, image);
  };
  EXPECT_TRUE(says(parse(compressed("h264", "no image")), "not a readable PNG, JPEG"));
  EXPECT_TRUE(says(parse(compressed("16UC1; compressedDepth rvl", "x")), "rvl is not read; png is"));
  EXPECT_TRUE(says(parse(compressed("16UC1; compressedDepth png", "x")), "ends early"));
  EXPECT_TRUE(says(parse(compressed("16UC1; compressedDepth png", "123456789012P5 1 1 255 x")),
                   "compressedDepth of '16UC1' with 8 bits is not read"));
}

TEST(Messages, ReportsOtherEncodings) {
  ImageMessage image;
  std::uint16_t depth = 0;
  std::uint8_t rgb[3] = {};
  const auto bytes = bytes_of(image_message(0, 1, 1, "rgb16", 6, "abcdef"));
  ASSERT_TRUE(parse_image(WireFormat::kRos1, bytes, image).ok());
  EXPECT_TRUE(says(ImageConversion().colour(image, rgb),
                   "'rgb16' is not read there; rgb8, bgr8, rgba8, bgra8, 8UC3, mono8, bayer_…8, yuv422, or "
                   "compressed is"));
  EXPECT_TRUE(says(ImageConversion().depth(image, {&depth, 1}),
                   "'rgb16' is not read there; 16UC1, mono16 or 32FC1 is"));
}

TEST(Messages, ChecksSizesAgainstTheData) {
  ImageMessage image;
  const std::string row = "abcdef";
  EXPECT_TRUE(says(parse_image(WireFormat::kRos1, bytes_of(image_message(0, 2, 2, "rgb8", 6, row)), image),
                   "an image of 2x2 has 6 bytes in rows of 6: too few"));
  EXPECT_TRUE(says(parse_image(WireFormat::kRos1, bytes_of(image_message(0, 2, 1, "rgb8", 5, row)), image),
                   "too few"));
  EXPECT_TRUE(says(parse_image(WireFormat::kRos1, bytes_of(image_message(0, 0, 1, "rgb8", 6, row)), image),
                   "0x1; at most"));
  EXPECT_TRUE(says(parse_image(WireFormat::kRos1, bytes_of(image_message(0, -1, 1, "rgb8", 6, row)), image),
                   "at most 4096x4096"));
  EXPECT_TRUE(says(
      parse_image(WireFormat::kRos1, bytes_of(image_message(0, 4096, 4096, "rgb8", 0xffffffff, row)), image),
      "too few"));
}

TEST(Messages, ReadsCameraInfoAsCalibration) {
  const CameraModel camera = {640, 480, {525, 526, 319, 239}, {}};
  Calibration calibration;
  Status status = parse_camera_info(
      WireFormat::kRos1,
      bytes_of(camera_info_message(0, camera, "plumb_bob", {0.1, -0.2, 0.001, 0.002, 0.3})), calibration);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(calibration.has_size);
  EXPECT_EQ(calibration.camera.height, 480);
  EXPECT_EQ(calibration.camera.pinhole.fy, 526);
  EXPECT_EQ(calibration.camera.pinhole.cx, 319);
  EXPECT_EQ(calibration.camera.distortion.k3, 0.3);
  EXPECT_FALSE(calibration.readout_given) << "ROS does not say how the shutter rolls";
  status =
      parse_camera_info(WireFormat::kRos1,
                        bytes_of(camera_info_message(0, camera, "equidistant", {0.1, 0, 0, 0})), calibration);
  EXPECT_TRUE(status.ok());
  EXPECT_EQ(calibration.camera.distortion.model, LensModel::kEquidistant);
  status = parse_camera_info(
      WireFormat::kRos1,
      bytes_of(camera_info_message(0, camera, "Brown Conrady", {0.1, -0.2, 0.001, 0.002, 0.3})), calibration);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_TRUE(calibration.camera.distortion.is_plumb_bob() && calibration.camera.distortion.k3 == 0.3);
  EXPECT_TRUE(says(parse_camera_info(WireFormat::kRos1,
                                     bytes_of(camera_info_message(0, camera, "omni", {1, 2})), calibration),
                   "'omni' is not supported"));
  EXPECT_TRUE(
      says(parse_camera_info(WireFormat::kRos1,
                             bytes_of(camera_info_message(0, {640, 480, {0, 0, 0, 0}, {}})), calibration),
           "not calibrated"));
}

TEST(Messages, ReadsImu) {
  const Vector3 rate(0.1, -0.2, 0.3), force(1, -9, 2);
  ImuMessage imu;
  ASSERT_TRUE(
      parse_imu(WireFormat::kRos1, bytes_of(test::imu_message(7, rate, true, force, true)), imu).ok());
  EXPECT_EQ(imu.stamp_ns, 7);
  ASSERT_TRUE(imu.rate && imu.force);
  EXPECT_EQ(*imu.rate, rate);
  EXPECT_EQ(*imu.force, force);
  ASSERT_TRUE(
      parse_imu(WireFormat::kRos1, bytes_of(test::imu_message(8, rate, false, force, true)), imu).ok());
  EXPECT_FALSE(imu.rate) << "its covariance says that it is not there";
  EXPECT_TRUE(imu.force);
  const std::string whole = test::imu_message(9, rate, true, force, true);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_EQ(parse_imu(WireFormat::kRos1, bytes_of(whole.substr(0, size)), imu).code(), StatusCode::kDamaged)
        << size;
  EXPECT_EQ(imu.stamp_ns, 8) << "a damaged one changes nothing";
}

TEST(Messages, CutOffAnywhereTheyAreRefused) {
  const std::string image = image_message(5, 4, 2, "rgb8", 12, std::string(24, 'x'));
  for (std::size_t size = 0; size < image.size(); ++size) {
    ImageMessage parsed;
    EXPECT_FALSE(parse_image(WireFormat::kRos1, bytes_of(image.substr(0, size)), parsed).ok()) << size;
  }
  const std::string info = camera_info_message(0, {640, 480, {525, 525, 320, 240}, {}});
  const std::size_t end_of_K = test::header_message(0).size() + 4 + 4 + 4 + 9 + 4 + 8 * (5 + 9);
  for (std::size_t size = 0; size < info.size(); ++size) {
    Calibration calibration;
    EXPECT_EQ(parse_camera_info(WireFormat::kRos1, bytes_of(info.substr(0, size)), calibration).ok(),
              size >= end_of_K)
        << size;
  }
  // A count of coefficients that exceeds any message.
  std::string wild = info;
  wild.replace(end_of_K - 8 * 14 - 4, 4, "\xff\xff\xff\xff");
  Calibration calibration;
  EXPECT_EQ(parse_camera_info(WireFormat::kRos1, bytes_of(wild), calibration).code(), StatusCode::kDamaged);
}

}  // namespace
}  // namespace plvo

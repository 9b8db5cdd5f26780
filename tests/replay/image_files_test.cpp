// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

using test::kTinyHeight;
using test::kTinyWidth;
using test::says;
using test::TemporaryFolder;
using test::TinyFrame;

TEST(Image, PngRoundTripIsExact) {
  const TemporaryFolder folder;
  const TinyFrame tiny(0);
  ASSERT_TRUE(write_png(folder / "c.png", tiny.frame.colour).ok());
  ASSERT_TRUE(write_png(folder / "d.png", tiny.frame.depth).ok());
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(tiny.rgb.size());
  std::vector<std::uint16_t> depth(tiny.depth.size());
  ASSERT_TRUE(decoder.decode_rgb(folder / "c.png", kTinyWidth, kTinyHeight, rgb).ok());
  ASSERT_TRUE(decoder.decode_depth(folder / "d.png", kTinyWidth, kTinyHeight, depth).ok());
  EXPECT_EQ(rgb, tiny.rgb);
  EXPECT_EQ(depth, tiny.depth);
}

TEST(Image, WritesBgrAndGreyAndStrides) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> bgr = {1, 2, 3, 4,  5,  6,  99, 99,
                                         7, 8, 9, 10, 11, 12, 99, 99};  // 2×2, stride 8
  ASSERT_TRUE(write_png(folder / "b.png", ColourView{bgr.data(), 2, 2, 8, PixelFormat::kBgr8}).ok());
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(12);
  ASSERT_TRUE(decoder.decode_rgb(folder / "b.png", 2, 2, rgb).ok());
  EXPECT_EQ(rgb, (std::vector<std::uint8_t>{3, 2, 1, 6, 5, 4, 9, 8, 7, 12, 11, 10}));
  const std::vector<std::uint8_t> grey = {10, 20, 30, 40};
  ASSERT_TRUE(write_png(folder / "g.png", ColourView{grey.data(), 2, 2, 2, PixelFormat::kGray8}).ok());
  ASSERT_TRUE(decoder.decode_rgb(folder / "g.png", 2, 2, rgb).ok());
  EXPECT_EQ(rgb, (std::vector<std::uint8_t>{10, 10, 10, 20, 20, 20, 30, 30, 30, 40, 40, 40}));
}

TEST(Image, ReadsJpegCloseToTheOriginal) {
  const TemporaryFolder folder;
  TinyFrame tiny(0);
  for (std::size_t i = 0; i < tiny.rgb.size(); ++i)  // smooth, so that JPEG preserves it
    tiny.rgb[i] = static_cast<std::uint8_t>(40 + (i / 3) % kTinyWidth + i % 3);
  const std::vector<std::uint8_t> jpeg = encode_jpeg(tiny.frame.colour, 95);
  test::write_file(folder / "c.jpg", std::string(jpeg.begin(), jpeg.end()));
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(tiny.rgb.size());
  const Status status = decoder.decode_rgb(folder / "c.jpg", kTinyWidth, kTinyHeight, rgb);
  ASSERT_TRUE(status.ok()) << status.message();
  for (std::size_t i = 0; i < rgb.size(); ++i) ASSERT_NEAR(rgb[i], tiny.rgb[i], 6) << i;
  // A truncated JPEG is damaged, not an image with grey bars.
  test::write_file(folder / "cut.jpg",
                   std::string(jpeg.begin(), jpeg.begin() + static_cast<long>(jpeg.size() / 2)));
  EXPECT_EQ(decoder.decode_rgb(folder / "cut.jpg", kTinyWidth, kTinyHeight, rgb).code(),
            StatusCode::kDamaged);
}

TEST(Image, ReadsPgmAndPpm) {
  const TemporaryFolder folder;
  const auto file = [&](std::string_view content) {
    test::write_file(folder / "image", content);
    return folder / "image";
  };
  using namespace std::string_view_literals;
  ImageDecoder decoder;
  ImageInfo info;
  std::vector<std::uint8_t> rgb(6);
  std::vector<std::uint16_t> depth(2);
  const auto rgb_of = [&](std::string_view content) {
    const Status status = decoder.decode_rgb(file(content), 2, 1, rgb);
    EXPECT_TRUE(status.ok()) << status.message();
    return rgb;
  };
  using Bytes = std::vector<std::uint8_t>;
  EXPECT_EQ(rgb_of("P6\n# by hand\n2 1\n255\n\1\2\3\4\5\6"sv), (Bytes{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(rgb_of("P6 2 1 65535 \1\0\2\0\3\0\4\0\xff\xff\0\x80"sv), (Bytes{1, 2, 3, 4, 255, 0}));
  EXPECT_EQ(rgb_of("P5 2 1 255\n\7\x9"sv), (Bytes{7, 7, 7, 9, 9, 9}));
  EXPECT_EQ(rgb_of("P5 2 1 100\n\x32\x65"sv), (Bytes{128, 128, 128, 255, 255, 255})) << "white is 100";
  EXPECT_EQ(rgb_of("P5 2 1 255\n##"sv), (Bytes{'#', '#', '#', '#', '#', '#'})) << "no comment";
  ASSERT_TRUE(decoder.read_header(file("P5 2 1 65535\n\x13\x88\xff\xff"sv), info).ok());
  EXPECT_TRUE(info.width == 2 && info.height == 1 && info.bits == 16 && info.grey);
  ASSERT_TRUE(decoder.decode_depth(folder / "image", 2, 1, depth).ok());
  EXPECT_EQ(depth, (std::vector<std::uint16_t>{5000, 65535}));
  ASSERT_TRUE(decoder.decode_depth(file("P5 2 1 10000\n\x13\x88\x27\x11"sv), 2, 1, depth).ok());
  EXPECT_EQ(depth, (std::vector<std::uint16_t>{5000, 10001})) << "units, whatever white is";
  EXPECT_TRUE(says(decoder.decode_depth(file("P5 2 1 255\n\1\2"sv), 2, 1, depth), "8 bits per channel;"));
  EXPECT_TRUE(says(decoder.decode_depth(file("P6 2 1 65535\n123456123456"sv), 2, 1, depth),
                   "16 bits per channel and colour"));
  EXPECT_TRUE(
      says(decoder.decode_rgb(file("P6 3 1 255\n123456789"sv), 2, 1, rgb), "is 3x1 where 2x1 is expected"));
  for (const std::string_view cut :
       {"P6 2 1 255\n12345"sv, "P6 2 1 256\n12345612345"sv, "P5 2 1 255\n1"sv, "P5 2 1 255\n"sv}) {
    const Status status = decoder.decode_rgb(file(cut), 2, 1, rgb);
    EXPECT_EQ(status.code(), StatusCode::kDamaged) << cut;
    EXPECT_TRUE(says(status, "image: damaged or cut off")) << status.message();
  }
  EXPECT_EQ(decoder.decode_depth(file("P5 2 1 65535\n123"sv), 2, 1, depth).code(), StatusCode::kDamaged);
  for (const std::string_view header : {"P5 "sv, "P5 2"sv, "P5 2 1"sv, "P5 2 1 255"sv, "P5 0 1 255\n1"sv,
                                        "P5 2 -1 255\n12"sv, "P5 2 1 65536\n1234"sv, "P5 2 1 0\n12"sv,
                                        "P5 99999999999 1 255\n1"sv, "P5 #\n"sv, "P5 2 1 255#\n12"sv})
    EXPECT_TRUE(says(decoder.read_header(file(header), info), "the header of a PGM or PPM has")) << header;
  EXPECT_TRUE(says(decoder.read_header(file("P5 5000 1 255\n"sv), info), "images of at most 4096x4096"));
  for (const std::string_view other :
       {"P2 2 1 255\n1 2"sv, "P3 1 1 255\n1 2 3"sv, "P4 8 1\n1"sv, "P7\nWIDTH 2\n"sv}) {
    const Status status = decoder.read_header(file(other), info);
    EXPECT_EQ(status.code(), StatusCode::kUnsupported) << other;
    EXPECT_TRUE(says(status, "only binary PGM and PPM (P5 and P6) are read")) << status.message();
  }
}

TEST(Image, RejectsDamagedFiles) {
  const TemporaryFolder folder;
  const TinyFrame tiny(0);
  ASSERT_TRUE(write_png(folder / "whole.png", tiny.frame.colour).ok());
  const std::string whole = test::read_file(folder / "whole.png");
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(tiny.rgb.size());
  for (std::size_t bytes : {std::size_t{0}, std::size_t{5}, std::size_t{20}, whole.size() / 2}) {
    test::write_file(folder / "cut.png", std::string_view(whole).substr(0, bytes));
    EXPECT_EQ(decoder.decode_rgb(folder / "cut.png", kTinyWidth, kTinyHeight, rgb).code(),
              StatusCode::kDamaged)
        << bytes;
  }
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(~flipped[whole.size() / 2]);
  test::write_file(folder / "flipped.png", flipped);
  EXPECT_EQ(decoder.decode_rgb(folder / "flipped.png", kTinyWidth, kTinyHeight, rgb).code(),
            StatusCode::kDamaged);
  EXPECT_EQ(decoder.decode_rgb(folder / "none.png", kTinyWidth, kTinyHeight, rgb).code(),
            StatusCode::kNotFound);
}

TEST(Image, RejectsOtherSizesAndBitDepths) {
  const TemporaryFolder folder;
  const TinyFrame tiny(0);
  ASSERT_TRUE(write_png(folder / "c.png", tiny.frame.colour).ok());
  ImageDecoder decoder;
  std::vector<std::uint8_t> rgb(12);
  EXPECT_TRUE(says(decoder.decode_rgb(folder / "c.png", 2, 2, rgb), "is 96x64 where 2x2 is expected"));
  std::vector<std::uint16_t> depth(tiny.depth.size());
  EXPECT_TRUE(
      says(decoder.decode_depth(folder / "c.png", kTinyWidth, kTinyHeight, depth), "8 bits per channel"));
}

TEST(Image, ReportsWriteFailure) {
  const TinyFrame tiny(0);
  EXPECT_EQ(write_png("/proc/no_such_file.png", tiny.frame.colour).code(), StatusCode::kIo);
  EXPECT_EQ(write_png("/dev/full", tiny.frame.colour).code(), StatusCode::kIo);
  EXPECT_TRUE(encode_jpeg({}, 80).empty());
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Masks in files: grey, in colours and with transparency, of the size of the images as recorded or as scaled
// down; and what is refused.
#include "plvo/replay/images/mask_file.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plvo/replay/images/image_writer.hpp"
#include "says.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

constexpr int kMaskFileWidth = 12;
constexpr int kMaskFileHeight = 8;

class MaskFile : public testing::Test {
 protected:
  // Grey levels by pixel; colour: the same in green alone, whose part in grey is 150/256.
  std::string write(const std::vector<std::uint8_t>& levels, int width, bool colour = false) {
    const int height = static_cast<int>(levels.size()) / width;
    std::vector<std::uint8_t> rgb;
    for (const std::uint8_t level : levels)
      rgb.insert(rgb.end(), {colour ? std::uint8_t{0} : level, level, colour ? std::uint8_t{0} : level});
    const std::filesystem::path file = folder_ / "mask.png";
    const ColourView grey{levels.data(), width, height, width, PixelFormat::kGray8};
    const ColourView coloured{rgb.data(), width, height, 3 * std::ptrdiff_t{width}, PixelFormat::kRgb8};
    const Status status = write_png(file, colour ? coloured : grey);
    EXPECT_TRUE(status.ok()) << status.message();
    return file.string();
  }
  test::TemporaryFolder folder_;
  std::vector<std::uint8_t> used_;
};

TEST_F(MaskFile, UsesWhatIsBright) {
  std::vector<std::uint8_t> levels(kMaskFileWidth * kMaskFileHeight, 255);
  levels[5] = 0;
  levels[17] = 127;
  levels[18] = 128;
  const Status status = read_mask(write(levels, kMaskFileWidth), kMaskFileWidth, kMaskFileHeight, 1, used_);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(used_.size(), levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) EXPECT_EQ(used_[i] != 0, i != 5 && i != 17) << i;
}

TEST_F(MaskFile, ColoursCountByTheirBrightness) {
  std::vector<std::uint8_t> levels(kMaskFileWidth * kMaskFileHeight, 255);
  levels[7] = 200;  // 117 as grey
  const Status status =
      read_mask(write(levels, kMaskFileWidth, true), kMaskFileWidth, kMaskFileHeight, 1, used_);
  ASSERT_TRUE(status.ok()) << status.message();
  for (std::size_t i = 0; i < levels.size(); ++i) EXPECT_EQ(used_[i] != 0, i != 7) << i;
}

// A pixel of the scaled image is used where all that it covers are used.
TEST_F(MaskFile, MayHaveTheSizeOfTheImagesBeforeTheyAreScaledDown) {
  std::vector<std::uint8_t> levels(kMaskFileWidth * kMaskFileHeight, 255);
  levels[kMaskFileWidth + 3] = 0;
  const std::string file = write(levels, kMaskFileWidth);
  ASSERT_TRUE(read_mask(file, kMaskFileWidth / 2, kMaskFileHeight / 2, 2, used_).ok());
  for (std::size_t i = 0; i < used_.size(); ++i) EXPECT_EQ(used_[i] != 0, i != 1) << i;
  ASSERT_TRUE(read_mask(file, kMaskFileWidth / 5, kMaskFileHeight / 5, 5, used_).ok());
  EXPECT_EQ(used_, (std::vector<std::uint8_t>{0, 255}));
  EXPECT_TRUE(read_mask(file, kMaskFileWidth, kMaskFileHeight, 2, used_).ok())
      << "or that of the scaled ones";
}

TEST_F(MaskFile, SaysWhatIsWrong) {
  const std::vector<std::uint8_t> white(kMaskFileWidth * kMaskFileHeight, 255), black(white.size(), 0);
  Status status = read_mask(write(white, kMaskFileWidth), 640, 480, 1, used_);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(test::says(status, "the mask has 12x8 pixels, the camera's images have 640x480; draw it over"))
      << status.message();
  status = read_mask(write(white, kMaskFileWidth), 640, 480, 2, used_);
  EXPECT_TRUE(test::says(status, "640x480, scaled down by 2; draw it over")) << status.message();
  status = read_mask(write(black, kMaskFileWidth), kMaskFileWidth, kMaskFileHeight, 1, used_);
  EXPECT_TRUE(test::says(status, "leaves no pixel to be used: white is used")) << status.message();
  EXPECT_EQ(read_mask(folder_ / "none.png", 640, 480, 1, used_).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace plvo

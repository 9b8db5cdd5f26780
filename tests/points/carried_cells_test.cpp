// SPDX-License-Identifier: Apache-2.0
// The votes of the image's cells: when a cell is carried, when it is not any more, and what it takes away.
#include "plvo/points/carried_cells.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace plvo {
namespace {

constexpr int kImageWidth = 320, kImageHeight = 240;  // cells of 20 × 20 pixels

CarriedCells empty_cells() {
  CarriedCells cells;
  cells.init(kImageWidth, kImageHeight);
  return cells;
}
CarriedCells::Counts counts_at(std::size_t cell, std::uint16_t count) {
  CarriedCells::Counts counts{};
  counts[cell] = count;
  return counts;
}

TEST(CarriedCells, APixelBelongsToTheCellAroundIt) {
  const CarriedCells image = empty_cells();
  for (int y = 0; y < kImageHeight; y += 3)
    for (int x = 0; x < kImageWidth; x += 3)
      EXPECT_EQ(image.cell_of(Vector2(x, y)),
                static_cast<std::size_t>(y / 20 * CarriedCells::kColumns + x / 20));
  EXPECT_EQ(image.cell_of(Vector2(-1e9, -1e9)), 0U);
  EXPECT_EQ(image.cell_of(Vector2(1e9, 1e9)), CarriedCells::kCells - 1);
}

TEST(CarriedCells, ThreeReferencesThatAgreeMakeACellCarried) {
  CarriedCells image = empty_cells();
  const Vector2 pixel(50, 70);
  const CarriedCells::Counts stayed = counts_at(image.cell_of(pixel), 2);
  for (int reference = 1; reference <= 3; ++reference) {
    EXPECT_FALSE(image.is_carried(pixel));
    image.vote(stayed, {});
  }
  EXPECT_TRUE(image.is_carried(pixel));
  EXPECT_FALSE(image.is_carried(Vector2(70, 70)));
  EXPECT_EQ(image.count(), 1);
  const PixelBounds bounds = image.bounds();
  EXPECT_EQ((std::array{bounds.left, bounds.top, bounds.right, bounds.bottom}), (std::array{40, 60, 60, 80}));
  image.vote({}, counts_at(image.cell_of(pixel), 1));
  EXPECT_FALSE(image.is_carried(pixel));
}

TEST(CarriedCells, MoreFeaturesThatMovedOutvoteThoseThatStayed) {
  CarriedCells image = empty_cells();
  for (int reference = 0; reference < 20; ++reference) image.vote(counts_at(5, 2), counts_at(5, 2));
  EXPECT_EQ(image.count(), 0);
}

TEST(CarriedCells, WithoutNewEvidenceVotesFallUntilTheCellIsTriedAgain) {
  CarriedCells image = empty_cells();
  for (int reference = 0; reference < 3; ++reference) image.vote(counts_at(5, 1), {});
  EXPECT_EQ(image.count(), 1);
  int references = 0;
  while (image.count() == 1 && references < 1000) {
    image.vote({}, {});
    ++references;
  }
  EXPECT_EQ(references, 27);
}

TEST(CarriedCells, ACertainFrameMarksTheCellsAroundToo) {
  CarriedCells image = empty_cells();
  image.mark_carried(counts_at(0, 1), false);
  EXPECT_EQ(image.count(), 4);  // a corner of the image
  image.mark_carried(counts_at(CarriedCells::kColumns * 5 + 5, 1), false);
  EXPECT_EQ(image.count(), 4 + 9);
  image.forget();
  EXPECT_EQ(image.count(), 0);
  EXPECT_EQ(image.bounds().right, 0);
}

TEST(CarriedCells, LightIsRememberedWhileACellIsCarried) {
  CarriedCells image = empty_cells();
  image.mark_carried(counts_at(0, 1), true);
  EXPECT_TRUE(image.has_light());
  image.mark_carried(counts_at(5, 1), false);
  EXPECT_TRUE(image.has_light());
  for (int reference = 0; reference < 1000 && image.count() > 0; ++reference) image.vote({}, {});
  EXPECT_FALSE(image.has_light());
}

TEST(CarriedCells, KeypointsThereLoseTheir3DPoints) {
  CarriedCells image = empty_cells();
  image.mark_carried(counts_at(image.cell_of(Vector2(100, 100)), 1), false);
  std::vector<std::byte> memory(1 << 20);
  Arena arena(memory);
  PointFeatures features;
  features.allocate(arena, 100);
  for (int i = 0; i < 100; ++i) {
    Keypoint keypoint;
    keypoint.u = static_cast<float>(i % 10 * 32);
    keypoint.v = static_cast<float>(i / 10 * 24);
    ASSERT_TRUE(features.keypoints.push_back(keypoint));
    features.points[static_cast<std::size_t>(i)].p = Vector3(0, 0, 1);
  }
  image.remove_points(features);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_EQ(features.points[i].p.z() > 0, !image.is_carried(features.keypoints[i])) << i;
}

}  // namespace
}  // namespace plvo

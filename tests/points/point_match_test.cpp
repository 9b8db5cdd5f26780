// SPDX-License-Identifier: Apache-2.0
// Compares the bucketed search with a brute-force search.
#include "plvo/points/point_match.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/points/descriptor.hpp"

namespace plvo {
namespace {

constexpr int kViewWidth = 333;
constexpr int kViewHeight = 250;
constexpr int kCapacity = 400;

constexpr std::size_t scratch_bytes() {
  Arena sizer = Arena::counting();
  reserve_point_match(sizer, kCapacity, kViewWidth, kViewHeight);
  return sizer.peak() + kArenaAlignment;
}

// The features of one frame and their memory.
class Frame {
 public:
  Frame()
      : memory_(kCapacity * (sizeof(Keypoint) + sizeof(Descriptor) + sizeof(Patch) + sizeof(Point3d)) +
                1024) {
    Arena arena(memory_);
    features.allocate(arena, kCapacity);
  }
  void add(double u, double v, int level, const Descriptor& descriptor) {
    Keypoint keypoint;
    keypoint.u = static_cast<float>(u);
    keypoint.v = static_cast<float>(v);
    keypoint.level = static_cast<std::uint8_t>(level);
    features.descriptors[features.keypoints.size()] = descriptor;
    ASSERT_TRUE(features.keypoints.push_back(keypoint));
  }
  PointFeatures features;

 private:
  std::vector<std::byte> memory_;
};

std::vector<Match> match(const Frame& reference, const std::vector<Prediction>& predictions,
                         const Frame& current, const PointMatchConfig& options) {
  std::vector<std::byte> memory(scratch_bytes());
  Arena scratch(memory);
  std::vector<Match> storage(kCapacity);
  FixedVector<Match> out(storage);
  match_points(reference.features, predictions, current.features, kViewWidth, kViewHeight, options, scratch,
               out);
  EXPECT_FALSE(scratch.exhausted());
  EXPECT_EQ(scratch.used(), 0U) << "the scratch is given back";
  EXPECT_EQ(out.dropped(), 0U);
  return {out.begin(), out.end()};
}

// The matching rule by brute force. The best candidate has the fewest differing bits, then the smaller index;
// the second is any other candidate in reach.
std::vector<Match> reference_match(const PointFeatures& reference, const std::vector<Prediction>& predictions,
                                   const PointFeatures& current, const PointMatchConfig& options) {
  const auto in_reach = [&](std::size_t i, std::size_t j) {
    const Keypoint& k = current.keypoints[j];
    const double du = k.u - predictions[i].u;
    const double dv = k.v - predictions[i].v;
    return k.level == reference.keypoints[i].level &&
           du * du + dv * dv <= options.radius_px * options.radius_px;
  };
  const auto distance = [&](std::size_t i, std::size_t j) {
    return hamming_distance(reference.descriptors[i], current.descriptors[j]);
  };
  constexpr int kInvalidSlot = -1;
  std::vector<int> choice(reference.keypoints.size(), kInvalidSlot);
  for (std::size_t i = 0; i < choice.size(); ++i) {
    if (!predictions[i].visible) continue;
    for (std::size_t j = 0; j < current.keypoints.size(); ++j)
      if (in_reach(i, j) &&
          (choice[i] == kInvalidSlot || distance(i, j) < distance(i, static_cast<std::size_t>(choice[i]))))
        choice[i] = static_cast<int>(j);
    if (choice[i] == kInvalidSlot) continue;
    const int best = distance(i, static_cast<std::size_t>(choice[i]));
    bool accepted = best <= options.max_distance;
    for (std::size_t j = 0; j < current.keypoints.size(); ++j)
      if (static_cast<int>(j) != choice[i] && in_reach(i, j)) {
        const int rival = distance(i, j);
        accepted = accepted && rival > best && best <= options.max_ratio * rival;
      }
    // A single candidate is compared with the worst possible distance.
    accepted = accepted && best <= options.max_ratio * 257;
    if (!accepted) choice[i] = kInvalidSlot;
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < choice.size(); ++i) {
    if (choice[i] == kInvalidSlot) continue;
    const auto j = static_cast<std::size_t>(choice[i]);
    bool nearest = true;
    for (std::size_t other = 0; other < choice.size(); ++other)
      if (other != i && choice[other] == choice[i])
        nearest = nearest && (distance(i, j) < distance(other, j) ||
                              (distance(i, j) == distance(other, j) && i < other));
    if (nearest) matches.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)});
  }
  return matches;
}

void expect_equal(const std::vector<Match>& got, const std::vector<Match>& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    ASSERT_EQ(got[i].reference, expected[i].reference);
    ASSERT_EQ(got[i].current, expected[i].current);
  }
}

Descriptor random_view_descriptor(Random& random) {
  Descriptor descriptor{};
  for (std::uint64_t& word : descriptor)
    word = static_cast<std::uint64_t>(random.next()) << 32 | random.next();
  return descriptor;
}
Descriptor with_flipped_bits(Descriptor descriptor, int count) {
  for (int i = 0; i < count; ++i)
    descriptor[static_cast<std::size_t>(i / 64)] ^= std::uint64_t{1} << (i % 64);
  return descriptor;
}

TEST(PointMatch, EqualsTheBruteForceResult) {
  Random random(32);
  std::size_t total = 0;
  for (int trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    Frame reference, current;
    std::vector<Prediction> predictions;
    // The descriptors are few and differ in few bits, so ties, rivals and shared choices are frequent.
    const Descriptor base = random_view_descriptor(random);
    const int variants = trial % 3 == 0 ? 4 : 120;
    const auto draw = [&] {
      return with_flipped_bits(base, static_cast<int>(random.below(static_cast<std::uint32_t>(variants))));
    };
    const int n = 20 + static_cast<int>(random.below(300));
    for (int i = 0; i < n; ++i) {
      reference.add(0, 0, static_cast<int>(random.below(3)), draw());
      // Predictions may lie outside the image.
      predictions.push_back({static_cast<float>(random.uniform() * (kViewWidth + 60) - 30),
                             static_cast<float>(random.uniform() * (kViewHeight + 60) - 30),
                             random.below(8) != 0});
    }
    for (int j = 0; j < n; ++j)
      current.add(random.uniform() * (kViewWidth - 1), random.uniform() * (kViewHeight - 1),
                  static_cast<int>(random.below(3)), draw());
    PointMatchConfig options;
    options.radius_px = trial % 4 == 0 ? 12 : trial % 4 == 1 ? 30 : trial % 4 == 2 ? 75.5 : 1000;
    options.max_ratio = trial % 5 == 0 ? 1.0 : 0.85;
    const std::vector<Match> expected =
        reference_match(reference.features, predictions, current.features, options);
    expect_equal(match(reference, predictions, current, options), expected);
    total += expected.size();
  }
  EXPECT_GT(total, 300U) << "too few matches to say anything";
}

class PointMatchPair : public testing::Test {
 protected:
  PointMatchPair() : descriptor_(with_flipped_bits({}, 0)) {}
  // One reference keypoint, expected at (100, 100).
  void expect_at(int bits) {
    reference_.add(0, 0, 0, with_flipped_bits(descriptor_, bits));
    predictions_.push_back({100, 100, true});
  }
  std::vector<Match> run() { return match(reference_, predictions_, current_, options_); }

  Descriptor descriptor_;
  Frame reference_, current_;
  std::vector<Prediction> predictions_;
  PointMatchConfig options_;
};

TEST_F(PointMatchPair, RespectsRadiusLevelAndMaximumDistance) {
  expect_at(0);
  current_.add(130.5, 100, 0, descriptor_);  // too far
  current_.add(101, 100, 1, descriptor_);    // another level
  EXPECT_TRUE(run().empty());
  current_.add(129.5, 100, 0, with_flipped_bits(descriptor_, 65));  // too different
  EXPECT_TRUE(run().empty());
  current_.add(100, 129.5, 0, with_flipped_bits(descriptor_, 10));
  ASSERT_EQ(run().size(), 1U);
  EXPECT_EQ(run()[0].current, 3);
}

TEST_F(PointMatchPair, RejectsAMatchAboveTheMaximumRatio) {
  expect_at(0);
  current_.add(100, 100, 0, with_flipped_bits(descriptor_, 17));
  current_.add(102, 100, 0, with_flipped_bits(descriptor_, 20));
  EXPECT_EQ(run().size(), 1U) << "17 of 20 is a ratio of 0.85";
  current_.add(104, 100, 0, with_flipped_bits(descriptor_, 19));
  EXPECT_TRUE(run().empty());
}

TEST_F(PointMatchPair, RejectsTwoEqualCandidates) {
  expect_at(0);
  current_.add(95, 100, 0, descriptor_);
  EXPECT_EQ(run().size(), 1U);
  current_.add(105, 100, 0, descriptor_);
  EXPECT_TRUE(run().empty()) << "a perfect match with an equally perfect rival says nothing";
  options_.max_ratio = 1;
  EXPECT_TRUE(run().empty());
}

TEST_F(PointMatchPair, KeepsOnlyTheNearestReferenceOfACandidate) {
  expect_at(9);
  expect_at(4);
  expect_at(4);
  current_.add(100, 100, 0, descriptor_);
  const std::vector<Match> matches = run();
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].reference, 1) << "of equals the first";
}

TEST_F(PointMatchPair, ReturnsNothingWithoutVisiblePredictions) {
  EXPECT_TRUE(run().empty());
  expect_at(0);
  EXPECT_TRUE(run().empty());
  current_.add(100, 100, 0, descriptor_);
  EXPECT_EQ(run().size(), 1U);
  predictions_[0].visible = false;
  EXPECT_TRUE(run().empty());
}

}  // namespace
}  // namespace plvo

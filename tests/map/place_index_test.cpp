// SPDX-License-Identifier: Apache-2.0
// The index against an exhaustive search over all descriptors.
#include "plvo/map/place_index.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "plvo/base/random.hpp"
#include "plvo/points/descriptor.hpp"

namespace plvo {
namespace {

constexpr MapLimits kLimits{64, 100, 1};
constexpr std::size_t kPerPlace = 100;

Descriptor draw(Random& random) {
  Descriptor descriptor;
  for (std::uint64_t& word : descriptor) {
    word = random.next();
    word = word << 32 | random.next();
  }
  return descriptor;
}

// Each bit is another one with this probability.
Descriptor disturb(Descriptor descriptor, double probability, Random& random) {
  for (std::uint64_t& word : descriptor)
    for (int bit = 0; bit < 64; ++bit)
      if (random.uniform() < probability) word ^= std::uint64_t{1} << bit;
  return descriptor;
}

class PlaceIndexTest : public testing::Test {
 protected:
  PlaceIndexTest() : memory_(1 << 20), stored_(64 * kPerPlace), excluded_(64, 0), found_(64) {
    arena_ = Arena(memory_);
    index_.allocate(arena_, kLimits);
    index_.clear();
    Random random(3);
    for (Descriptor& descriptor : stored_) descriptor = draw(random);
  }
  std::vector<PlaceCandidate> best_of(std::span<const Descriptor> descriptors, std::size_t most) {
    FixedVector<PlaceCandidate> best(std::span<PlaceCandidate>(found_).first(most));
    index_.query(stored_, descriptors, excluded_, best);
    return {best.begin(), best.end()};
  }
  std::vector<std::byte> memory_;
  Arena arena_;
  PlaceIndex index_;
  std::vector<Descriptor> stored_;
  std::vector<std::uint8_t> excluded_;
  std::vector<PlaceCandidate> found_;
};

TEST_F(PlaceIndexTest, FindsThePlaceThatAnExhaustiveSearchFinds) {
  for (std::size_t slot = 0; slot < 64; ++slot) index_.add(stored_, slot, kPerPlace);
  Random random(5);
  int right = 0;
  double recall = 0;
  for (std::size_t slot = 0; slot < 64; ++slot) {
    // Half of the place's descriptors come back, with one bit of eight changed.
    std::vector<Descriptor> seen;
    for (std::size_t i = 0; i < kPerPlace; ++i)
      seen.push_back(i % 2 == 0 ? disturb(stored_[slot * kPerPlace + i], 0.125, random) : draw(random));
    std::vector<int> votes(64);
    for (const Descriptor& descriptor : seen)
      for (std::size_t s = 0; s < stored_.size(); ++s)
        if (hamming_distance(stored_[s], descriptor) <= PlaceIndex::kNear) ++votes[s / kPerPlace];
    const auto exhaustive = std::max_element(votes.begin(), votes.end());
    const std::vector<PlaceCandidate> best = best_of(seen, 1);
    ASSERT_EQ(best.size(), 1U);
    right += best[0].slot == exhaustive - votes.begin() ? 1 : 0;
    recall += static_cast<double>(best[0].score) / PlaceIndex::kWholeVote / *exhaustive;
  }
  std::printf("the best place is the exhaustive search's in %d of 64; %.0f %% of its votes\n", right,
              100 * recall / 64);
  EXPECT_EQ(right, 64);
  // Expected: 1 − (1 − (7/8)^14)^3 = 40 %.
  EXPECT_GT(recall / 64, 0.3);
}

TEST_F(PlaceIndexTest, AVoteForManyPlacesCountsLess) {
  for (std::size_t slot = 0; slot < 4; ++slot) {
    stored_[slot * kPerPlace] = stored_[0];  // everywhere
    index_.add(stored_, slot, kPerPlace);
  }
  const std::vector<Descriptor> seen{stored_[0], stored_[2 * kPerPlace + 5]};
  const std::vector<PlaceCandidate> best = best_of(seen, 4);
  ASSERT_EQ(best.size(), 4U);
  EXPECT_EQ(best[0].slot, 2);
  EXPECT_EQ(best[0].score, PlaceIndex::kWholeVote + PlaceIndex::kWholeVote / 4);
  EXPECT_EQ(best[0].votes, 2) << "a vote is divided in the score only";
  EXPECT_EQ(best[1].slot, 0) << "among equal ones the lower slot";
  EXPECT_EQ(best[1].score, PlaceIndex::kWholeVote / 4);
  EXPECT_EQ(best[1].votes, 1);
}

TEST_F(PlaceIndexTest, ForgetsWhatWasRemovedAndLeavesOutWhatIsExcluded) {
  for (std::size_t slot = 0; slot < 8; ++slot) index_.add(stored_, slot, kPerPlace);
  const auto place = [this](std::size_t slot) {
    return std::span<const Descriptor>(stored_).subspan(slot * kPerPlace, kPerPlace);
  };
  EXPECT_EQ(best_of(place(3), 1).at(0).slot, 3);
  index_.remove(stored_, 3, kPerPlace);
  EXPECT_TRUE(best_of(place(3), 1).empty());
  EXPECT_EQ(best_of(place(4), 1).at(0).slot, 4);
  excluded_[4] = 1;
  EXPECT_TRUE(best_of(place(4), 1).empty());
  index_.add(stored_, 3, kPerPlace);
  EXPECT_EQ(best_of(place(3), 1).at(0).score, kPerPlace * PlaceIndex::kWholeVote);
}

TEST_F(PlaceIndexTest, ListsOfEqualDescriptorsStayShort) {
  std::fill(stored_.begin(), stored_.end(), stored_[0]);
  for (std::size_t slot = 0; slot < 64; ++slot) index_.add(stored_, slot, kPerPlace);
  // The latest are found; the others fell out, and removing them all leaves nothing.
  EXPECT_EQ(best_of(std::span<const Descriptor>(stored_).first(1), 1).at(0).slot, 63);
  for (std::size_t slot = 0; slot < 64; ++slot) index_.remove(stored_, slot, kPerPlace);
  EXPECT_TRUE(best_of(std::span<const Descriptor>(stored_).first(1), 1).empty());
}

}  // namespace
}  // namespace plvo

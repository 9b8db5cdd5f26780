// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/line_support_region.hpp"

#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/lines/lsd/angle_range.hpp"

namespace plvo::lsd {

namespace {

// Returns the bits of `fit` that are in one sequence of ones with any bit of `seeds`. `fit` is one byte, or
// two with zeros between them; `seeds` is a subset of it.
unsigned spread(unsigned seeds, unsigned fit) {
  // Upwards, a sum carries through the ones; downwards, shifts by one, two and four spread the bits.
  const unsigned up = fit & ~(fit + seeds);
  unsigned down = seeds, through = fit;
  down |= through & down >> 1;
  through &= through >> 1;
  down |= through & down >> 2;
  through &= through >> 2;
  down |= through & down >> 4;
  return up | down;
}

// Returns whether no pixel adjacent to this one is open, which is frequent. For pixels at the ends of a block
// it returns false.
bool is_alone(const std::uint8_t* open, std::ptrdiff_t stride, unsigned bit) {
  const unsigned beside = bit << 1 | bit >> 1;
  const unsigned open_around = (open[0] & beside) | ((open[-stride] | open[stride]) & (beside | bit));
  return (open_around | (bit & 0x81U)) == 0;
}

}  // namespace

Region grow(LevelLineField& field, PixelRun seed, Angle tolerance, std::span<PixelRun> storage) {
  // Local pointers: otherwise the compiler must assume that a write to the flags changes the arrays'
  // addresses.
  std::uint8_t* const open = field.open();
  const Angle* const angles = field.angles();
  PixelRun* const runs = storage.data();
  const std::ptrdiff_t stride = field.stride;
  const Angle seed_angle = angles[field.pixel(first_x(seed), seed.row)];
  AngleRange range(seed_angle, tolerance);
  AngleSum sum(seed_angle);
  std::size_t run_count = 0;
  std::int32_t count = 0;  // pixels of the runs processed so far
  std::int32_t renew = 0;
  // Takes the pixels of a block that touch the region, are open, and are in the range. Whether there are any
  // is unpredictable, so the code does not branch on it.
  const auto take = [&](std::ptrdiff_t at, int row, int block, unsigned touching) {
    const unsigned free = open[at];
    if (kSimdLoops && (free & touching) == 0) return;  // testing eight angles costs more than the branch
    const unsigned fit = free & range.holding(angles + at * kBlockPixels);
    const unsigned taken = spread(fit & touching, fit);
    open[at] = static_cast<std::uint8_t>(free & ~taken);
    runs[run_count] = {static_cast<std::uint16_t>(row), static_cast<std::uint8_t>(block),
                       static_cast<std::uint8_t>(taken)};
    run_count += taken != 0 ? 1 : 0;
  };
  // The same for the blocks above and below, together: one's bits from bit 0 on, the other's from bit 16 on.
  const auto take_above_and_below = [&](std::ptrdiff_t at, PixelRun of, unsigned touching) {
    const std::ptrdiff_t above = at - stride, below = at + stride;
    const unsigned free = open[above] | unsigned{open[below]} << 16;
    const unsigned fit = free & (range.holding(angles + above * kBlockPixels) |
                                 range.holding(angles + below * kBlockPixels) << 16);
    const unsigned taken = spread(fit & (touching | touching << 16), fit);
    const unsigned left = free & ~taken;
    open[above] = static_cast<std::uint8_t>(left);
    open[below] = static_cast<std::uint8_t>(left >> 16);
    runs[run_count] = {static_cast<std::uint16_t>(of.row - 1), of.block, static_cast<std::uint8_t>(taken)};
    run_count += (taken & 0xffU) != 0 ? 1 : 0;
    runs[run_count] = {static_cast<std::uint16_t>(of.row + 1), of.block,
                       static_cast<std::uint8_t>(taken >> 16)};
    run_count += taken >> 16 != 0 ? 1 : 0;
  };
  // The seed is always taken, even if it was released too often to be open.
  const std::ptrdiff_t at_seed = field.index(seed);
  open[at_seed] = static_cast<std::uint8_t>(open[at_seed] | seed.bits);
  if (is_alone(open + at_seed, stride, seed.bits)) {
    open[at_seed] = static_cast<std::uint8_t>(open[at_seed] & ~seed.bits);
    runs[0] = seed;
    return {storage.first(1), 1, seed, seed_angle, 0};
  }
  take(at_seed, seed.row, seed.block, seed.bits);
  for (std::size_t next = 0; next < run_count; ++next) {
    const PixelRun run = runs[next];
    const std::ptrdiff_t at = field.index(run);
    const unsigned bits = run.bits;
    sum.add(angles + at * kBlockPixels, bits);
    count += kOnes[bits];
    if (count >= renew) {
      range = AngleRange(static_cast<Angle>(seed_angle + sum.beyond() / count), tolerance);
      renew = count + count / 8 + 1;
    }
    const unsigned touching = (bits | bits << 1 | bits >> 1) & 0xffU;
    if constexpr (kSimdLoops) {
      take(at - stride, run.row - 1, run.block, touching);
      take(at + stride, run.row + 1, run.block, touching);
    } else {
      take_above_and_below(at, run, touching);
    }
    // Adjacent blocks rarely have open pixels, so a branch pays off.
    const auto take_beside = [&](int right, unsigned touching_there) {
      for (int down = -1; down <= 1; ++down) {
        const std::ptrdiff_t there = at + down * stride + right;
        if ((open[there] & touching_there) != 0)
          take(there, run.row + down, run.block + right, touching_there);
      }
    };
    if ((bits & 0x01U) != 0) take_beside(-1, 0x80U);
    if ((bits & 0x80U) != 0) take_beside(1, 0x01U);
  }
  return {storage.first(run_count), count, seed, seed_angle, sum.beyond()};
}

void release(LevelLineField& field, PixelRun run) {
  const std::ptrdiff_t at = field.index(run);
  constexpr std::int16_t kReleases = (1 << (16 - LevelLineField::kReleaseBit)) - 1;
  static_assert(kMaxReleases <= kReleases);
  std::int16_t* const magnitudes = field.magnitude_and_releases.data() + at * kBlockPixels;
  Int16x8 vector;
  load(magnitudes, vector);
  const Int16x8 may = (((vector >> LevelLineField::kReleaseBit) & kReleases) != std::int16_t{kMaxReleases}) &
                      chosen(run.bits);
  const Int16x8 more = vector + (may & std::int16_t{1 << LevelLineField::kReleaseBit});
  store(more, magnitudes);
  std::uint8_t& open = field.open()[at];
  open = static_cast<std::uint8_t>(open | negative_mask(may));
}

}  // namespace plvo::lsd

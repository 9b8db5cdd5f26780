// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/fast.hpp"

#include <algorithm>
#include <cstring>

#include "plvo/base/build.hpp"
#include "plvo/base/simd.hpp"

namespace plvo {
namespace {

using Byte = std::uint8_t;

// This code works on bytes, without branches or arrays, so that compilers vectorise the loop over a row.
constexpr Byte least(Byte a, Byte b) { return a < b ? a : b; }
constexpr Byte most(Byte a, Byte b) { return a > b ? a : b; }

// For every run of nine contiguous circle pixels takes the worst value, and returns the best of these. Runs
// of eight that start at odd positions are shared. Two runs of nine extend such a run, by the pixel before or
// the pixel after it; the better of these two pixels decides.
template <Byte (*Worse)(Byte, Byte), Byte (*Better)(Byte, Byte)>
inline Byte best_run_of_nine(Byte p0, Byte p1, Byte p2, Byte p3, Byte p4, Byte p5, Byte p6, Byte p7, Byte p8,
                             Byte p9, Byte p10, Byte p11, Byte p12, Byte p13, Byte p14, Byte p15) {
  const Byte two1 = Worse(p1, p2);
  const Byte two3 = Worse(p3, p4);
  const Byte two5 = Worse(p5, p6);
  const Byte two7 = Worse(p7, p8);
  const Byte two9 = Worse(p9, p10);
  const Byte two11 = Worse(p11, p12);
  const Byte two13 = Worse(p13, p14);
  const Byte two15 = Worse(p15, p0);
  const Byte four1 = Worse(two1, two3);
  const Byte four3 = Worse(two3, two5);
  const Byte four5 = Worse(two5, two7);
  const Byte four7 = Worse(two7, two9);
  const Byte four9 = Worse(two9, two11);
  const Byte four11 = Worse(two11, two13);
  const Byte four13 = Worse(two13, two15);
  const Byte four15 = Worse(two15, two1);
  const Byte run0 = Worse(Worse(four1, four5), Better(p0, p9));
  const Byte run2 = Worse(Worse(four3, four7), Better(p2, p11));
  const Byte run4 = Worse(Worse(four5, four9), Better(p4, p13));
  const Byte run6 = Worse(Worse(four7, four11), Better(p6, p15));
  const Byte run8 = Worse(Worse(four9, four13), Better(p8, p1));
  const Byte run10 = Worse(Worse(four11, four15), Better(p10, p3));
  const Byte run12 = Worse(Worse(four13, four1), Better(p12, p5));
  const Byte run14 = Worse(Worse(four15, four3), Better(p14, p7));
  return Better(Better(Better(run0, run2), Better(run4, run6)),
                Better(Better(run8, run10), Better(run12, run14)));
}

// How much brighter, or darker, a whole run is than the centre. Differences saturate at zero.
inline Byte contrast(Byte centre, Byte brightest, Byte darkest) {
  const auto above = static_cast<Byte>(most(brightest, centre) - centre);
  const auto below = static_cast<Byte>(centre - least(darkest, centre));
  return most(above, below);
}

// Returns whether nine contiguous bits of the circle are set.
bool holds_a_run(std::uint32_t circle) {
  circle |= circle << 16;
  circle &= circle >> 1;
  circle &= circle >> 2;
  circle &= circle >> 4;
  return (circle & circle >> 1) != 0;
}

// Computes the same in loops, with a third of the code, for the pixels that pass. All others get at most the
// floor.
void score_passing(const Byte* row, std::ptrdiff_t stride, int width, Byte floor, Byte* scores) {
  constexpr int kCircle = 16, kRun = 9, kAround = kCircle + kRun;
  static constexpr std::int8_t kAcross[kCircle] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  std::ptrdiff_t
      offset[kCircle];  // clockwise from the top; the row offset is the column offset a quarter turn earlier
  for (int i = 0; i < kCircle; ++i) offset[i] = kAcross[i] + kAcross[(i + 12) % kCircle] * stride;
  for (int x = 0; x < width; ++x) {
    if (scores[x] <= floor) continue;
    scores[x] = floor;
    const Byte centre = row[x];
    Byte circle[kAround], low[kAround], high[kAround];
    std::uint32_t brighter = 0, darker = 0;
    for (int i = 0; i < kCircle; ++i) {
      circle[i] = row[x + offset[i]];
      brighter = brighter << 1 | (circle[i] > centre + floor ? 1 : 0);
      darker = darker << 1 | (circle[i] + floor < centre ? 1 : 0);
    }
    if (!holds_a_run(brighter) && !holds_a_run(darker)) continue;
    for (int i = 0; i < kAround; ++i) circle[i] = low[i] = high[i] = circle[i % kCircle];
    // Least and greatest of two, four and eight pixels from i on.
    for (int step = 1; step < kRun - 1; step *= 2)
      for (int i = 0; i + step < kAround; ++i) {
        low[i] = least(low[i], low[i + step]);
        high[i] = most(high[i], high[i + step]);
      }
    Byte brightest = 0, darkest = 255;
    for (int i = 0; i < kCircle; ++i) {
      brightest = most(brightest, least(low[i], circle[i + kRun - 1]));
      darkest = least(darkest, most(high[i], circle[i + kRun - 1]));
    }
    scores[x] = contrast(centre, brightest, darkest);
  }
}

inline __attribute__((always_inline)) void score_pixels(const Byte* row, std::ptrdiff_t stride, int width,
                                                        Byte* __restrict scores) {
  const Byte* up3 = row - 3 * stride;
  const Byte* up2 = row - 2 * stride;
  const Byte* up1 = row - stride;
  const Byte* down1 = row + stride;
  const Byte* down2 = row + 2 * stride;
  const Byte* down3 = row + 3 * stride;
  for (int x = 0; x < width; ++x) {
    // Clockwise from the top.
    const Byte p0 = up3[x], p1 = up3[x + 1], p2 = up2[x + 2], p3 = up1[x + 3];
    const Byte p4 = row[x + 3], p5 = down1[x + 3], p6 = down2[x + 2], p7 = down3[x + 1];
    const Byte p8 = down3[x], p9 = down3[x - 1], p10 = down2[x - 2], p11 = down1[x - 3];
    const Byte p12 = row[x - 3], p13 = up1[x - 3], p14 = up2[x - 2], p15 = up3[x - 1];
    const Byte brightest =
        best_run_of_nine<least, most>(p0, p1, p2, p3, p4, p5, p6, p7, p8, p9, p10, p11, p12, p13, p14, p15);
    const Byte darkest =
        best_run_of_nine<most, least>(p0, p1, p2, p3, p4, p5, p6, p7, p8, p9, p10, p11, p12, p13, p14, p15);
    scores[x] = contrast(row[x], brightest, darkest);
  }
}

// Upper bound of the scores. Nine contiguous pixels contain the top or the bottom pixel, and the left or the
// right one.
inline __attribute__((always_inline)) void bound_pixels(const Byte* row, std::ptrdiff_t stride, int width,
                                                        Byte* __restrict bounds) {
  const Byte* up3 = row - 3 * stride;
  const Byte* down3 = row + 3 * stride;
  for (int x = 0; x < width; ++x) {
    const Byte top = up3[x], bottom = down3[x], left = row[x - 3], right = row[x + 3];
    bounds[x] = contrast(row[x], least(most(top, bottom), most(left, right)),
                         most(least(top, bottom), least(left, right)));
  }
}

constexpr int kBlock = sizeof(Bytes);

inline __attribute__((always_inline)) bool any_above(Byte floor, const Byte* scores, int size) {
  if (kSimdLoops || size < kBlock) {
    Byte highest = 0;
    for (int i = 0; i < size; ++i) highest = most(highest, scores[i]);
    return highest > floor;
  }
  Bytes block;
  std::memcpy(&block, scores, sizeof block);
  const Bytes above = block > Bytes{} + floor;
  return set_bytes(above) != 0;
}

// Computes the scores only if a pixel of the block may pass.
inline __attribute__((always_inline)) void score_block(const Byte* row, std::ptrdiff_t stride, int size,
                                                       Byte floor, Byte* __restrict scores) {
  bound_pixels(row, stride, size, scores);
  if (!any_above(floor, scores, size)) return;
  if (kSimdLoops)
    score_passing(row, stride, size, floor, scores);
  else
    score_pixels(row, stride, size, scores);
}

}  // namespace

void segment_test_row(const std::uint8_t* row, std::ptrdiff_t stride, int width, std::uint8_t floor,
                      std::uint8_t* __restrict scores) {
  int x = 0;
  // Code compiled for the constant size of a whole block is faster.
  if constexpr (!kSimdLoops)
    for (; x + kBlock <= width; x += kBlock) score_block(row + x, stride, kBlock, floor, scores + x);
  for (; x < width; x += kBlock) score_block(row + x, stride, std::min(kBlock, width - x), floor, scores + x);
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/checks/edge_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace plvo {
namespace {

constexpr int kRowStep = 3;        // odd, because some sensors leave every second row empty
constexpr int kMostHole_px = 16;   // between the two sides of a jump: shadows of the projector
constexpr int kReach_px = 3;       // error of the registration
constexpr int kMostContrast = 64;  // limits the weight of a few sharp edges
constexpr int kFewestRatio = 10;   // a jump is a tenth of the nearer depth or more
constexpr std::uint64_t kFewestJumps = 20;
constexpr int kFewestBlocks = 8;
constexpr double kFewestErrors = 3;
constexpr double kLeastGain = 1.3;

int brightness(const ColourView& colour, int x, int y) {
  const int bytes = colour.format == PixelFormat::kGray8 ? 1 : 3;
  return colour.data[y * colour.stride_bytes + x * bytes + bytes / 2];  // green is the middle channel
}

// The strongest horizontal contrast within kReach_px.
int contrast(const ColourView& colour, int x, int y) {
  int most = 0;
  for (int i = std::max(x - kReach_px, 1); i <= std::min(x + kReach_px, colour.width - 2); ++i)
    most = std::max(most, std::abs(brightness(colour, i + 1, y) - brightness(colour, i - 1, y)));
  return std::min(most, kMostContrast);
}

}  // namespace

void EdgeAgreement::add_jump(const RgbdFrame& frame, int x, int y) {
  const ColourView& colour = frame.colour;
  const int right = colour.width - 1, bottom = colour.height - 1;
  Block& block =
      blocks_[static_cast<std::size_t>(y * kRows / colour.height * kColumns + x * kColumns / colour.width)];
  ++block.jumps;
  block.contrast[kAsIs] += contrast(colour, x, y);
  block.contrast[kMirrored] += contrast(colour, right - x, y);
  block.contrast[kUpsideDown] += contrast(colour, x, bottom - y);
  block.contrast[kTurned] += contrast(colour, right - x, bottom - y);
}

void EdgeAgreement::add(const RgbdFrame& frame) {
  const DepthView& depth = frame.depth;
  for (int y = 0; y < depth.height; y += kRowStep) {
    const std::uint16_t* row = depth.data + y * depth.stride;
    int last = -1;  // the last pixel with depth
    for (int x = 0; x < depth.width; ++x) {
      if (row[x] == 0) continue;
      if (last >= 0 && x - last <= kMostHole_px) {
        const int nearer = std::min(row[x], row[last]);
        if (std::abs(row[x] - row[last]) * kFewestRatio > nearer)
          add_jump(frame, row[x] < row[last] ? x : last, y);
      }
      last = x;
    }
  }
}

std::string EdgeAgreement::misfit() const {
  constexpr const char* kWords[] = {"", "mirrored left to right", "upside down", "turned by 180 degrees"};
  std::string words;
  double best = kFewestErrors;
  for (const Place place : {kMirrored, kUpsideDown, kTurned}) {
    double as_is = 0, other = 0, sum = 0, squares = 0;
    int blocks = 0;
    for (const Block& block : blocks_) {
      const double a = block.contrast[kAsIs], b = block.contrast[place];
      if (block.jumps < kFewestJumps || a + b <= 0) continue;
      const double ratio = (b - a) / (b + a);
      as_is += a;
      other += b;
      sum += ratio;
      squares += ratio * ratio;
      ++blocks;
    }
    if (blocks < kFewestBlocks || other < kLeastGain * as_is) continue;
    const double mean = sum / blocks;
    const double variance = (squares - sum * mean) / (blocks - 1);
    const double errors = mean / std::sqrt(std::max(variance, 1e-12) / blocks);
    if (errors < best) continue;
    best = errors;
    words = kWords[place];
  }
  return words;
}

}  // namespace plvo

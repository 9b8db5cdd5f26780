// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line_samples.hpp"

#include <algorithm>

namespace plvo {

namespace {

// Consecutive readings of one surface.
struct Surface {
  int readings = 0;
  int nearest_offset = 1 << 10;  // smallest |offset| from the middle; depth_m holds that reading
  bool at_end = false;           // touches an end of the profile
  float depth_m = 0;
};

// A surface is reliable if a second reading confirms it, or if a second reading may lie just outside of the
// profile.
bool confirmed(const Surface& s) { return s.readings >= 2 || s.at_end; }

bool better(const Surface& s, const Surface& than) {
  if (than.readings == 0) return true;
  if (confirmed(s) != confirmed(than)) return confirmed(s);
  return s.depth_m < than.depth_m;
}

}  // namespace

SurfaceReading nearer_surface(std::span<const float> profile, const DepthNoise& noise) {
  const int n = static_cast<int>(profile.size());
  const int middle = n / 2;
  Surface best, current;
  int surfaces = 0;
  int last_index = -1;
  float last_depth = 0;
  for (int i = 0; i < n; ++i) {
    const float d = profile[static_cast<std::size_t>(i)];
    if (!(d > 0)) continue;
    if (last_index >= 0) {
      const double nearer = std::min(d, last_depth);
      const double jump = d < last_depth ? last_depth - d : d - last_depth;
      if (jump > kJumpSigmas * noise.sigma(nearer) * (i - last_index)) {
        if (better(current, best)) best = current;
        current = Surface{};
      }
    }
    if (current.readings == 0) ++surfaces;
    ++current.readings;
    current.at_end = current.at_end || i == 0 || i == n - 1;
    const int offset = i < middle ? middle - i : i - middle;
    if (offset < current.nearest_offset) {
      current.nearest_offset = offset;
      current.depth_m = d;
    }
    last_index = i;
    last_depth = d;
  }
  if (surfaces == 0) return {};
  if (better(current, best)) best = current;
  return {static_cast<double>(best.depth_m), surfaces > 1 || best.nearest_offset > 0};
}

int sample_count(const Segment& segment, const SampleOptions& options) {
  const double length = segment.length_px();
  if (!(length >= 2)) return 0;
  const double spaced = std::max(length / options.spacing_px, std::min<double>(length, kEnoughSamples));
  return spaced >= kMaxLineSamples ? kMaxLineSamples : static_cast<int>(spaced);
}

}  // namespace plvo

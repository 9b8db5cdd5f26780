// SPDX-License-Identifier: Apache-2.0
// Box L2 of the paper: evenly spaced samples on a segment, each with its depth and the standard deviation of
// that depth, equation (2). The paper's n_s = min(100, floor(length)) is one per pixel; here there may be
// fewer. Assumes ideal pinhole pixels.
//
// Occluding edges: a segment on the border of an object lies between two surfaces. A Kinect's depth image is
// displaced from the colour image by a pixel or more, so the reading at the segment may belong to either
// surface. The edge belongs to the nearer one. A sample therefore reads a short profile across the segment,
// splits it into surfaces at depth jumps, and takes the nearer surface's reading closest to the segment; see
// nearer_surface().
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "plvo/camera/depth_noise.hpp"
#include "plvo/image/depth_stretch.hpp"
#include "plvo/lines/segment.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

inline constexpr int kMaxLineSamples = 100;  // limit of n_s
inline constexpr int kMaxSideReach = 5;      // px

// A short segment gets at least this number of samples, whatever the spacing, but never more than one per
// pixel.
inline constexpr int kEnoughSamples = 20;

struct SampleOptions {
  double spacing_px = 1;
  int side_reach_px = 0;  // 0 … kMaxSideReach: reach of the profile to either side; 0: as in the paper
};

struct LineSample {
  double t_px = 0;       // along the segment, from its middle towards b
  double depth_m = 0;    // > 0
  double sigma_d_m = 0;  // > 0
};

// A hundred samples are 2.4 kB and fit on the stack.
struct LineSamples {
  std::array<LineSample, kMaxLineSamples> sample;  // by increasing t; only those with depth
  int count = 0;                                   // samples with depth
  int asked = 0;                                   // n_s
  std::span<const LineSample> with_depth() const { return {sample.data(), static_cast<std::size_t>(count)}; }
};

struct SurfaceReading {
  double depth_m = 0;  // 0: no depth
  bool mixed = false;  // the profile contains two surfaces, or one beside a gap
};

// Selects the depth of the nearer surface. profile: depths in metres (0: no depth) at -reach … +reach pixels
// across the segment, the middle one on it. A new surface begins where adjacent readings differ by more than
// kJumpSigmas standard deviations of the nearer one. With one surface, the result is its reading closest to
// the middle. With several, the candidates are those with two readings, or with one at the profile's end that
// may continue beyond it; the result is the nearest one's reading closest to the middle.
inline constexpr double kJumpSigmas = 6;
SurfaceReading nearer_surface(std::span<const float> profile, const DepthNoise& noise);

// Returns whether the ends and the middle of the profile belong to one surface. Most samples pass. (An
// object between them that is thinner than the reach is not detected.)
inline bool one_surface(double left, double here, double right, double sigma_here_m) {
  const double jump = kJumpSigmas * sigma_here_m;
  const double to_left = left - here;
  const double to_right = right - here;
  return left > 0 && here > 0 && right > 0 && to_left * to_left <= jump * jump &&
         to_right * to_right <= jump * jump;
}

// Factor on the standard deviation of a mixed sample, which may be read a few pixels beside the segment.
inline constexpr double kMixedInflation = 2;

// Returns n_s, or 0 for a segment shorter than 2 px.
int sample_count(const Segment& segment, const SampleOptions& options);

// Samples the depths of a segment. Where the pixel on the segment has no reading but readings of one surface
// surround it, their plane counts (DepthSampler::sample_between). On a slope across the segment, the
// registration error between colour and depth causes a depth error of slope · noise.registration_px, which is
// added to σ_d in quadrature. depth: a DepthSampler, or in tests a type with its own Stretch.
template <typename Depth>
void sample_segment(const Segment& segment, const DepthNoise& noise, const SampleOptions& options,
                    const Depth& depth, LineSamples& out) {
  const int side_reach_px = options.side_reach_px;
  out.count = 0;
  out.asked = sample_count(segment, options);
  if (out.asked == 0) return;
  const double length = segment.length_px();
  const Vector2 along = segment.direction();
  const double step = length / (out.asked - 1);
  std::array<float, 2 * kMaxSideReach + 1> profile{};
  const std::span<const float> readings(profile.data(), static_cast<std::size_t>(2 * side_reach_px + 1));
  const double per_px = side_reach_px > 0 ? 0.5 / side_reach_px : 0;
  typename Depth::Stretch stretch(depth, segment.a, step * along, out.asked, Vector2(-along.y(), along.x()),
                                  side_reach_px);
  for (int i = 0; i < out.asked; ++i) {  // at most kMaxLineSamples
    if (!stretch.go_to(i)) continue;
    const double t = i * step - 0.5 * length;
    const double here = stretch.at(0);
    const double left = side_reach_px > 0 ? stretch.at(-side_reach_px) : here;
    const double right = side_reach_px > 0 ? stretch.at(side_reach_px) : here;
    const double sigma_here = noise.sigma(here);
    LineSample& sample = out.sample[static_cast<std::size_t>(out.count)];
    if (one_surface(left, here, right, sigma_here)) {
      const double misread = (right - left) * per_px * noise.registration_px;
      sample = {t, stretch.at_colour_time(here), sqrt(sigma_here * sigma_here + misread * misread)};
    } else if (const DepthSample between = here > 0 ? DepthSample{} : stretch.between();
               between.depth_m > 0) {
      sample = {t, stretch.at_colour_time(between.depth_m), between.sigma_m};
    } else {
      for (int o = -side_reach_px; o <= side_reach_px; ++o)
        profile[static_cast<std::size_t>(o + side_reach_px)] = static_cast<float>(stretch.at(o));
      const SurfaceReading reading = nearer_surface(readings, noise);
      if (!(reading.depth_m > 0)) continue;
      const double sigma = noise.sigma(reading.depth_m);
      sample = {t, stretch.at_colour_time(reading.depth_m), reading.mixed ? kMixedInflation * sigma : sigma};
    }
    ++out.count;
  }
}

}  // namespace plvo

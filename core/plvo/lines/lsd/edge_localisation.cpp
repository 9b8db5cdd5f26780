// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/lsd/edge_localisation.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "plvo/math/trigonometry.hpp"

namespace plvo::lsd {
namespace {

constexpr int kMaxProfiles = 32;
constexpr int kMinProfiles = 4;
constexpr int kReach = 3;  // pixels to either side in which the steepest position is searched
constexpr double kMaxShift_px = 1.5;
// Uncertainty of a peak's position even on a clean edge, because the parabola is not the true shape of the
// edge.
constexpr double kPeakFloor_px = 0.05;

// One profile: the offset of the edge from the segment along the profile, at position `along` of the major
// axis.
struct Peak {
  double along = 0;
  double offset = 0;
  double weight = 0;
};

// View of the image in which the segment runs along u, with a deviation below 45°; v is across.
struct Axes {
  const std::uint8_t* data = nullptr;
  std::ptrdiff_t step_u = 0;
  std::ptrdiff_t step_v = 0;
  int size_u = 0;
  int size_v = 0;
  int brighter = 1;  // sign of the change along v
};

bool find_peak(const Axes& axes, int u, double v, Peak& peak) {
  const int centre = static_cast<int>(v + 0.5);
  if (u < 1 || u > axes.size_u - 2 || centre < kReach + 1 || centre > axes.size_v - kReach - 2) return false;
  // Sums three adjacent pixels along the edge to reduce noise. A blur along the edge does not shift it
  // across.
  const std::uint8_t* const at = axes.data + u * axes.step_u + centre * axes.step_v;
  const auto sum = [&](int across) {
    const std::uint8_t* const middle = at + across * axes.step_v;
    return middle[-axes.step_u] + middle[0] + middle[axes.step_u];
  };
  const auto change = [&](int across) { return axes.brighter * (sum(across + 1) - sum(across - 1)); };
  // Climbs from the middle. A stronger edge behind a valley belongs to another segment.
  const int uphill = change(1) > change(-1) ? 1 : -1;
  int place = 0;
  int behind = change(-uphill), best = change(0), ahead = change(uphill);
  while (ahead > best) {
    place += uphill;
    if (place == kReach || place == -kReach) return false;
    behind = best;
    best = ahead;
    ahead = change(place + uphill);
  }
  if (best <= 0) return false;
  const int curvature = 2 * best - behind - ahead;
  if (curvature <= 0) return false;
  const double shift = 0.5 * (uphill * (ahead - behind)) / curvature;
  peak.along = u;
  peak.offset = centre + static_cast<double>(place) + shift - v;
  // The variance of a peak's position is proportional to noise² / curvature². The cap keeps one strong
  // profile from dominating.
  const double strength = std::min(curvature, 300);
  peak.weight = strength * strength;
  return true;
}

struct LineFit {
  double mean_along = 0;
  double offset = 0;  // at mean_along
  double slope = 0;
  double variance_offset = 0;
  double variance_slope = 0;
  double sd = 0;  // of one peak of mean weight
};

// Weighted least squares. Needs at least three peaks, not all at one position.
LineFit fit(std::span<const Peak> peaks) {
  double w = 0, wu = 0, wv = 0;
  for (const Peak& p : peaks) {
    w += p.weight;
    wu += p.weight * p.along;
    wv += p.weight * p.offset;
  }
  LineFit line;
  line.mean_along = wu / w;
  line.offset = wv / w;
  double suu = 0, suv = 0;
  for (const Peak& p : peaks) {
    const double u = p.along - line.mean_along;
    suu += p.weight * u * u;
    suv += p.weight * u * (p.offset - line.offset);
  }
  line.slope = suv / suu;
  double squares = 0;
  for (const Peak& p : peaks) {
    const double r = p.offset - line.offset - line.slope * (p.along - line.mean_along);
    squares += p.weight * r * r;
  }
  const auto n = static_cast<double>(peaks.size());
  const double mean_weight = w / n;
  const double variance = squares / mean_weight / (n - 2) + kPeakFloor_px * kPeakFloor_px;
  line.sd = sqrt(variance);
  line.variance_offset = variance / n;
  line.variance_slope = variance * mean_weight / suu;
  return line;
}

// Combines the fit with the prior, which is the previous position (offset and slope 0) with its uncertainty.
// A short or weak segment whose few profiles scatter stays near it.
void shrink_to_prior(double position_sd_px, double length_px, LineFit& line) {
  const double prior_offset = position_sd_px * position_sd_px;
  const double prior_slope = 4 * prior_offset / (length_px * length_px);
  const double keep_offset = prior_offset / (prior_offset + line.variance_offset);
  const double keep_slope = prior_slope / (prior_slope + line.variance_slope);
  line.offset *= keep_offset;
  line.slope *= keep_slope;
  line.variance_offset *= keep_offset;
  line.variance_slope *= keep_slope;
}

// Drops the peaks farther than 2.5 SD (at least half a pixel) from the line. Returns true if it dropped any.
bool drop_outliers(const LineFit& line, std::span<Peak>& peaks) {
  const double limit = std::max(2.5 * line.sd, 0.5);
  std::size_t kept = 0;
  for (const Peak& p : peaks) {
    const double r = p.offset - line.offset - line.slope * (p.along - line.mean_along);
    if (r <= limit && r >= -limit) peaks[kept++] = p;
  }
  const bool dropped = kept < peaks.size();
  peaks = peaks.first(kept);
  return dropped;
}

}  // namespace

bool localise(GrayView image, double position_sd_px, Segment& segment) {
  const Vector2 d = segment.b - segment.a;
  const double length = d.norm();
  segment.sigma_px = position_sd_px;
  segment.sigma_angle_rad = length > 0 ? 2 * position_sd_px / length : kPi / 4;
  const bool horizontal = (d.x() < 0 ? -d.x() : d.x()) >= (d.y() < 0 ? -d.y() : d.y());
  const int major = horizontal ? 0 : 1;
  // The normal (−dy, dx) points to the brighter side.
  const Axes axes = horizontal
                        ? Axes{image.data, 1, image.stride, image.width, image.height, d.x() > 0 ? 1 : -1}
                        : Axes{image.data, image.stride, 1, image.height, image.width, d.y() > 0 ? -1 : 1};
  const double du = d[major];
  const double slope = d[1 - major] / du;
  const int profiles = std::min(kMaxProfiles, static_cast<int>(du < 0 ? -du : du));
  if (profiles < kMinProfiles) return false;

  std::array<Peak, kMaxProfiles> storage{};
  std::size_t found = 0;
  for (int i = 0; i < profiles; ++i) {
    const double exact = segment.a[major] + du * (i + 0.5) / profiles;
    if (exact < 0) continue;
    const int u = static_cast<int>(exact + 0.5);
    const double v = segment.a[1 - major] + slope * (u - segment.a[major]);
    if (v < 0) continue;
    if (find_peak(axes, u, v, storage[found])) ++found;
  }
  std::span<Peak> peaks(storage.data(), found);
  const auto enough = [&] {
    return peaks.size() >= kMinProfiles && 2 * static_cast<int>(peaks.size()) >= profiles;
  };
  if (!enough()) return false;
  LineFit line = fit(peaks);
  for (int round = 0; round < 3 && drop_outliers(line, peaks); ++round) {
    if (!enough()) return false;
    line = fit(peaks);
  }
  // Profiles less than three pixels apart share some of their pixels, and therefore noise.
  const double shared = std::max(1.0, 3.0 * profiles / (du < 0 ? -du : du));
  line.variance_offset *= shared;
  line.variance_slope *= shared;
  shrink_to_prior(position_sd_px, length, line);
  const auto shift_at = [&](double u) { return line.offset + line.slope * (u - line.mean_along); };
  const double shift_a = shift_at(segment.a[major]);
  const double shift_b = shift_at(segment.b[major]);
  if (std::max(shift_a * shift_a, shift_b * shift_b) > kMaxShift_px * kMaxShift_px) return false;

  // The ends move to their feet on the new line.
  const double new_slope = slope + line.slope;
  const double v_mean = segment.a[1 - major] + slope * (line.mean_along - segment.a[major]) + line.offset;
  Vector2 middle = Vector2::Zero();
  Vector2 direction = Vector2::Zero();
  const double cosine = 1 / sqrt(1 + new_slope * new_slope);
  middle[major] = line.mean_along;
  middle[1 - major] = v_mean;
  direction[major] = cosine;
  direction[1 - major] = new_slope * cosine;
  segment.a = middle + direction * direction.dot(segment.a - middle);
  segment.b = middle + direction * direction.dot(segment.b - middle);
  const double centre = 0.5 * (segment.a[major] + segment.b[major]) - line.mean_along;
  segment.sigma_px = cosine * sqrt(line.variance_offset + centre * centre * line.variance_slope);
  segment.sigma_angle_rad = cosine * cosine * sqrt(line.variance_slope);
  return true;
}

}  // namespace plvo::lsd

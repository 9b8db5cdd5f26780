// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line_match.hpp"

#include <algorithm>
#include <limits>

#include "plvo/base/bits.hpp"
#include "plvo/base/simd.hpp"
#include "plvo/math/rounding.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

namespace {

constexpr std::uint16_t kNoLine = 0xffff;

LinePose pose_of(const Segment& segment) {
  const Vector2 m = segment.middle(), u = segment.direction();
  return {static_cast<float>(m.x()), static_cast<float>(m.y()), static_cast<float>(u.x()),
          static_cast<float>(u.y()), static_cast<float>(0.5 * segment.length_px())};
}

constexpr float kDirectionOne = 1 << 14;
// Fixed-point coordinate of a unit vector. A vector without direction may give any value, because it matches
// nothing.
std::int16_t fixed(float unit) {
  return unit > -1 ? unit < 1 ? round_to<std::int16_t>(unit * kDirectionOne) : 1 << 14 : -(1 << 14);
}

// Tests which of four current segments may have the direction of the predicted one. Nearly all fail, so it
// tests four at once. Rounding makes this gate slightly too wide; compatible() repeats the test exactly.
class AngleGate {
 public:
  AngleGate(const LinePose& predicted, float cos_angle)
      : least_(static_cast<std::int32_t>(cos_angle * (kDirectionOne * kDirectionOne)) - kRounding) {
    const std::int16_t x = fixed(predicted.ux), y = fixed(predicted.uy);
    direction_ = Int16x8{x, y, x, y, x, y, x, y};
  }
  unsigned passing(const std::int16_t* four) const {
    Int16x8 directions;
    load(four, directions);
    Int32x4 cosines;
    dot_pairs(directions, direction_, cosines);
    return ~negative_mask(cosines - least_) & 0xfU;
  }

 private:
  // Error bound: each of four numbers is rounded by ½, which changes the sum by at most √2 · 2^14.
  static constexpr std::int32_t kRounding = 1 << 15;
  Int16x8 direction_;
  std::int32_t least_;
};

struct Gates {
  float cos_angle, max_offset, min_overlap;
  float same_cos, same_offset;
};

// Returns whether the current segment lies within the gates around the predicted one.
bool compatible(const LinePose& p, const LinePose& c, const Gates& gates) {
  if (p.ux * c.ux + p.uy * c.uy < gates.cos_angle) return false;
  const float dx = c.x - p.x, dy = c.y - p.y;
  const float across = dy * p.ux - dx * p.uy;
  if (across > gates.max_offset || across < -gates.max_offset) return false;
  const float along = dx * p.ux + dy * p.uy;
  const float reach = p.half_length + c.half_length + gates.max_offset - (along < 0 ? -along : along);
  return reach >= gates.min_overlap * 2 * std::min(p.half_length, c.half_length);
}

// Returns whether both segments are fragments of one line.
bool same_line(const LinePose& a, const LinePose& b, const Gates& gates) {
  if (a.ux * b.ux + a.uy * b.uy < gates.same_cos) return false;
  const float dx = b.x - a.x, dy = b.y - a.y;
  const float across = dy * a.ux - dx * a.uy;
  return across <= gates.same_offset && across >= -gates.same_offset;
}

// Returns the best candidate of a reference segment, if it is near enough and no other line is about as near.
LineCandidate clear_best(std::span<const LineCandidate> candidates, std::span<const LinePose> current,
                         const Gates& gates, const LineMatchConfig& config) {
  LineCandidate best{kNoLine, config.max_distance + 1};
  for (const LineCandidate& c : candidates)
    if (c.distance < best.distance) best = c;  // the first among equal ones
  if (best.index == kNoLine) return best;
  const double limit = config.max_ratio * config.max_ratio;
  for (const LineCandidate& c : candidates) {
    if (best.distance < limit * c.distance || c.index == best.index) continue;
    if (!same_line(current[best.index], current[c.index], gates)) return {kNoLine, 0};
  }
  return best;
}

}  // namespace

Segment project_line(const Pinhole& pinhole, const Vector3& a, const Vector3& b) {
  constexpr double kNowhere_px = -1e5;
  Segment segment;
  if (a.z() > kNearestSeen_m && b.z() > kNearestSeen_m) {
    segment.a = project(pinhole, a);
    segment.b = project(pinhole, b);
  } else {
    segment.a = Vector2(kNowhere_px, kNowhere_px);
    segment.b = Vector2(kNowhere_px + 1, kNowhere_px);
  }
  return segment;
}

void match_lines(std::span<const Segment> predicted, std::span<const LineDescriptor> reference_descriptors,
                 std::span<const Segment> current, std::span<const LineDescriptor> current_descriptors,
                 const LineMatchConfig& config, Arena& memory, FixedVector<Match>& matches) {
  matches.clear();
  ScratchScope scope(memory);
  const LineMatchScratch scratch = take_line_match_scratch(memory, predicted.size(), current.size());
  if (memory.exhausted()) return;
  for (std::size_t j = 0; j < current.size(); ++j) {
    const LinePose pose = pose_of(current[j]);
    scratch.current[j] = pose;
    scratch.directions[2 * j] = fixed(pose.ux);
    scratch.directions[2 * j + 1] = fixed(pose.uy);
    scratch.best_of_current[j] = {kNoLine, std::numeric_limits<int>::max()};
  }
  std::fill(scratch.directions.begin() + static_cast<std::ptrdiff_t>(2 * current.size()),
            scratch.directions.end(), std::int16_t{0});
  const Gates gates{static_cast<float>(cos(config.max_angle_rad)), static_cast<float>(config.max_offset_px),
                    static_cast<float>(config.min_overlap), static_cast<float>(cos(config.same_line_rad)),
                    static_cast<float>(config.same_line_px)};

  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const LinePose pose = pose_of(predicted[i]);
    const AngleGate angle(pose, gates.cos_angle);
    std::size_t count = 0;
    const auto consider = [&](std::size_t j) {
      if (!compatible(pose, scratch.current[j], gates)) return;
      const int distance = descriptor_distance(reference_descriptors[i], current_descriptors[j]);
      scratch.candidates[count++] = {static_cast<std::uint16_t>(j), distance};
      LineCandidate& back = scratch.best_of_current[j];
      if (distance < back.distance) back = {static_cast<std::uint16_t>(i), distance};
    };
    for (std::size_t four = 0; four < current.size(); four += 4)
      for (unsigned rest = angle.passing(scratch.directions.data() + 2 * four); rest != 0; rest &= rest - 1)
        if (const std::size_t j = four + static_cast<std::size_t>(lowest_bit(rest)); j < current.size())
          consider(j);
    scratch.best_of_reference[i] =
        clear_best(scratch.candidates.first(count), scratch.current, gates, config).index;
  }
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const std::uint16_t j = scratch.best_of_reference[i];
    if (j != kNoLine && scratch.best_of_current[j].index == i)
      matches.push_back({static_cast<std::uint16_t>(i), j});
  }
}

}  // namespace plvo

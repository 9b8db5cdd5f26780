// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line_match.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>

#include "picture_scene.hpp"

namespace plvo {
namespace {

using test::PictureScene;
using test::ScenePicture;

struct View {
  std::vector<Segment> segments;
  std::vector<LineDescriptor> descriptors;
  std::vector<int> border;  // index of the scene's border
};

template <typename Light>
View see(const PictureScene& scene, const Matrix3& H, const Light& light, std::uint64_t seed) {
  View view;
  const ScenePicture picture = scene.render(H, light, 2, seed);
  Random random(seed + 100);
  const std::vector<Segment> borders = scene.borders(H);
  for (std::size_t k = 0; k < borders.size(); ++k) {
    Segment s = borders[k];
    if (s.length_px() < 12) continue;
    // The ends of a detected segment are not repeatable: up to a sixth is missing at each end.
    const Vector2 d = s.b - s.a;
    s.a += d * random.uniform() / 6;
    s.b -= d * random.uniform() / 6;
    view.segments.push_back(s);
    view.descriptors.push_back(describe_segment(picture.view(), 1, s));
    view.border.push_back(static_cast<int>(k));
  }
  return view;
}

struct MatchScore {
  int right = 0, wrong = 0, possible = 0;
};

class LineMatch : public ::testing::Test {
 protected:
  std::vector<Match> match(const View& reference, const View& current, const LineMatchConfig& config) {
    Arena arena(memory_);
    std::array<Match, 256> storage;
    FixedVector<Match> matches{storage};
    match_lines(reference.segments, reference.descriptors, current.segments, current.descriptors, config,
                arena, matches);
    return {matches.begin(), matches.end()};
  }
  void add(const View& reference, const View& current, const LineMatchConfig& config, MatchScore& score) {
    for (const Match& m : match(reference, current, config))
      ++(reference.border[m.reference] == current.border[m.current] ? score.right : score.wrong);
    for (const int k : reference.border)
      for (const int j : current.border) score.possible += k == j ? 1 : 0;
  }
  alignas(kArenaAlignment) std::array<std::byte, 1 << 16> memory_;
};

Matrix3 motion(Random& random) {
  const double angle = 0.08 * (random.uniform() - 0.5), scale = 1 + 0.06 * (random.uniform() - 0.5);
  Matrix3 H;
  H << scale * std::cos(angle), -scale * std::sin(angle), 24 * (random.uniform() - 0.5),  //
      scale * std::sin(angle), scale * std::cos(angle), 24 * (random.uniform() - 0.5),    //
      1e-4 * (random.uniform() - 0.5), 1e-4 * (random.uniform() - 0.5), 1;
  return H;
}

TEST_F(LineMatch, MatchesTheSameBordersAfterAMotion) {
  Random random(3);
  MatchScore constant, varying;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const PictureScene scene(seed);
    const Matrix3 H = motion(random);
    const View reference = see(scene, Matrix3::Identity(), test::as_it_is, seed);
    add(reference, see(scene, H, test::as_it_is, seed + 50), {}, constant);
    const auto dim = [](double g, int x, int y) { return g * (0.75 - x / 900.0 - y / 900.0); };
    add(reference, see(scene, H, dim, seed + 50), {}, varying);
  }
  for (const MatchScore& s : {constant, varying}) {
    EXPECT_GT(s.possible, 100);
    EXPECT_GT(s.right, 0.8 * s.possible);
    EXPECT_LT(s.wrong, 0.03 * s.right);
  }
  RecordProperty("constant_right", constant.right);
  RecordProperty("constant_wrong", constant.wrong);
  RecordProperty("constant_possible", constant.possible);
  RecordProperty("varying_right", varying.right);
  RecordProperty("varying_wrong", varying.wrong);
}

// The definition by brute force: every rule is applied to every pair.
std::vector<Match> brute_force(const View& r, const View& c, const LineMatchConfig& config) {
  const auto offset = [](const Segment& a, const Segment& b) {
    return std::abs((b.middle() - a.middle()).dot(a.normal()));
  };
  const auto allowed = [&](const Segment& a, const Segment& b) {
    const double along = std::abs((b.middle() - a.middle()).dot(a.direction()));
    const double overlap = 0.5 * (a.length_px() + b.length_px()) + config.max_offset_px - along;
    return a.direction().dot(b.direction()) >= std::cos(config.max_angle_rad) &&
           offset(a, b) <= config.max_offset_px &&
           overlap >= config.min_overlap * std::fmin(a.length_px(), b.length_px());
  };
  const auto distance = [&](std::size_t i, std::size_t j) {
    return allowed(r.segments[i], c.segments[j]) ? descriptor_distance(r.descriptors[i], c.descriptors[j])
                                                 : 1 << 30;
  };
  std::vector<Match> matches;
  for (std::size_t i = 0; i < r.segments.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t j = 0; j < c.segments.size(); ++j)
      if (distance(i, j) < distance(i, best)) best = j;
    bool good = distance(i, best) <= config.max_distance;
    for (std::size_t k = 0; k < i; ++k) good = good && distance(k, best) > distance(i, best);
    for (std::size_t k = i; k < r.segments.size(); ++k) good = good && distance(k, best) >= distance(i, best);
    for (std::size_t j = 0; j < c.segments.size(); ++j) {
      if (j == best || std::sqrt(distance(i, best)) < config.max_ratio * std::sqrt(distance(i, j))) continue;
      const Segment &a = c.segments[best], &b = c.segments[j];
      good = good && a.direction().dot(b.direction()) >= std::cos(config.same_line_rad) &&
             offset(a, b) <= config.same_line_px;
    }
    if (good) matches.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(best)});
  }
  return matches;
}

TEST_F(LineMatch, EqualsTheBruteForceResult) {
  Random random(5);
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    const PictureScene scene(seed, 24);
    const View reference = see(scene, Matrix3::Identity(), test::as_it_is, seed);
    const View current = see(scene, motion(random), test::as_it_is, seed + 1);
    for (const double ratio : {0.8, 1.0}) {
      LineMatchConfig config;
      config.max_ratio = ratio;
      const std::vector<Match> fast = match(reference, current, config);
      const std::vector<Match> slow = brute_force(reference, current, config);
      ASSERT_EQ(fast.size(), slow.size());
      for (std::size_t k = 0; k < fast.size(); ++k) {
        EXPECT_EQ(fast[k].reference, slow[k].reference);
        EXPECT_EQ(fast[k].current, slow[k].current);
      }
    }
  }
}

TEST_F(LineMatch, DoesNotMatchEdgesOfOppositeSign) {
  const PictureScene scene(2);
  View view = see(scene, Matrix3::Identity(), test::as_it_is, 1);
  View flipped = view;
  for (Segment& s : flipped.segments) std::swap(s.a, s.b);
  EXPECT_FALSE(match(view, view, {}).empty());
  LineMatchConfig config;
  config.max_offset_px = 3;
  EXPECT_TRUE(match(view, flipped, config).empty());
}

TEST_F(LineMatch, RatioTestIgnoresSegmentsOfTheSameLine) {
  const PictureScene scene(2);
  const View view = see(scene, Matrix3::Identity(), test::as_it_is, 1);
  View broken = view;
  // Every segment occurs twice. If its copy were a rival candidate, the ratio would be 1.
  broken.segments.insert(broken.segments.end(), view.segments.begin(), view.segments.end());
  broken.descriptors.insert(broken.descriptors.end(), view.descriptors.begin(), view.descriptors.end());
  EXPECT_EQ(match(view, broken, {}).size(), match(view, view, {}).size());
}

TEST_F(LineMatch, ReturnsNothingWithoutSegments) {
  const View empty;
  const PictureScene scene(2);
  const View view = see(scene, Matrix3::Identity(), test::as_it_is, 1);
  EXPECT_TRUE(match(empty, view, {}).empty());
  EXPECT_TRUE(match(view, empty, {}).empty());
}

}  // namespace
}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Tests the whole detector on images with known segments and on images without segments.
#include <gtest/gtest.h>

#include <cmath>

#include "line_picture.hpp"

namespace plvo {
namespace {

using test::DetectorRig;
using test::Picture;

constexpr double kDegree = kPi / 180;

struct TrueEdge {
  Vector2 a, b;  // the brighter side is on the right, like in Segment
};

struct Score {
  int edges = 0;
  int found = 0;
  int segments = 0;
  int explained = 0;
  double worst_angle_rad = 0;
  double angle_squares = 0;
  double offset_squares = 0;
  double end_squares = 0;
  double worst_end_px = 0;
  int ends = 0;

  double recall() const { return static_cast<double>(found) / edges; }
  double precision() const { return static_cast<double>(explained) / segments; }
  double rms_angle_rad() const { return std::sqrt(angle_squares / explained); }
  double rms_offset_px() const { return std::sqrt(offset_squares / explained); }
  double rms_end_px() const { return std::sqrt(end_squares / ends); }
};

// An edge explains a segment that runs along it in the same direction. An edge is found when its longest such
// segment covers 80 % of it.
void add_score(const std::vector<TrueEdge>& edges, const FixedVector<Segment>& segments, Score& score) {
  std::vector<double> covered(edges.size(), 0);
  std::vector<Vector2> ends(edges.size());
  for (const Segment& s : segments) {
    ++score.segments;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Vector2 d = (edges[i].b - edges[i].a).normalized();
      const Vector2 n(-d.y(), d.x());
      const double length = (edges[i].b - edges[i].a).norm();
      const double middle = d.dot(s.middle() - edges[i].a);
      const double offset = n.dot(s.middle() - edges[i].a);
      const double angle = std::asin(std::clamp(n.dot(s.direction()), -1.0, 1.0));
      if (d.dot(s.direction()) < 0.95 || std::abs(offset) > 2 || middle < 0 || middle > length) continue;
      ++score.explained;
      score.angle_squares += angle * angle;
      score.offset_squares += offset * offset;
      score.worst_angle_rad = std::max(score.worst_angle_rad, std::abs(angle));
      if (s.length_px() > covered[i]) {
        covered[i] = s.length_px();
        ends[i] = {d.dot(s.a - edges[i].a), d.dot(s.b - edges[i].b)};
      }
      break;
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    ++score.edges;
    if (covered[i] < 0.8 * (edges[i].b - edges[i].a).norm()) continue;
    ++score.found;
    score.ends += 2;
    score.end_squares += ends[i].squaredNorm();
    score.worst_end_px = std::max(score.worst_end_px, ends[i].cwiseAbs().maxCoeff());
  }
}

// The outline of a polygon. Its corners are clockwise as seen, so the inside is on the right of each edge.
std::vector<TrueEdge> outline(const std::vector<Vector2>& corners, bool bright_inside) {
  std::vector<TrueEdge> edges;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2 a = corners[i];
    const Vector2 b = corners[(i + 1) % corners.size()];
    edges.push_back(bright_inside ? TrueEdge{a, b} : TrueEdge{b, a});
  }
  return edges;
}

Score polygons(int sides, double contrast, double noise, std::uint64_t seed) {
  Score score;
  Random random(seed);
  DetectorRig rig(320, 240);
  for (int trial = 0; trial < 12; ++trial) {
    Picture picture(320, 240, 120 - contrast / 2);
    const Vector2 centre(160 + 10 * random.uniform(), 120 + 10 * random.uniform());
    const auto corners =
        test::regular_polygon(centre, sides, 95, trial * 7.5 * kDegree + 0.01 * random.uniform());
    test::fill_polygon(picture, corners, 120 + contrast / 2);
    add_score(outline(corners, contrast > 0), rig.detect(test::expose(picture, noise, random)), score);
  }
  return score;
}

TEST(SegmentDetector, FindsRectanglesAtAllAngles) {
  for (const double contrast : {150.0, -150.0, 40.0, -40.0}) {
    const Score score = polygons(4, contrast, 0, 1);
    EXPECT_EQ(score.found, score.edges) << contrast;
    EXPECT_EQ(score.explained, score.segments) << contrast;
    EXPECT_LT(score.rms_angle_rad(), 0.05 * kDegree) << contrast;
    EXPECT_LT(score.rms_offset_px(), 0.05) << contrast;
    EXPECT_LT(score.rms_end_px(), 2.0) << contrast;
    EXPECT_LT(score.worst_end_px, 4.0) << contrast;
    RecordProperty("end_px", std::to_string(score.rms_end_px()));
    std::printf("contrast %.0f: angle %.3f deg, offset %.3f px, end %.2f (worst %.2f) px\n", contrast,
                score.rms_angle_rad() / kDegree, score.rms_offset_px(), score.rms_end_px(),
                score.worst_end_px);
  }
}

TEST(SegmentDetector, FindsPolygonsUnderNoise) {
  struct Case {
    int sides;
    double contrast, noise, recall, precision, angle_deg, offset_px;
  };
  const Case cases[] = {
      {4, 100, 3, 0.98, 0.98, 0.1, 0.10}, {4, 100, 8, 0.95, 0.95, 0.2, 0.15},
      {4, 30, 3, 0.9, 0.95, 0.2, 0.2},    {4, 16, 2, 0.7, 0.9, 0.4, 0.3},
      {3, 60, 4, 0.9, 0.95, 0.2, 0.15},   {6, 60, 4, 0.95, 0.95, 0.3, 0.15},
      {9, 60, 4, 0.9, 0.9, 0.5, 0.2},
  };
  for (const Case& c : cases) {
    const Score score = polygons(c.sides, c.contrast, c.noise, 7);
    EXPECT_GE(score.recall(), c.recall)
        << c.sides << " sides, contrast " << c.contrast << ", noise " << c.noise;
    EXPECT_GE(score.precision(), c.precision)
        << c.sides << " sides, contrast " << c.contrast << ", noise " << c.noise;
    EXPECT_LE(score.rms_angle_rad(), c.angle_deg * kDegree) << c.sides << " " << c.contrast << " " << c.noise;
    EXPECT_LE(score.rms_offset_px(), c.offset_px) << c.sides << " " << c.contrast << " " << c.noise;
    std::printf(
        "%d sides, contrast %.0f, noise %.0f: recall %.3f precision %.3f angle %.3f deg offset %.3f px end "
        "%.2f px\n",
        c.sides, c.contrast, c.noise, score.recall(), score.precision(), score.rms_angle_rad() / kDegree,
        score.rms_offset_px(), score.rms_end_px());
  }
}

// The a-contrario test promises at most one false segment per image of noise, on average.
TEST(SegmentDetector, FindsNothingInNoise) {
  Random random(3);
  DetectorRig rig(640, 480);
  for (const bool gaussian : {true, false}) {
    for (const double sd : {2.0, 5.0, 12.0, 30.0, 60.0}) {
      std::size_t segments = 0;
      constexpr int kImages = 4;
      for (int image = 0; image < kImages; ++image) {
        Picture picture(640, 480, 128);
        if (!gaussian) {
          for (double& level : picture.light) level += sd * std::sqrt(12.0) * (random.uniform() - 0.5);
        }
        segments += rig.detect(test::expose(picture, gaussian ? sd : 0, random)).size();
      }
      EXPECT_LE(segments, kImages) << (gaussian ? "Gaussian " : "uniform ") << sd;
      std::printf("%s %.0f: %.2f false segments an image\n", gaussian ? "Gaussian" : "uniform", sd,
                  static_cast<double>(segments) / kImages);
    }
  }
}

}  // namespace
}  // namespace plvo

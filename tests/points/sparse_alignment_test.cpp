// SPDX-License-Identifier: Apache-2.0
// Aligns two views of a textured wall and floor, taken before and after a known motion and under different
// light.
#include "plvo/points/sparse_alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dense.hpp"
#include "gray_image.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/points/descriptor.hpp"
#include "texture.hpp"

namespace plvo {
namespace {

constexpr int kPlanesWidth = 320;
constexpr int kPlanesHeight = 240;
const Pinhole kPinhole{.fx = 260, .fy = 262, .cx = 159.3, .cy = 121.1};

struct Light {
  double gain = 1, offset = 0;
};

// The point where the ray of a camera at T_camera_reference meets the nearer plane, in the reference frame.
Vector3 seen_point(const Se3& T_reference_camera, double u, double v) {
  const Vector3 ray = T_reference_camera.R * back_project(kPinhole, u, v, 1);
  const Vector3& o = T_reference_camera.t;
  const auto distance = [&](const Vector3& n, double d) { return (d - n.dot(o)) / n.dot(ray); };
  const double wall = distance({-0.3, 0, 1}, 2.5);
  const double floor = distance({0, 1, 0}, 0.6);
  return o + (floor > 0 && floor < wall ? floor : wall) * ray;
}

void render(const test::Texture& texture, const Se3& T_camera_reference, const Light& light,
            const ImageView<std::uint8_t>& image) {
  const Se3 T_reference_camera = T_camera_reference.inverse();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vector3 p = seen_point(T_reference_camera, x, y);
      const double grey = std::clamp(texture(90 * p.x() + 500, 90 * (p.y() + p.z()) + 500), 0.0, 255.0);
      image.at(x, y) = test::GrayImage::to_byte(light.gain * grey + light.offset);
    }
}

// The features of the reference, two pyramids, and storage for windows.
class SparseAlignmentTest : public testing::Test {
 protected:
  SparseAlignmentTest() : memory_(std::size_t{1} << 21), capacity_(kMostAlignmentWindows) {
    arena_ = Arena(memory_);
    reference_.allocate(arena_, kPlanesWidth, kPlanesHeight);
    current_.allocate(arena_, kPlanesWidth, kPlanesHeight);
    alignment_.allocate(arena_, kPlanesWidth, kPlanesHeight);
    features_.allocate(arena_, 300);
    arena_.seal();
    reference_.init(kPlanesWidth, kPlanesHeight);
    current_.init(kPlanesWidth, kPlanesHeight);
    render(texture_, {}, {}, reference_.base());
    reference_.build();
    alignment_.keep(reference_, 5);
    for (int y = 18; y < kPlanesHeight - 18; y += 15)
      for (int x = 18; x < kPlanesWidth - 18; x += 16) {
        const auto i = features_.keypoints.size();
        Keypoint keypoint;
        keypoint.x = static_cast<std::int16_t>(x);
        keypoint.y = static_cast<std::int16_t>(y);
        keypoint.u = static_cast<float>(x) + 0.3f;
        keypoint.v = static_cast<float>(y) - 0.2f;
        if (!features_.keypoints.push_back(keypoint)) break;
        features_.patches[i] = cut_patch(reference_.level(0), x, y);
        features_.points[i].p =
            seen_point({}, static_cast<double>(keypoint.u), static_cast<double>(keypoint.v));
      }
  }

  void see(const Se3& T_current_reference, const Light& light, std::uint64_t texture = 7) {
    render(test::Texture(texture, 40), T_current_reference, light, current_.base());
    current_.build();
  }
  bool align(std::span<const AlignmentWindow> windows, int steps, Se3& T, AlignmentStep& step) const {
    for (int i = 0; i < steps; ++i)
      if (!align_step(windows, features_.points, kPinhole, {}, current_, T, step)) return false;
    return true;
  }
  // The largest reprojection error of a keypoint at T, in pixels.
  double worst_px(const Se3& T, const Se3& truth) const {
    double worst = 0;
    for (std::size_t i = 0; i < features_.keypoints.size(); ++i) {
      const Vector3& p = features_.points[i].p;
      worst = std::max(worst, (project(kPinhole, T * p) - project(kPinhole, truth * p)).norm());
    }
    return worst;
  }

  std::vector<std::byte> memory_;
  Arena arena_;
  test::Texture texture_{7, 40};
  Pyramid reference_, current_;
  SparseAlignment alignment_;
  PointFeatures features_;
  std::vector<AlignmentWindow> capacity_;
};

const Vector6 kMotion = (Vector6() << 0.03, -0.02, 0.04, 0.01, -0.035, 0.012).finished();

TEST_F(SparseAlignmentTest, RecoversMotionsOfTenPixelsUnderAnotherLight) {
  const Se3 truth = boxplus({}, kMotion);
  for (const Light& light : {Light{}, Light{0.6, 30}, Light{1.3, -25}}) {
    see(truth, light);
    Se3 T;
    AlignmentStep step;
    EXPECT_GT(worst_px(T, truth), 10);
    ASSERT_TRUE(align(alignment_.cut_coarse(features_, capacity_), 8, T, step));
    EXPECT_TRUE(step.trusted()) << step.agreeing << " of " << step.seen;
    EXPECT_LT(worst_px(T, truth), 0.7);
    ASSERT_TRUE(align(SparseAlignment::cut_fine(features_, capacity_), 2, T, step));
    EXPECT_LT(worst_px(T, truth), 0.12) << "gain " << light.gain;
  }
}

// Another scene, a flat image, and keypoints without depth must not be trusted.
TEST_F(SparseAlignmentTest, IsNotTrustedWithoutMatchingImageTextureOrDepth) {
  see({}, {}, 8);
  Se3 T;
  AlignmentStep step;
  const std::span<const AlignmentWindow> windows = alignment_.cut_coarse(features_, capacity_);
  ASSERT_GT(windows.size(), 50u);
  EXPECT_FALSE(align(windows, 8, T, step) && step.trusted());

  see({}, {0, 90});
  EXPECT_FALSE(align(windows, 1, T, step));
  alignment_.keep(current_, 6);
  EXPECT_TRUE(alignment_.cut_coarse(features_, capacity_).empty());

  see({}, {});
  for (Point3d& point : features_.points) point.p.setZero();
  const Se3 before = T;
  EXPECT_FALSE(align(windows, 1, T, step));
  EXPECT_EQ(step.seen, 0);
  EXPECT_TRUE(T.t == before.t && T.R == before.R);
}

TEST_F(SparseAlignmentTest, HoldsReturnsTrueForTheKeptFrameOnly) {
  EXPECT_FALSE(SparseAlignment().holds(0));
  EXPECT_TRUE(alignment_.holds(5));
  alignment_.keep(current_, 6);
  EXPECT_FALSE(alignment_.holds(5));
  EXPECT_TRUE(alignment_.holds(6));
}

TEST_F(SparseAlignmentTest, SpreadsItsWindowsOverAllKeypoints) {
  ASSERT_GT(features_.keypoints.size(), kMostAlignmentWindows);
  const std::span<const AlignmentWindow> windows = alignment_.cut_coarse(features_, capacity_);
  ASSERT_FALSE(windows.empty());
  // The keypoints of the first and the last row lie at the border.
  EXPECT_LT(windows.front().keypoint, 40u);
  EXPECT_GT(windows.back().keypoint, features_.keypoints.size() - 40);
}

// Every keypoint has a window here, so the capacity limits the number of windows.
TEST_F(SparseAlignmentTest, FillsItsCapacityAndWritesNothingBeyond) {
  const std::size_t keypoints = features_.keypoints.size();
  for (std::size_t i = 0; i < keypoints; ++i) {
    features_.keypoints[i] = features_.keypoints[keypoints / 2];
    features_.patches[i] = features_.patches[keypoints / 2];
  }
  constexpr std::size_t kUntouched = 1 << 20;
  for (std::size_t capacity = 0; capacity < kMostAlignmentWindows; ++capacity) {
    capacity_[capacity].keypoint = kUntouched;
    const auto windows = SparseAlignment::cut_fine(features_, std::span(capacity_).first(capacity));
    ASSERT_LE(windows.size(), capacity);
    ASSERT_GE(2 * windows.size(), capacity);
    ASSERT_EQ(capacity_[capacity].keypoint, kUntouched) << capacity;
  }
}

// The step in double precision, window by window. Values are centred, the gain comes from regression, its
// direction is projected out of the gradients, and the projection is differentiated numerically.
Vector6 reference_step(std::span<const AlignmentWindow> windows, const PointFeatures& features,
                       const Pyramid& from, const Pyramid& to, const Se3& T) {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  for (const AlignmentWindow& window : windows) {
    const double scale = 1 << window.level;
    const Keypoint& keypoint = features.keypoints[window.keypoint];
    const Vector3& p = features.points[window.keypoint].p;
    const Vector2 in_reference =
        Vector2(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v)) / scale;
    const Vector2 whole(std::floor(in_reference.x() + 0.5), std::floor(in_reference.y() + 0.5));
    const Vector2 expected = project(kPinhole, T * p) / scale - (in_reference - whole);
    const Vector2 read_at(std::floor(expected.x() * 16 + 0.5) / 16, std::floor(expected.y() * 16 + 0.5) / 16);
    const GrayView before = from.level(window.level);
    const GrayView now = to.level(window.level);
    const auto grey = [](GrayView image, double x, double y) {
      const int ix = static_cast<int>(x), iy = static_cast<int>(y);
      const double fx = x - ix, fy = y - iy;
      return (1 - fy) * ((1 - fx) * image.at(ix, iy) + fx * image.at(ix + 1, iy)) +
             fy * ((1 - fx) * image.at(ix, iy + 1) + fx * image.at(ix + 1, iy + 1));
    };
    test::Dense gradient(64, 2), value(64, 1), read(64, 1);
    for (int k = 0; k < 64; ++k) {
      const double dx = k % 8 - 4, dy = k / 8 - 4;
      const double x = whole.x() + dx, y = whole.y() + dy;
      gradient(k, 0) = (grey(before, x + 1, y) - grey(before, x - 1, y)) / 2;
      gradient(k, 1) = (grey(before, x, y + 1) - grey(before, x, y - 1)) / 2;
      value(k, 0) = grey(before, x, y);
      read(k, 0) = grey(now, read_at.x() + dx, read_at.y() + dy);
    }
    const auto centred = [](const test::Dense& a) -> test::Dense { return a.rowwise() - a.colwise().mean(); };
    const test::Dense G = centred(gradient), V = centred(value), I = centred(read);
    const double contrast = V.squaredNorm();
    const double gain = (V.transpose() * I)(0, 0) / contrast;
    if (!(gain > 0.3 && gain < 3)) continue;
    const Vector2 with_value = G.transpose() * V;
    const Matrix2 information = G.transpose() * G - with_value * with_value.transpose() / contrast;
    const Vector2 shift_weighted = G.transpose() * I / gain - with_value;
    const double residual = (I / gain - V).squaredNorm();
    const double share = residual / contrast;
    const double weight = 1 / ((residual / 62 + 4) * (1 + 100 * share * share));
    Matrix<2, 6> J;
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 6; ++k)
      J.col(k) = (project(kPinhole, boxplus(T, kStep * Vector6::Unit(k)) * p) -
                  project(kPinhole, boxplus(T, -kStep * Vector6::Unit(k)) * p)) /
                 (2 * kStep * scale);
    H += weight * J.transpose() * information * J;
    g += weight * J.transpose() * (information * (read_at - expected) - shift_weighted);
  }
  return test::solve_positive(H, g);
}

TEST_F(SparseAlignmentTest, StepEqualsThatOfTheReference) {
  const Se3 truth = boxplus({}, 0.3 * kMotion);
  see(truth, {0.8, 20});
  for (const bool fine : {false, true}) {
    const std::span<const AlignmentWindow> windows =
        fine ? SparseAlignment::cut_fine(features_, capacity_) : alignment_.cut_coarse(features_, capacity_);
    const Se3 start = fine ? boxplus(truth, 0.05 * kMotion) : Se3{};
    Se3 T = start;
    AlignmentStep step;
    ASSERT_TRUE(align(windows, 1, T, step));
    const Vector6 slow = reference_step(windows, features_, reference_, current_, start);
    const Vector6 fast = boxminus(T, start);
    // The difference is due to grey levels in eighths and to damping by a millionth.
    EXPECT_LT((fast - slow).norm(), 0.01 * slow.norm()) << fast.transpose() << "\n" << slow.transpose();
    EXPECT_NEAR(step.size, fast.cwiseAbs().maxCoeff(), 1e-9);
  }
}

}  // namespace
}  // namespace plvo

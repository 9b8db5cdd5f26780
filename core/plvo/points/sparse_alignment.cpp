// SPDX-License-Identifier: Apache-2.0
#include "plvo/points/sparse_alignment.hpp"

#include <algorithm>

#include "plvo/base/simd.hpp"
#include "plvo/math/cholesky.hpp"

namespace plvo {
namespace {

constexpr int kAlignmentReach = kAlignmentSide / 2;
constexpr double kUnits = 8;  // units per grey level
// Standard deviation of the noise of a grey level. A window with a smaller standard deviation has no usable
// texture.
constexpr double kGreyNoise = 2;
// Residual, as a share of the window's contrast, that halves its weight.
constexpr double kAlike = 0.1;
constexpr double kLeastGain = 0.3;
constexpr double kMostGain = 3;
// Reach of a window and of the pixels beside it that give its gradients, or between which it is read.
constexpr int kReadReach = kAlignmentReach + 1;
constexpr int kReadBits = 4;  // positions are read on a grid of 1/16 px

using Numbers = std::array<std::int16_t, kAlignmentPixels>;

std::int32_t sum_of(const Numbers& a) {
  std::int32_t sum = 0;
  for (const std::int16_t value : a) sum += value;
  return sum;
}

// At most 64 · 2040²: below 2^31.
std::int32_t dot(const Numbers& a, const Numbers& b) {
  std::int32_t sum = 0;
  for (std::size_t k = 0; k < kAlignmentPixels; ++k) sum += a[k] * b[k];
  return sum;
}

// Σ a b with the means removed.
double about_means(const Numbers& a, double sum_a, const Numbers& b, double sum_b) {
  return dot(a, b) - sum_a * sum_b / kAlignmentPixels;
}

// Returns false for a window without texture.
bool make_window(GrayView image, int x, int y, AlignmentWindow& window) {
  constexpr std::int16_t kEighths = static_cast<std::int16_t>(kUnits);
  for (int row = 0; row < kAlignmentSide; ++row) {
    const std::uint8_t* p = image.row(y - kAlignmentReach + row) + x - kAlignmentReach;
    Int16x8 here, left, right, above, below;
    load_bytes(p, here);
    load_bytes(p - 1, left);
    load_bytes(p + 1, right);
    load_bytes(p - image.stride, above);
    load_bytes(p + image.stride, below);
    const auto first = static_cast<std::size_t>(row * kAlignmentSide);
    store(here * kEighths, &window.value[first]);
    store((right - left) * std::int16_t{kEighths / 2}, &window.gx[first]);
    store((below - above) * std::int16_t{kEighths / 2}, &window.gy[first]);
  }
  window.sum_value = sum_of(window.value);
  window.sum_gx = sum_of(window.gx);
  window.sum_gy = sum_of(window.gy);
  window.contrast = about_means(window.value, window.sum_value, window.value, window.sum_value);
  if (!(window.contrast > kAlignmentPixels * kUnits * kUnits * kGreyNoise * kGreyNoise)) return false;
  window.with_gain << about_means(window.gx, window.sum_gx, window.value, window.sum_value),
      about_means(window.gy, window.sum_gy, window.value, window.sum_value);
  const double xy = about_means(window.gx, window.sum_gx, window.gy, window.sum_gy);
  window.information << about_means(window.gx, window.sum_gx, window.gx, window.sum_gx), xy, xy,
      about_means(window.gy, window.sum_gy, window.gy, window.sum_gy);
  window.information -= window.with_gain * window.with_gain.transpose() / window.contrast;
  return true;
}

// (x, y): position of the window's whole pixel, in 1/16 px. Interpolates bilinearly, in 1/8 of a grey level;
// no product exceeds 2^15.
void read_window(GrayView image, int x, int y, Numbers& values) {
  constexpr int kOne = 1 << kReadBits;
  const auto fx = static_cast<std::int16_t>(x & (kOne - 1));
  const auto fy = static_cast<std::int16_t>(y & (kOne - 1));
  const auto rest = static_cast<std::int16_t>(kOne - fx);
  const std::uint8_t* p = image.row((y >> kReadBits) - kAlignmentReach) + (x >> kReadBits) - kAlignmentReach;
  Int16x8 above = {};
  for (int row = 0; row <= kAlignmentSide; ++row, p += image.stride) {
    Int16x8 left, right;
    load_bytes(p, left);
    load_bytes(p + 1, right);
    const Int16x8 across = (left * rest + right * fx + std::int16_t{1}) >> 1;
    if (row > 0)
      store(above + (((across - above) * fy + std::int16_t{kOne / 2}) >> kReadBits),
            &values[static_cast<std::size_t>((row - 1) * kAlignmentSide)]);
    above = across;
  }
}

// The displacement between the values that were read and the window, with its weight.
struct Displacement {
  Vector2 weighted;  // information · displacement, px of the level
  double weight = 0;
  bool agrees = false;
};

Displacement displacement(const AlignmentWindow& window, const Numbers& values) {
  Displacement result;
  const double sum = sum_of(values);
  const double gain = about_means(values, sum, window.value, window.sum_value) / window.contrast;
  if (!(gain > kLeastGain && gain < kMostGain)) return result;
  const Vector2 with_gradients(about_means(values, sum, window.gx, window.sum_gx),
                               about_means(values, sum, window.gy, window.sum_gy));
  result.weighted = with_gradients / gain - window.with_gain;
  const double residual = about_means(values, sum, values, sum) / (gain * gain) - window.contrast;
  const double share = residual / window.contrast;
  const double variance = residual / (kAlignmentPixels - 2) + kUnits * kUnits * kGreyNoise * kGreyNoise;
  result.weight = 1 / (variance * (1 + share * share / (kAlike * kAlike)));
  result.agrees = share < kAlike;
  return result;
}

// Position on a level, in px of that level.
Vector2 position(const Keypoint& keypoint, int level) {
  return Vector2(static_cast<double>(keypoint.u), static_cast<double>(keypoint.v)) / (1 << level);
}

// make(i, window) returns whether keypoint i has a window.
template <typename Make>
std::span<AlignmentWindow> cut(const PointFeatures& features, std::span<AlignmentWindow> capacity,
                               const Make& make) {
  std::size_t count = 0;
  const std::size_t keypoints = capacity.empty() ? 0 : features.keypoints.size();
  const std::size_t step = capacity.empty() ? 1 : (keypoints + capacity.size() - 1) / capacity.size();
  for (std::size_t i = 0; i < keypoints; i += step) {
    if (!make(i, capacity[count])) continue;
    capacity[count].keypoint = i;
    ++count;
  }
  return capacity.first(count);
}

}  // namespace

void SparseAlignment::keep(const Pyramid& pyramid, std::int64_t stamp_ns) {
  const GrayView level = pyramid.level(kLevel);
  const ImageView<std::uint8_t> copy{storage_.data(), level.width, level.height, level.width};
  for (int y = 0; y < level.height; ++y) std::copy_n(level.row(y), level.width, copy.row(y));
  image_ = copy;
  stamp_ns_ = stamp_ns;
}

std::span<AlignmentWindow> SparseAlignment::cut_coarse(const PointFeatures& features,
                                                       std::span<AlignmentWindow> capacity,
                                                       const ImageMask& mask) const {
  return cut(features, capacity, [&](std::size_t i, AlignmentWindow& window) {
    const Vector2 at = position(features.keypoints[i], kLevel);
    const int x = static_cast<int>(at.x() + 0.5);
    const int y = static_cast<int>(at.y() + 0.5);
    if (!mask.is_free(x << kLevel, y << kLevel, reach_on_base(kLevel, kReadReach))) return false;
    window.level = kLevel;
    window.centre = at - Vector2(x, y);
    return x > kAlignmentReach && y > kAlignmentReach && x < image_.width - kAlignmentReach &&
           y < image_.height - kAlignmentReach && make_window(image_, x, y, window);
  });
}

std::span<AlignmentWindow> SparseAlignment::cut_fine(const PointFeatures& features,
                                                     std::span<AlignmentWindow> capacity) {
  static_assert(kPatchRadius > kAlignmentReach);
  return cut(features, capacity, [&](std::size_t i, AlignmentWindow& window) {
    const Keypoint& keypoint = features.keypoints[i];
    const GrayView patch{features.patches[i].data(), kPatchSide, kPatchSide, kPatchSide};
    window.level = keypoint.level;
    window.centre = position(keypoint, keypoint.level) - Vector2(keypoint.x, keypoint.y);
    return make_window(patch, kPatchRadius, kPatchRadius, window);
  });
}

bool align_step(std::span<const AlignmentWindow> windows, std::span<const Point3d> points,
                const Pinhole& pinhole, const Exposure& exposure, const Pyramid& pyramid,
                Se3& T_current_reference, AlignmentStep& step, const ImageMask& mask) {
  const Se3& T = T_current_reference;
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  step = {};
  for (const AlignmentWindow& window : windows) {
    const Vector3& p = points[window.keypoint].p;
    if (!(p.z() > 0)) continue;
    const Vector3 turned = T.R * p;
    const Vector3 q = turned + T.t;
    if (!(q.z() > kNearestSeen_m)) continue;
    const GrayView image = pyramid.level(window.level);
    const double scale = 1.0 / (1 << window.level);
    const Vector2 expected = scale * project(pinhole, exposure.as_seen(q)) - window.centre;
    if (!(expected.x() >= kAlignmentReach && expected.y() >= kAlignmentReach &&
          expected.x() < image.width - kAlignmentReach - 1 &&
          expected.y() < image.height - kAlignmentReach - 1))
      continue;
    if (!mask.is_free(static_cast<int>(expected.x() + 0.5) << window.level,
                      static_cast<int>(expected.y() + 0.5) << window.level,
                      reach_on_base(window.level, kReadReach)))
      continue;
    ++step.seen;
    constexpr double kGrid = 1 << kReadBits;
    const int x = static_cast<int>(expected.x() * kGrid + 0.5);
    const int y = static_cast<int>(expected.y() * kGrid + 0.5);
    Numbers values;
    read_window(image, x, y, values);
    const Displacement found = displacement(window, values);
    if (found.agrees) ++step.agreeing;
    if (!(found.weight > 0)) continue;
    // Desired shift from the expected position, times the information: the offset of the grid position minus
    // the displacement measured there.
    const Vector2 grid = Vector2(x, y) / kGrid - expected;
    const Vector2 wanted = window.information * grid - found.weighted;
    const Matrix<2, 3> D = scale * project_derivative(pinhole, q);
    Matrix<2, 6> J;
    J.block<2, 3>(0, 0) = D;
    J.block<2, 3>(0, 3) = -D * skew(turned);
    const Matrix<2, 6> weighted = found.weight * (window.information * J);
    H += J.transpose().lazyProduct(weighted);
    g += found.weight * (J.transpose() * wanted);
  }
  // A few windows do not determine the motion. In directions that the windows leave open, the damping keeps
  // the prediction.
  constexpr int kLeastSeenWindows = 6;
  constexpr double kDamping = 1e-6;
  for (int k = 0; k < 6; ++k) H(k, k) *= 1 + kDamping;
  Cholesky<6> cholesky;
  if (step.seen < kLeastSeenWindows || !cholesky.factor(H)) return false;
  const Vector6 delta = cholesky.solve(g);
  step.size = delta.cwiseAbs().maxCoeff();
  T_current_reference = boxplus(T, delta);
  return true;
}

}  // namespace plvo

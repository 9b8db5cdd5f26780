// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/tracking/noise_learning.hpp"

#include <algorithm>

#include "plvo/base/build.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/base/heap_sort.hpp"

namespace plvo {
namespace {

// Medians of χ²(1), χ²(2), χ²(4).
constexpr double kMedian1 = 0.4549;
constexpr double kMedian2 = 1.3863;
constexpr double kMedian4 = 3.3567;
// Squared distances, in the model's SDs, beyond which a residual is a wrong match rather than noise. RANSAC
// takes residuals within the 99 % quantile of χ² as inliers: 11.34 for the three degrees of freedom of a
// point, 13.28 for the four of a line. Noise with twice the SD of the models must stay observable, so the
// bounds here are four times these. A surface sample has one degree of freedom. Its residual is large only
// until the scale is learnt, so it has the bound of points, 6.7 SDs.
constexpr double kFarthestPoint = 45;
constexpr double kFarthestLine = 53;
constexpr double kFarthestSurface = 45;
constexpr std::size_t kLeastMatches = 12;
// Bounds on the influence of one frame, and on the scales.
constexpr double kMostOfAFrame = 4;
constexpr double kLeastScale = 0.04;
// A rendered depth image has no smooth error.
constexpr double kLeastSharedScale = 0.0025;
// A surface sample is a mean of many readings, so its scale may be smaller.
constexpr double kLeastSurfaceScale = 0.0025;
constexpr double kMostScale = 25;

double median_over(FixedVector<double>& values, double expected) {
  if (values.size() < kLeastMatches) return 1;
  double* const middle = values.begin() + values.size() / 2;
  if constexpr (kSizeOptimised)
    heap_sort(values.begin(), values.end(), [](double a, double b) { return a < b; });
  else
    std::nth_element(values.begin(), middle, values.end());
  return *middle / expected;
}

// Squared normalised residuals of one point match: across the image, and along the ray.
struct PointResidual {
  double image = 0, depth = 0;
};

PointResidual residual_of(const Pinhole& pinhole, const Point3d& reference, const Point3d& current,
                          const Se3& T) {
  const Vector3 p = T * reference.p;
  const Matrix3 Sigma = T.R * reference.Sigma * T.R.transpose() + current.Sigma;
  const Matrix<2, 3> J = project_derivative(pinhole, p);
  const Matrix2 S = J * Sigma * J.transpose();
  const Vector2 e = project(pinhole, p) - project(pinhole, current.p);
  const double d = p.z() - current.p.z();
  const double determinant = S(0, 0) * S(1, 1) - S(0, 1) * S(0, 1);
  return {(e.x() * e.x() * S(1, 1) - 2 * e.x() * e.y() * S(0, 1) + e.y() * e.y() * S(0, 0)) / determinant,
          d * d / Sigma(2, 2)};
}

double step(double scale, double observed, double rate, double least = kLeastScale) {
  const double bounded = std::clamp(observed, 1 / kMostOfAFrame, kMostOfAFrame);
  return std::clamp(scale * (1 + rate * (bounded - 1)), least, kMostScale);
}

double mean_square(const NuisanceParameters& shared, const NuisanceEstimate& estimate, int first, int count) {
  const double sigma = shared.sigma(first);
  if (!(sigma > 0)) return 1;
  const double sum =
      estimate.value.segment(first, count).squaredNorm() + estimate.variance.segment(first, count).sum();
  return sum / (count * sigma * sigma);
}

}  // namespace

NoiseScales residual_scales(const Pinhole& pinhole, const PointConstraints& points,
                            const LineConstraints& lines, const Se3& T_current_reference, Arena& scratch) {
  const ScratchScope scope(scratch);
  FixedVector<double> image(scratch.take<double>("residuals", points.size()));
  FixedVector<double> depth(scratch.take<double>("residuals", points.size()));
  FixedVector<double> line(scratch.take<double>("residuals", lines.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points.usable(i) ||
        !(points.mahalanobis_squared(i, T_current_reference, kFarthestPoint) < kFarthestPoint))
      continue;
    const PointResidual residual =
        residual_of(pinhole, points.reference_point(i), points.current_point(i), T_current_reference);
    image.push_back(residual.image);
    depth.push_back(residual.depth);
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines.usable(i)) continue;
    const double s = lines.mahalanobis_squared(i, T_current_reference, kFarthestLine);
    if (s < kFarthestLine) line.push_back(s);
  }
  NoiseScales observed;
  observed.image = median_over(image, kMedian2);
  observed.depth = median_over(depth, kMedian1);
  observed.lines = median_over(line, kMedian4);
  return observed;
}

double surface_scale(const SurfaceConstraints& surfaces, const Se3& T_current_reference, Arena& scratch) {
  if (surfaces.size() == 0) return 1;
  const ScratchScope scope(scratch);
  FixedVector<double> residuals(scratch.take<double>("residuals", surfaces.size()));
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const double s = surfaces.mahalanobis_squared(i, T_current_reference);
    if (s < kFarthestSurface) residuals.push_back(s);
  }
  return median_over(residuals, kMedian1);
}

void note_nuisance(const NuisanceParameters& shared, const NuisanceEstimate& estimate,
                   NoiseScales& observed) {
  observed.angular_rate = mean_square(shared, estimate, 0, NuisanceField::kAngularRate);
  observed.shared_depth = mean_square(shared, estimate, NuisanceField::kAngularRate, NuisanceField::kDepth);
}

[[gnu::noinline]] NoiseScales initial_scales(const NoiseConfig& config) {
  constexpr double kOfPlanes = 0.25;
  NoiseScales scales;
  if (config.learning_rate > 0) scales.depth = scales.surfaces = kOfPlanes;
  return scales;
}

void learn(const NoiseConfig& config, const NoiseScales& observed, NoiseScales& scales) {
  scales.image = step(scales.image, observed.image, config.learning_rate);
  scales.depth = step(scales.depth, observed.depth, config.learning_rate);
  scales.lines = step(scales.lines, observed.lines, config.learning_rate);
  scales.surfaces = step(scales.surfaces, observed.surfaces, config.learning_rate, kLeastSurfaceScale);
  scales.angular_rate =
      step(scales.angular_rate, observed.angular_rate, config.learning_rate, kLeastSharedScale);
  scales.shared_depth =
      step(scales.shared_depth, observed.shared_depth, config.learning_rate, kLeastSharedScale);
}

}  // namespace plvo

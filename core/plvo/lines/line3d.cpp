// SPDX-License-Identifier: Apache-2.0
#include "plvo/lines/line3d.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "plvo/base/build.hpp"
#include "plvo/base/random.hpp"
#include "plvo/lines/plane_line.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/math/levenberg_marquardt.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {

namespace {

constexpr double kMinConsensus = 0.6;  // τ of the paper: smallest n_con / n_s
// Limit of two-sample lines; 16 find a consensus of 60 % with a probability of 99.9 %.
constexpr int kMaxRansacIterations = 20;

struct Samples {
  std::array<Whitened, kMaxLineSamples> all;
  std::array<bool, kMaxLineSamples> consensus{};
  int count = 0;
  std::span<const Whitened> span() const { return {all.data(), static_cast<std::size_t>(count)}; }
};

void whiten_all(const LineSamples& samples, double sigma_p_px, Samples& out) {
  out.count = samples.count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples.count); ++i) {
    const LineSample& s = samples.sample[i];
    out.all[i] = whiten(s.t_px, s.depth_m, sigma_p_px, s.sigma_d_m);
  }
}

// The inverse depth is linear in t along a 3D line. Weighted regression therefore gives the first hypothesis;
// without depth outliers it is already the solution.
bool regress(const Samples& samples, double sigma_p_px, PlaneLine& line) {
  double s0 = 0, s1 = 0, s2 = 0, y0 = 0, y1 = 0;
  for (const Whitened& s : samples.span()) {
    const double root_weight = s.d * s.d * s.w_z;
    const double w = root_weight * root_weight;
    const double inverse_depth = s.w_x * sigma_p_px;
    s0 += w;
    s1 += w * s.t;
    s2 += w * s.t * s.t;
    y0 += w * inverse_depth;
    y1 += w * s.t * inverse_depth;
  }
  const double determinant = s0 * s2 - s1 * s1;
  if (!(determinant > 0)) return false;
  const double offset = (s2 * y0 - s1 * y1) / determinant;
  const double slope = (s0 * y1 - s1 * y0) / determinant;
  line.t_a = samples.span().front().t;
  line.t_b = samples.span().back().t;
  const double inverse_a = offset + slope * line.t_a;
  const double inverse_b = offset + slope * line.t_b;
  if (!(inverse_a > 0 && inverse_b > 0)) return false;
  line.z_a = 1.0 / inverse_a;
  line.z_b = 1.0 / inverse_b;
  return true;
}

// MSAC cost: Σ min(r², threshold). Stops once the sum exceeds `best`.
double score(const Samples& samples, const PlaneLine& line, double threshold, double best, int& inliers) {
  const Chord chord(line);
  double cost = 0;
  inliers = 0;
  for (const Whitened& s : samples.span()) {
    const double r2 = squared_distance(s, chord);
    const bool inlier = r2 <= threshold;
    inliers += inlier ? 1 : 0;
    cost += inlier ? r2 : threshold;
    if (cost >= best) break;
  }
  return cost;
}

// Returns whether the probability of having missed a clean pair in `tries` draws is below 1 in 1000, for a
// fraction w of inliers.
bool confident(int tries, double w) {
  double miss = 1;
  for (int i = 0; i < tries; ++i) miss *= 1 - w * w;
  return miss < 1e-3;
}

// Finds the line with the least MSAC cost among the regression line and at most kMaxRansacIterations lines
// through two samples. The two samples are at least a quarter of the set apart.
bool ransac(const Samples& samples, double sigma_p_px, double threshold, std::uint64_t seed,
            PlaneLine& best) {
  const auto n = static_cast<std::uint32_t>(samples.count);
  double best_cost = threshold * static_cast<double>(n) + 1;
  int best_inliers = 0;
  PlaneLine line;
  if (regress(samples, sigma_p_px, line)) {
    best_cost = score(samples, line, threshold, best_cost, best_inliers);
    best = line;
    if (best_inliers * 20 >= samples.count * 19) return true;
  }
  Random random(seed);
  for (int i = 0; i < kMaxRansacIterations; ++i) {
    if (confident(i, static_cast<double>(best_inliers) / static_cast<double>(n))) break;
    const std::uint32_t first = random.below(n);
    const std::uint32_t second = (first + n / 4 + random.below(n / 2)) % n;
    if (first == second) continue;
    const Whitened& p = samples.all[first];
    const Whitened& q = samples.all[second];
    line = {p.t, p.d, q.t, q.d};
    int inliers = 0;
    const double cost = score(samples, line, threshold, best_cost, inliers);
    if (cost < best_cost) {
      best_cost = cost;
      best_inliers = inliers;
      best = line;
    }
  }
  return best_inliers >= 2;
}

int find_consensus(Samples& samples, const PlaneLine& line, double threshold) {
  const Chord chord(line);
  int count = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples.count); ++i) {
    samples.consensus[i] = squared_distance(samples.all[i], chord) <= threshold;
    count += samples.consensus[i] ? 1 : 0;
  }
  return count;
}

// Size-optimised code shares one solver of six parameters. The last four are unobservable here and stay
// unchanged.
constexpr int kParameters = kSizeOptimised ? 6 : 2;

// Problem (9) for the Levenberg–Marquardt solver: the depths (z_a, z_b) at the line's two pixels; A = z_a
// (t_a, 1), B = z_b (t_b, 1).
struct EndDepths {
  const Samples& samples;
  PlaneLine line;
  PlaneLine candidate;

  double linearize(const Vector<kParameters>& step, Matrix<kParameters, kParameters>& H,
                   Vector<kParameters>& g) {
    candidate = {line.t_a, line.z_a + step[0], line.t_b, line.z_b + step[1]};
    if (!(candidate.z_a > 0 && candidate.z_b > 0)) return std::numeric_limits<double>::infinity();
    const Chord chord(candidate);
    double cost = 0, g_a = 0, g_b = 0, h_aa = 0, h_ab = 0, h_bb = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(samples.count); ++i) {
      if (!samples.consensus[i]) continue;
      const Distance d = distance(samples.all[i], chord);
      const double j_a = (1 - d.lambda) * (d.normal_x * candidate.t_a + d.normal_z);
      const double j_b = d.lambda * (d.normal_x * candidate.t_b + d.normal_z);
      const double r = d.cross * d.inverse_norm2;
      cost += d.cross * r;
      g_a += j_a * r;
      g_b += j_b * r;
      h_aa += j_a * j_a * d.inverse_norm2;
      h_ab += j_a * j_b * d.inverse_norm2;
      h_bb += j_b * j_b * d.inverse_norm2;
    }
    H = h_aa * Matrix<kParameters, kParameters>::Identity();
    H(0, 1) = H(1, 0) = h_ab;
    H(1, 1) = h_bb;
    g.setZero();
    g[0] = g_a;
    g[1] = g_b;
    return 0.5 * cost;
  }
  void accept() { line = candidate; }
};

bool refine(const Samples& samples, PlaneLine& line, double& cost) {
  EndDepths problem{samples, line, line};
  LevenbergMarquardt<kParameters> solver;
  // The remaining error is less than a hundredth of the line's own standard deviation.
  const LmOptions options{.max_iterations = 10, .step_tolerance = 1e-6, .decrease_tolerance = 5e-5};
  const LmSummary summary = solver.solve(problem, options);
  line = problem.line;
  cost = 2 * summary.final_cost;
  return converged(summary.status) || summary.status == LmStatus::kMaxIterations;
}

// Covariance (10) in the plane, over (X_A, Z_A, X_B, Z_B), with the line's points at the feet of G_1 and
// G_ncon. The Jacobian J_w of the whitened vector δ = r n̂ has two parts: n̂ dr, and r dn̂ along the line.
// The rows of the ends, G_1 − A and G_ncon − B, add the direction along the line, which no other row
// observes.
bool plane_covariance(const Samples& samples, std::size_t first, std::size_t last, const PlaneLine& line,
                      double weight, Matrix4& covariance) {
  const Chord chord(line);
  double xx[3] = {}, xz[3] = {}, zz[3] = {};  // blocks AA, AB, BB
  for (std::size_t i = first; i <= last; ++i) {
    if (!samples.consensus[i]) continue;
    const Distance d = distance(samples.all[i], chord);
    const double turn = d.squared() * d.inverse_norm2;
    const double scale = weight * d.inverse_norm2;
    const double block[3] = {scale * ((1 - d.lambda) * (1 - d.lambda) + turn),
                             scale * ((1 - d.lambda) * d.lambda - turn),
                             scale * (d.lambda * d.lambda + turn)};
    for (int k = 0; k < 3; ++k) {
      xx[k] += block[k] * d.normal_x * d.normal_x;
      xz[k] += block[k] * d.normal_x * d.normal_z;
      zz[k] += block[k] * d.normal_z * d.normal_z;
    }
    if (i != first && i != last) continue;
    const Whitened& s = samples.all[i];
    const int k = i == first ? 0 : 2;
    const double along_x = d.b_x * s.w_x, along_z = d.b_z * s.w_z - s.t * along_x;  // Wᵀb
    xx[k] += along_x * along_x * d.inverse_norm2;
    xz[k] += along_x * along_z * d.inverse_norm2;
    zz[k] += along_z * along_z * d.inverse_norm2;
  }
  Matrix4 H;
  H << xx[0], xz[0], xx[1], xz[1],  //
      xz[0], zz[0], xz[1], zz[1],   //
      xx[1], xz[1], xx[2], xz[2],   //
      xz[1], zz[1], xz[2], zz[2];
  Cholesky<4> cholesky;
  if (!cholesky.factor(H)) return false;
  covariance = cholesky.inverse();
  return true;
}

// Number of samples of the consensus set that count as one independent sample, at least `least`. It depends
// on the residuals: on their correlation ρ from one to the next, as (1 + ρ) / (1 − ρ) for a first-order
// process, and on their size if that exceeds the prediction of (4).
double samples_per_independent_one(const Samples& samples, const PlaneLine& line, double least) {
  const Chord chord(line);
  double squares = 0, products = 0, before = 0;
  int count = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples.count); ++i) {
    if (!samples.consensus[i]) continue;
    const Distance d = distance(samples.all[i], chord);
    const double r = d.cross * sqrt(d.inverse_norm2);
    squares += r * r;
    products += r * before;
    before = r;
    ++count;
  }
  const double correlation = std::clamp(squares > 0 ? products / squares : 0, 0.0, 0.95);
  const double size = count > 2 ? squares / (count - 2) : 0;
  return std::max(least, (1 + correlation) / (1 - correlation)) * std::max(1.0, size);
}

// Covariance of (S_A, S_B), the position of the segment across itself.
bool transverse_covariance(const Segment& segment, const Samples& samples, const PlaneLine& line,
                           const Line3dConfig& config, Matrix2& covariance) {
  if (config.trust_segment && segment.sigma_px > 0) {
    // The floor applies at each end.
    const double half = 0.5 * segment.length_px();
    const double floor2 = 0.5 * config.transverse_floor_px * config.transverse_floor_px;
    const double middle = segment.sigma_px * segment.sigma_px + floor2;
    const double angle = segment.sigma_angle_rad * segment.sigma_angle_rad + floor2 / (half * half);
    covariance << line.z_a * line.z_a * (middle + line.t_a * line.t_a * angle),
        line.z_a * line.z_b * (middle + line.t_a * line.t_b * angle), 0,
        line.z_b * line.z_b * (middle + line.t_b * line.t_b * angle);
    covariance(1, 0) = covariance(0, 1);
    return true;
  }
  const Chord chord(line);
  double aa = 0, ab = 0, bb = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(samples.count); ++i) {
    if (!samples.consensus[i]) continue;
    const double lambda = distance(samples.all[i], chord).lambda;
    const double w = samples.all[i].w_x * samples.all[i].w_x;
    aa += w * (1 - lambda) * (1 - lambda);
    ab += w * (1 - lambda) * lambda;
    bb += w * lambda * lambda;
  }
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > 0)) return false;
  covariance << bb / determinant, -ab / determinant, -ab / determinant, aa / determinant;
  return true;
}

// Transforms from the plane to the camera frame: applies M = [e n r] to the points and to the blocks of the
// covariance.
void leave_plane(const Segment& segment, const Pinhole& pinhole, const PlaneLine& line,
                 const Matrix4& in_plane, const Matrix2& across, Line3d& out) {
  const Vector2 direction = segment.direction(), middle = segment.middle();
  Matrix3 M;
  M << direction.x() / pinhole.fx, -direction.y() / pinhole.fx, (middle.x() - pinhole.cx) / pinhole.fx,
      direction.y() / pinhole.fy, direction.x() / pinhole.fy, (middle.y() - pinhole.cy) / pinhole.fy, 0, 0, 1;
  out.a = M * Vector3(line.t_a * line.z_a, 0, line.z_a);
  out.b = M * Vector3(line.t_b * line.z_b, 0, line.z_b);
  for (int i = 0; i < 2; ++i)
    for (int j = i; j < 2; ++j) {
      Matrix3 C;
      C << in_plane(2 * i, 2 * j), 0, in_plane(2 * i, 2 * j + 1), 0, across(i, j), 0,
          in_plane(2 * i + 1, 2 * j), 0, in_plane(2 * i + 1, 2 * j + 1);
      const Matrix3 MC = M * C;
      const Matrix3 block = MC * M.transpose();
      out.Sigma.block<3, 3>(3 * i, 3 * j) = block;
      if (i != j) out.Sigma.block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
}

// Alternates between the consensus set and the line that fits it best. Two rounds suffice.
constexpr int kConsensusRounds = 2;

Line3dOutcome fit_in_plane(Samples& samples, int needed, double sigma_p_px, double threshold,
                           std::uint64_t seed, PlaneLine& line, Line3dReport& report) {
  if (!ransac(samples, sigma_p_px, threshold, seed, line)) return Line3dOutcome::kNoConsensus;
  if (!re_anchor(line, samples.span().front().t, samples.span().back().t)) return Line3dOutcome::kNoConsensus;
  int consensus = find_consensus(samples, line, threshold);
  for (int round = 0; round < kConsensusRounds; ++round) {
    if (consensus < 2) return Line3dOutcome::kNoConsensus;
    if (!refine(samples, line, report.cost)) return Line3dOutcome::kNotConverged;
    report.consensus = consensus;
    if (round == kConsensusRounds - 1) break;
    const auto before = samples.consensus;
    consensus = find_consensus(samples, line, threshold);
    if (samples.consensus == before) break;
  }
  return report.consensus >= needed ? Line3dOutcome::kOk : Line3dOutcome::kNoConsensus;
}

}  // namespace

// Not inlined, so that the data of the fit are not on the stack while the caller samples depths.
[[gnu::noinline]] Line3dReport fit_line3d(const Segment& segment, const LineSamples& taken,
                                          const Pinhole& pinhole, const Line3dConfig& config,
                                          std::uint64_t seed, Line3d& out, double inlier_chi_square) {
  Line3dReport report;
  int needed = 2;  // the smallest integer that reaches τ n_s
  while (needed < kMinConsensus * taken.asked) ++needed;
  if (taken.count < needed) return report;
  while (needed < config.min_agreement * taken.count) ++needed;

  Samples samples;
  whiten_all(taken, config.sigma_p_px, samples);
  PlaneLine line;
  report.outcome = fit_in_plane(samples, needed, config.sigma_p_px, inlier_chi_square, seed, line, report);
  if (report.outcome != Line3dOutcome::kOk) return report;

  // A and B are the feet of the first and the last sample of the consensus set.
  std::size_t first = 0, last = static_cast<std::size_t>(samples.count) - 1;
  while (!samples.consensus[first]) ++first;
  while (!samples.consensus[last]) --last;
  const Chord chord(line);
  const double t_first = foot_pixel(samples.all[first], chord), t_last = foot_pixel(samples.all[last], chord);

  const double spacing = segment.length_px() / (taken.asked - 1);
  const double stated = std::max(1.0, config.depth_correlation_px / spacing);
  const double weight =
      config.trust_residuals ? 1 / samples_per_independent_one(samples, line, stated) : 1 / stated;
  Matrix4 in_plane;
  Matrix2 across;
  if (!(t_first < t_last) || !re_anchor(line, t_first, t_last) ||
      !plane_covariance(samples, first, last, line, weight, in_plane) ||
      !transverse_covariance(segment, samples, line, config, across)) {
    report.outcome = Line3dOutcome::kNotConverged;
    return report;
  }
  leave_plane(segment, pinhole, line, in_plane, across, out);
  return report;
}

}  // namespace plvo

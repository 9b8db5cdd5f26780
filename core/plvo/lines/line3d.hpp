// SPDX-License-Identifier: Apache-2.0
// Box L3 of the paper: computes a 3D line with covariance from the samples of a segment. The steps are RANSAC
// over lines through two samples with the Mahalanobis distance (5)–(7), the maximum-likelihood line over the
// consensus set (8)(9), and its covariance (10).
//
// All back-projected samples of a segment lie in one plane, which the camera centre and the segment span. Let
// (t, s) be pixels along and across the segment, from its middle. A point is M (X, S, Z) with (X, S, Z) =
// (t, s, 1) d, and M = [e n r] holds the segment's direction, its normal and its middle ray. Mahalanobis
// distances are invariant under M. A measured sample has S = 0, so (9) and (10) separate exactly into (X, Z)
// in the plane and S. In the plane, distance (7) is |r| with r = n̂ · W(A − P), where W is the whitener of
// (4) and n̂ the unit normal of the whitened line. At the minimum of (9), the ends A and B are the feet (6)
// of G_1 and G_ncon, and the cost is Σ r². The only unknowns are the two depths at the ends.
#pragma once

#include <cstdint>

#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/lines/line_samples.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

// The defaults are calibrated on rendered sequences with exact ground truth. paper() returns the settings of
// Lu & Song.
struct Line3dConfig {
  // Distance between samples. Closer depths share most of their error (see depth_correlation_px).
  double sample_spacing_px = 3;
  double min_agreement = 0.8;  // smallest n_con / samples with depth; below it, a second surface is involved
  double sigma_p_px = 0.5;     // σ_p of (3), for one sample
  int side_reach_px = 3;       // see sample_segment
  // Length along the segment within which depth errors are fully correlated, because of quantisation and the
  // sensor's correlation window. The in-plane information is divided by (this / sample spacing) if that
  // exceeds 1. The value 1 is the paper's assumption of independent samples.
  double depth_correlation_px = 3;
  // Divides the information further if the residuals are more correlated than that, or larger than (4)
  // predicts.
  bool trust_residuals = true;
  // Takes the uncertainty across the line from the segment's own σ (at the middle, and of the angle), with
  // transverse_floor_px added in quadrature at each end. If false, or if the segment has no σ: the paper's
  // independent σ_p per sample.
  bool trust_segment = true;
  double transverse_floor_px = 0.1;

  static Line3dConfig paper() {
    Line3dConfig config;
    config.sample_spacing_px = 1;
    config.min_agreement = 0;
    config.side_reach_px = 0;
    config.depth_correlation_px = 1;
    config.trust_residuals = false;
    config.trust_segment = false;
    config.transverse_floor_px = 0;
    return config;
  }
};

enum class Line3dOutcome : std::uint8_t {
  kOk,
  kTooFewDepths,  // fewer than τ n_s samples have depth
  kNoConsensus,   // the depths do not lie on one straight line: the edge only looks straight, or has two
                  // surfaces
  kNotConverged,  // the refinement left the half-space in front of the camera, or its information matrix is
                  // singular
};

struct Line3dReport {
  Line3dOutcome outcome = Line3dOutcome::kTooFewDepths;
  int consensus = 0;  // n_con
  double cost = 0;    // Σ r² over the consensus set
};

// Limit of the squared residual r² of an inlier, one degree of freedom: 99 %.
constexpr double kSampleInlierChiSquare = 6.63;

// Fits a 3D line to the samples, in the camera frame, metres; a and b are ordered as in the segment. `line`
// is written only on kOk. seed: seed of RANSAC's random generator. Another limit than the default serves
// tests of the covariance, where the tails of the noise must not be cut off.
Line3dReport fit_line3d(const Segment& segment, const LineSamples& samples, const Pinhole& pinhole,
                        const Line3dConfig& config, std::uint64_t seed, Line3d& line,
                        double inlier_chi_square = kSampleInlierChiSquare);

// Samples the depths and fits the line. depth as in sample_segment.
template <typename Depth>
Line3dReport observe_line(const Segment& segment, const Depth& depth, const Pinhole& pinhole,
                          const DepthNoise& noise, const Line3dConfig& config, std::uint64_t seed,
                          Line3d& line) {
  LineSamples samples;
  const SampleOptions options{config.sample_spacing_px, config.side_reach_px};
  sample_segment(segment, noise, options, depth, samples);
  return fit_line3d(segment, samples, pinhole, config, seed, line);
}

}  // namespace plvo

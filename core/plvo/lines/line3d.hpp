// SPDX-License-Identifier: Apache-2.0
// Box L3 of the paper: from the samples of a segment to a 3D line with covariance. RANSAC over two-sample
// lines with the Mahalanobis distance (5)–(7), the maximum-likelihood line over the consensus set (8)(9), and
// its covariance (10).
//
// All samples of a segment lie, as back-projected, in one plane: that of the camera's centre and the segment.
// With (t, s) pixels along and across the segment, from its middle, a point is M (X, S, Z), X = t d, S = s d,
// Z = d, and M = [e n r] holds the segment's direction, its normal and its middle ray. Mahalanobis distances
// do not change under M. A measured sample has S = 0, so (9) and (10) fall apart exactly into the plane's (X,
// Z) and into S. In the plane, distance (7) is |r| with r = n̂ · W(A − P), W the whitener of (4) and n̂ the
// unit normal of the whitened line. Minimising (9), the ends A and B slide along the line until they are the
// feet (6) of G_1 and G_ncon, and its value is Σ r²: a problem in the two depths at the ends alone.
#pragma once

#include <cstdint>

#include "plvo/camera/camera_model.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/lines/line_samples.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

// The defaults are calibrated on rendered sequences with exact truth (tools/plvo/bench/line_match_precision);
// paper() is Lu & Song's.
struct Line3dConfig {
  int max_samples = 100;  // of n_s
  // From one sample to the next: depths nearer to each other have most of their error in common (below).
  double sample_spacing_px = 3;
  double min_consensus = 0.6;       // τ: least n_con / n_s
  double min_agreement = 0.8;       // least n_con / samples with depth: else a second surface had a say
  double sigma_p_px = 0.5;          // σ_p of (3), of one sample
  double inlier_chi_square = 6.63;  // on r², one degree of freedom: 99 %
  int max_ransac_iterations = 20;   // two-sample lines tried; 16 find a 60 % consensus with 99.9 %
  int side_reach_px = 3;            // see sample_segment
  // Errors of depth readings closer than this along the segment are one error, not two: quantisation and the
  // sensor's correlation window see to that. The in-plane information is divided by (this / sample spacing)
  // where that is above 1; 1 is the paper's assumption of independent samples.
  double depth_correlation_px = 3;
  // Divide it by more where the residuals show more correlation than that, or are larger than (4) says.
  bool trust_residuals = true;
  // Where the line lies across itself: the segment's own σ (at the middle, and of the angle) and, in
  // quadrature, transverse_floor_px at either end. false, or where the segment states none: the paper's
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
  kNoConsensus,   // the depths are not those of one straight line: an edge that only looks straight, or two
                  // surfaces
  kNotConverged,  // the refinement left the half-space before the camera, or its information is singular
};

struct Line3dReport {
  Line3dOutcome outcome = Line3dOutcome::kTooFewDepths;
  int asked = 0;       // n_s
  int with_depth = 0;  // samples with depth
  int mixed = 0;       // of these, those that saw two surfaces
  int consensus = 0;   // n_con
  double cost = 0;     // Σ r² over the consensus set
};

// The 3D line of the samples, camera frame, metres; a, b ordered as the segment's. `line` is written only on
// kOk. seed: of RANSAC's random generator.
Line3dReport fit_line3d(const Segment& segment, const LineSamples& samples, const Pinhole& pinhole,
                        const Line3dConfig& config, std::uint64_t seed, Line3d& line);

// Sampling and fit in one; depth as in sample_segment.
template <typename Depth>
Line3dReport observe_line(const Segment& segment, const Depth& depth, const Pinhole& pinhole,
                          const DepthNoise& noise, const Line3dConfig& config, std::uint64_t seed,
                          Line3d& line) {
  LineSamples samples;
  const SampleOptions options{config.max_samples, config.sample_spacing_px, config.side_reach_px};
  sample_segment(segment, noise, options, depth, samples);
  return fit_line3d(segment, samples, pinhole, config, seed, line);
}

}  // namespace plvo

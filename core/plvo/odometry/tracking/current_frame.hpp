// SPDX-License-Identifier: Apache-2.0
// The frame that is being tracked, its references and prior, and the prediction of its motion before its
// features are associated.
#pragma once

#include <span>

#include "plvo/motion/motion_prior.hpp"
#include "plvo/motion/motion_problem.hpp"
#include "plvo/odometry/features/feature_extraction.hpp"
#include "plvo/odometry/features/frame_features.hpp"
#include "plvo/odometry/propagated_prior.hpp"
#include "plvo/odometry/stage_context.hpp"
#include "plvo/odometry/tracking/row_time_compensation.hpp"

namespace plvo {

// A frame with which the current one is matched.
struct Reference {
  const FrameFeatures* features = nullptr;
  Se3 T_current_predicted;  // T_current_reference as predicted
  PairTiming timing;
  MotionReference pose;  // relative to the base, the first of the references
  // Whether its pose relative to the last good frame is known. The propagated prior starts from
  // that frame.
  bool chained = true;
};

struct PredictedMotion {
  PropagatedPrior sensed;  // motion since the last good frame by other sensors, that of this frame included
  MotionReference last;    // pose of the last good frame, relative to the base
  Exposure exposure;       // motion of the camera during the exposure, if it goes on as before
  double depth_after_colour_s = 0;  // as in exposure.hpp
  std::span<const Reference> references;
};

struct CurrentFrame {
  const StageContext& context;
  const FeatureExtraction& extraction;  // of its image
  const DepthSampler& depth;
  const PredictedMotion& predicted;
  FrameFeatures& features;  // lines are lifted when the motion is known, and again when it is known better
  const MotionPrior& prior;

  std::int64_t stamp_ns() const { return features.stamp_ns; }
  // find_points() finds the keypoints (P1); describe_points() also computes their descriptors (P4).
  // What was done before is not repeated. Points are found with the predicted exposure.
  void find_points() const;
  void describe_points() const;
  // Computes what a reference needs besides lines. described: also its descriptors, so that it can
  // be searched by them.
  void lift_as_reference(const Exposure& exposure, bool described) const;
};

}  // namespace plvo

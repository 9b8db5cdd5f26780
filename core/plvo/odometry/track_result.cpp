// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/track_result.hpp"

namespace plvo {

const char* to_string(TrackState state) {
  switch (state) {
    case TrackState::kInitialising: return "initialising";
    case TrackState::kTracking: return "tracking";
    case TrackState::kLost: return "lost";
    case TrackState::kPredicted: return "predicted";
  }
  return "unknown";
}

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::kImage: return "image";
    case Stage::kPoints: return "points";
    case Stage::kLines: return "lines";
    case Stage::kMatching: return "matching";
    case Stage::kMotion: return "motion";
  }
  return "unknown";
}

}  // namespace plvo

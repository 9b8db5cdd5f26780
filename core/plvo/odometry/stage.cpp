// SPDX-License-Identifier: Apache-2.0
#include "plvo/odometry/stage.hpp"

namespace plvo {

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

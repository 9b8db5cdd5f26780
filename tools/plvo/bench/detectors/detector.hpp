// SPDX-License-Identifier: Apache-2.0
// The detectors that are compared. Each is a function from an 8-bit picture to what it finds.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plvo/bench/detectors/line_measures.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo::bench {

// How many features each may bring.
struct DetectorCapacity {
  int keypoints = 400;
  int segments = 256;
  int width = 640, height = 480;  // of all pictures
};

struct SegmentFinder {
  std::string name;
  std::function<std::vector<Line>(const GrayView&)> find;
};

struct FoundPoint {
  Vector2 pixel = Vector2::Zero();
  double strength = 0;
};
struct PointFinder {
  std::string name;
  std::function<std::vector<FoundPoint>(const GrayView&)> find;
};

// Ours, with the pyramid that both make in their time.
SegmentFinder own_segment_finder(const DetectorCapacity& capacity);
PointFinder own_point_finder(const DetectorCapacity& capacity);
// OpenCV's, with their default settings; none where its contrib modules are not installed.
std::vector<SegmentFinder> opencv_segment_finders();
std::vector<PointFinder> opencv_point_finders(const DetectorCapacity& capacity);

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
// The detectors under comparison. Each is a function from an 8-bit image to the features in it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plvo/bench/detectors/line_measures.hpp"
#include "plvo/image/image_view.hpp"

namespace plvo::bench {

// Largest number of features that each detector may return.
struct DetectorCapacity {
  int keypoints = 400;
  int segments = 256;
  int width = 640, height = 480;  // of all images
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

// Our detectors. The time of each includes the construction of the pyramid.
SegmentFinder own_segment_finder(const DetectorCapacity& capacity);
PointFinder own_point_finder(const DetectorCapacity& capacity);
// OpenCV's detectors with their default settings; empty if its contrib modules are not installed.
std::vector<SegmentFinder> opencv_segment_finders();
std::vector<PointFinder> opencv_point_finders(const DetectorCapacity& capacity);

}  // namespace plvo::bench

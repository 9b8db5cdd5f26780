// SPDX-License-Identifier: Apache-2.0
// Used if OpenCV's contrib modules are not installed.
#include "plvo/bench/detectors/detector.hpp"

namespace plvo::bench {

std::vector<SegmentFinder> opencv_segment_finders() { return {}; }
std::vector<PointFinder> opencv_point_finders(const DetectorCapacity& /*capacity*/) { return {}; }

}  // namespace plvo::bench

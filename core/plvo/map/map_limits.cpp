// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/map_limits.hpp"

namespace plvo {
namespace {

struct MapRange {
  const char* name;
  int value, least, most;
};

}  // namespace

Status MapLimits::validate() const {
  for (const MapRange& range : {MapRange{"keyframes", keyframes, kLeastKeyframes, kMostKeyframes},
                                MapRange{"keypoints", keypoints, kLeastKeypoints, kMostKeypoints},
                                MapRange{"segments", segments, kLeastSegments, kMostSegments}})
    if (range.value < range.least || range.value > range.most)
      return Status(StatusCode::kInvalidArgument, "MapLimits::")
          .append(range.name)
          .append(" must lie between ")
          .append(range.least)
          .append(" and ")
          .append(range.most)
          .append(", got ")
          .append(range.value);
  return {};
}

}  // namespace plvo

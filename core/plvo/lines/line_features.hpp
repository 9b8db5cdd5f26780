// SPDX-License-Identifier: Apache-2.0
// The line features of one frame: parallel arrays, indexed by segment. Segments with a 3D line come first.
#pragma once

#include <cstddef>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/base/fixed_vector.hpp"
#include "plvo/camera/exposure.hpp"
#include "plvo/camera/observation.hpp"
#include "plvo/lines/msld.hpp"
#include "plvo/lines/segment.hpp"

namespace plvo {

struct LineFeatures {
  FixedVector<Segment> segments;
  std::span<LineDescriptor> descriptors;  // descriptors of the 3D lines
  std::span<Line3d> lines;                // camera frame
  std::size_t count_3d = 0;
  int lifts = 0;                    // how often 3D lines were searched for; 0: not yet
  std::span<Exposure> lifted_with;  // size 1: the exposure with which the lines were lifted

  // Removes all segments and limits the capacity.
  void clear(std::size_t capacity) {
    segments = FixedVector<Segment>({segments.begin(), capacity < lines.size() ? capacity : lines.size()});
    count_3d = 0;
    lifts = 0;
  }

  constexpr void allocate(Arena& memory, int capacity) {
    const auto n = static_cast<std::size_t>(capacity);
    segments = FixedVector<Segment>(memory.take<Segment>("line features", n));
    descriptors = memory.take<LineDescriptor>("line features", n);
    lines = memory.take<Line3d>("line features", n);
    lifted_with = memory.take<Exposure>("line features", 1);
  }

  std::span<const Segment> segments_3d() const { return segments.span().first(count_3d); }
  std::span<const LineDescriptor> descriptors_3d() const { return descriptors.first(count_3d); }
  std::span<const Line3d> lines_3d() const { return lines.first(count_3d); }
};

}  // namespace plvo

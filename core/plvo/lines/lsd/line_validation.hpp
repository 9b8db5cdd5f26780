// SPDX-License-Identifier: Apache-2.0
// From a grown region to a meaningful rectangle (LSD, sections 2.4–2.6). A bent or ragged region is tightened
// until its rectangle is dense; then the rectangle is tested. Every step is bounded and costs at most a small
// multiple of the region's size.
#pragma once

#include <cstddef>
#include <span>

#include "plvo/lines/lsd/line_rectangle.hpp"
#include "plvo/lines/lsd/nfa.hpp"

namespace plvo::lsd {

// Tightens region until is_dense(). The first step cuts off what lies beside the edge. It is not in the
// paper, whose two steps break a long edge into fragments under noise. The second step grows the region again
// with a tolerance of twice the spread of the directions near the seed. The third step removes pixels from
// the far end (radius · 3/4, at most 24 times). Removed pixels are released. Returns false if fewer than
// min_size pixels remain or the region does not become dense. storage: the memory that holds the region.
// mass: the region's mass, as weigh() computes it.
bool tighten(LevelLineField& field, Region& region, GradientMass& mass, Rectangle& rectangle,
             std::int32_t min_size, std::span<PixelRun> storage);

// −log10 of the number of false alarms of the rectangle; a value ≥ 0 means a segment. The paper retries
// failed rectangles with less width and at finer precisions. That would find a twentieth more segments, which
// do not improve the motion.
double meaningfulness(const LevelLineField& field, const FalseAlarms& false_alarms,
                      const Rectangle& rectangle);

}  // namespace plvo::lsd

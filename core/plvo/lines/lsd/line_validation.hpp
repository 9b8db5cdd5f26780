// SPDX-License-Identifier: Apache-2.0
// From a grown region to a meaningful rectangle, or to none (LSD, sections 2.4–2.6): a region that is bent or
// ragged is tightened until its rectangle is dense, and the rectangle is tested. Every step has a bound, and
// costs at most a small multiple of the region's size.
#pragma once

#include <cstddef>
#include <span>

#include "plvo/lines/lsd/line_rectangle.hpp"
#include "plvo/lines/lsd/nfa.hpp"

namespace plvo::lsd {

// Tightens region until is_dense(): first by cutting off what lies beside the edge (ours, not the paper's:
// under noise the paper's two steps break a long edge to runs), then by growing anew with a tolerance of
// twice the spread of the directions near the seed, then pixel by pixel from the far end (radius · 3/4, at
// most 24 times). Pixels left out are released. False when fewer than min_size pixels remain. storage: the
// memory that holds the region. mass: the region's, as weigh() finds it.
bool tighten(LevelLineField& field, Region& region, GradientMass& mass, Rectangle& rectangle,
             std::int32_t min_size, std::span<Run> storage);

// −log10 of the number of false alarms of the rectangle as it is: a segment when ≥ 0. The paper tries those
// that fail again, with less width and at finer precisions; here that found a twentieth of the segments more,
// which made no motion better.
double meaningfulness(const LevelLineField& field, const FalseAlarms& false_alarms,
                      const Rectangle& rectangle);

}  // namespace plvo::lsd

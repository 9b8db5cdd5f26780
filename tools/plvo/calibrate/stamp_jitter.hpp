// SPDX-License-Identifier: Apache-2.0
// How far the stamps of colour err, from the stamps alone: a camera exposes at an even pace, and what of a
// stamp is not even came in on the way to the program that stamped it.
#pragma once

#include <span>
#include <vector>

#include "plvo/calibrate/tracked_recording.hpp"

namespace plvo::calibrate {

// Standard deviation of the stamps about the straight line through them, a line for each recording, in
// seconds; frames that the recording lacks leave a gap in it. Negative where the recordings do not tell: too
// few frames, or no even pace, as with a shutter time that follows the light.
double stamp_jitter_s(std::span<const TrackedRecording> recordings);

}  // namespace plvo::calibrate

// SPDX-License-Identifier: Apache-2.0
// Estimates the random error of the colour stamps from the stamps alone. It assumes that the camera exposes
// at a constant rate, so that every deviation arises on the way to the program that stamps the frame.
#pragma once

#include <span>
#include <vector>

#include "plvo/calibrate/tracked_recording.hpp"

namespace plvo::calibrate {

// Returns the standard deviation of the stamps about a straight line, fitted to each recording, in seconds.
// Missing frames leave a gap in the line. Returns a negative value if the recordings do not determine it: too
// few frames, or no constant rate, as with a shutter time that follows the light.
double stamp_jitter_s(std::span<const TrackedRecording> recordings);

}  // namespace plvo::calibrate

// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/stages/track_counted.hpp"

namespace plvo::bench {

TrackResult track_counted(Odometry& odometry, const RgbdFrame& frame) { return odometry.track(frame); }

}  // namespace plvo::bench

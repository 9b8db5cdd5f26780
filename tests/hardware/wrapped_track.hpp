// SPDX-License-Identifier: Apache-2.0
// The linker's --wrap routes every call of Odometry::track(frame, prior) to wrapped_track(), which the test
// defines; real_track() is the function itself.
#pragma once

#include "plvo/odometry/odometry.hpp"

plvo::TrackResult real_track(
    plvo::Odometry* odometry, const plvo::RgbdFrame& frame,
    const plvo::MotionPrior& prior) asm("__real__ZN4plvo8Odometry5trackERKNS_9RgbdFrameERKNS_11MotionPriorE");
plvo::TrackResult wrapped_track(
    plvo::Odometry* odometry, const plvo::RgbdFrame& frame,
    const plvo::MotionPrior& prior) asm("__wrap__ZN4plvo8Odometry5trackERKNS_9RgbdFrameERKNS_11MotionPriorE");

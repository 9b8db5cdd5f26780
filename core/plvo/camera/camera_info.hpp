// SPDX-License-Identifier: Apache-2.0
// The lens that a ROS camera_info describes: a name and a list of numbers, as in OpenCV.
#pragma once

#include <span>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/camera/distortion.hpp"

namespace plvo {

// plumb_bob, which librealsense calls Brown Conrady, and rational_polynomial, which is the same with more
// coefficients; equidistant or fisheye; an empty name is the rational one. kUnsupported for another. On
// failure `model` is unchanged.
Status lens_model_of(std::string_view name, LensModel& model);
// plumb_bob, where that is enough; rational_polynomial; equidistant.
const char* lens_model_name(const Distortion& lens);

// By the name of the model: plumb_bob (4 or 5 coefficients), rational_polynomial (8; those of a prism or of a
// tilted sensor, which OpenCV may add, must be 0), equidistant or fisheye (4). An empty name: what so many
// numbers mean in OpenCV. No number: no distortion, but for equidistant. librealsense's None,
// Inverse and Modified Brown Conrady: no distortion, where all coefficients are 0. kUnsupported for another
// model; kInvalidArgument for another count. On failure `lens` is unchanged.
Status distortion_of(std::string_view model, std::span<const double> coefficients, Distortion& lens);

}  // namespace plvo

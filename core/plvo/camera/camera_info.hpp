// SPDX-License-Identifier: Apache-2.0
// The lens that a ROS camera_info describes: a model name and a list of coefficients, as in OpenCV.
#pragma once

#include <span>
#include <string_view>

#include "plvo/base/status.hpp"
#include "plvo/camera/distortion.hpp"

namespace plvo {

// Accepts plumb_bob, which librealsense calls Brown Conrady; rational_polynomial, which is the same model
// with more coefficients; equidistant or fisheye. An empty name means the rational model. Returns
// kUnsupported for any other name. On failure `model` is unchanged.
Status lens_model_of(std::string_view name, LensModel& model);
// Returns plumb_bob if the coefficients fit that model, else rational_polynomial or equidistant.
const char* lens_model_name(const Distortion& lens);

// The model name gives the count: plumb_bob has 4 or 5 coefficients, equidistant or fisheye 4.
// rational_polynomial has 8; OpenCV's further ones for a thin prism or a tilted sensor must be 0. With an
// empty name, the count decides as in OpenCV. No coefficients mean no distortion, except for equidistant.
// librealsense's None, Inverse and Modified Brown Conrady mean no distortion if all coefficients are 0.
// Returns kUnsupported for any other model and kInvalidArgument for any other count. On failure `lens` is
// unchanged.
Status distortion_of(std::string_view model, std::span<const double> coefficients, Distortion& lens);

}  // namespace plvo

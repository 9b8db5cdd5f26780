// SPDX-License-Identifier: Apache-2.0
// Which pixels around a keypoint lie on its own surface. Beside a depth edge a patch sees two surfaces that
// move differently, and registering both together underestimates the parallax: measured on rendered sequences
// with exact truth, near points lag by a tenth of a pixel and far ones run ahead. So only the keypoint's own
// surface is registered, less a rim: colour and depth do not meet exactly at an edge, and gradients reach
// across it.
#pragma once

#include "plvo/image/depth_sampler.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// centre: where the depth image shows the keypoint (DepthSample::located); depth_m: its depth, as sampled;
// level: of the pyramid, at which the window's pixels are counted. A pixel without depth is taken to be
// another surface: beside an edge it is, in a Kinect's shadow.
WindowMask depth_mask(const DepthSampler& depth, const Vector2& centre, double depth_m, int level);

}  // namespace plvo

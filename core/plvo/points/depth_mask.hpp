// SPDX-License-Identifier: Apache-2.0
// Depth mask: the pixels around a keypoint that lie on its own surface. Near a depth edge, a patch contains
// two surfaces that move differently. Registering both together underestimates the parallax: on rendered
// sequences with exact ground truth, near points lag by a tenth of a pixel and far points lead. Only the
// keypoint's own surface is therefore registered. Its rim is excluded, because colour and depth are not
// aligned exactly at an edge and gradients reach across it.
#pragma once

#include "plvo/image/depth_sampler.hpp"
#include "plvo/points/keypoint.hpp"

namespace plvo {

// centre: position of the keypoint in the depth image (DepthSample::located). depth_m: its sampled depth.
// level: pyramid level of the window's pixels. A pixel without depth is unknown: it counts as the keypoint's
// surface only where readings of this surface surround it. In the Kinect's shadow beside an edge, they do
// not.
WindowMask depth_mask(const DepthSampler& depth, const Vector2& centre, double depth_m, int level);

}  // namespace plvo

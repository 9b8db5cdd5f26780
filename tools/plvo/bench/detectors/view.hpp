// SPDX-License-Identifier: Apache-2.0
// An image for detectors with its ground truth: the camera pose, the depth of each pixel and, for a rendered
// image, the visible edges.
#pragma once

#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/bench/detectors/line_measures.hpp"
#include "plvo/bench/jobs/job.hpp"
#include "plvo/camera/camera_model.hpp"
#include "plvo/image/image_view.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/simulator/simulator_options.hpp"

namespace plvo::bench {

struct View {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;  // without lens distortion
  std::vector<float> depth_m;      // 0: unknown
  Se3 T_world_camera;
  std::vector<std::uint8_t> clean;  // the same image without noise and blur; empty: unknown
  std::vector<Line> edges;          // of solids, if visible in the noise-free image

  GrayView image() const { return {grey.data(), width, height, width}; }
};

struct ViewSequence {
  std::string name;
  Pinhole pinhole;
  std::vector<View> views;
  bool truth_known = false;  // whether the true edges are known
};

Status render_views(SceneName scene, int frames, ViewSequence& sequence);
// Frames without a true pose are omitted.
Status read_views(const NamedFolder& folder, const JobOptions& options, ViewSequence& sequence);

// Pixel of `to` at which the surface that `from` observes at `pixel` appears. False if its depth is unknown,
// or if it lies outside of `to` or is hidden there. A pixel on a silhouette belongs to the surface in front.
bool carry(const Pinhole& pinhole, const View& from, const View& to, const Vector2& pixel, Vector2& carried);

// Difference of the grey levels on the two sides of a line at one of its points, by linear interpolation; 0
// at the border of the image.
double step_across(const std::vector<std::uint8_t>& grey, int width, int height, const Vector2& at,
                   const Vector2& normal);

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
// A picture for detectors, with what is known of it: where its camera was, how far each pixel's surface is,
// and, of a rendered one, which edges are to be seen.
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
  std::vector<std::uint8_t> clean;  // the same picture without noise and blur; empty: unknown
  std::vector<Line> edges;          // of solids, where they show in the clean picture

  GrayView image() const { return {grey.data(), width, height, width}; }
};

struct ViewSequence {
  std::string name;
  Pinhole pinhole;
  std::vector<View> views;
  bool truth_known = false;  // of edges
};

Status render_views(SceneName scene, int frames, ViewSequence& sequence);
// Frames without a true pose are left out.
Status read_views(const NamedFolder& folder, const JobOptions& options, ViewSequence& sequence);

// Where `to` shows the surface that `from` shows at `pixel`; false where its depth is unknown, and where it
// is outside of `to` or hidden there. On a silhouette the pixel is taken to belong to what is in front.
bool carry(const Pinhole& pinhole, const View& from, const View& to, const Vector2& pixel, Vector2& carried);

// Grey levels from one side of a line to the other at one of its points, by linear interpolation; 0 at the
// picture's rim.
double step_across(const std::vector<std::uint8_t>& grey, int width, int height, const Vector2& at,
                   const Vector2& normal);

}  // namespace plvo::bench

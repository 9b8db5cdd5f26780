// SPDX-License-Identifier: Apache-2.0
// Views of the simulated camera, each with its noise-free image.
#include <memory>

#include "plvo/bench/detectors/scene_edges.hpp"
#include "plvo/bench/detectors/view.hpp"
#include "plvo/image/gray.hpp"
#include "plvo/simulator/simulated_camera.hpp"

namespace plvo::bench {
namespace {

std::vector<std::uint8_t> grey_of(const RgbdFrame& frame) {
  const ColourView& colour = frame.colour;
  std::vector<std::uint8_t> grey(static_cast<std::size_t>(colour.width) *
                                 static_cast<std::size_t>(colour.height));
  to_gray(colour, {grey.data(), colour.width, colour.height, colour.width});
  return grey;
}

}  // namespace

Status render_views(SceneName scene, int frames, ViewSequence& sequence) {
  SimulatorOptions options;
  options.scene = scene;
  options.frames = frames;
  std::unique_ptr<SimulatedCamera> camera, twin;
  if (Status status = SimulatedCamera::create(options, camera); !status.ok()) return status;
  options.noise = false;
  if (Status status = SimulatedCamera::create(options, twin); !status.ok()) return status;
  SceneEdges edges(scene, options.seed, options.camera);
  sequence.name = to_string(scene);
  sequence.pinhole = options.camera.pinhole;
  sequence.truth_known = true;
  for (int k = 0; k < frames; ++k) {
    RgbdFrame frame, clean;
    if (Status status = camera->next(frame); !status.ok()) return status;
    if (Status status = twin->next(clean); !status.ok()) return status;
    View view;
    view.width = options.camera.width;
    view.height = options.camera.height;
    view.grey = grey_of(frame);
    view.clean = grey_of(clean);
    const ImageView<const float> depth = camera->exact_depth();
    view.depth_m.assign(depth.data, depth.data + view.grey.size());
    view.T_world_camera = camera->pose(k);
    view.edges = edges.visible(view.T_world_camera, view.clean);
    sequence.views.push_back(std::move(view));
  }
  return {};
}

}  // namespace plvo::bench

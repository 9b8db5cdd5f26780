// SPDX-License-Identifier: Apache-2.0
#include "golden_run.hpp"

#include <cstdint>

#include "fingerprint.hpp"
#include "result_fingerprint.hpp"
#include "test_limits.hpp"
#include "text_line.hpp"

namespace plvo {
namespace {

using test::kTestLimits;

// One run of the odometry over the procedural sequence.
struct GoldenCase {
  const char* name;
  Config config;
  Limits limits = kTestLimits;
  int frames = 6;
  // From this frame on there is nothing to see, for as many frames as given: being lost and going on belong
  // to the golden run.
  int dark_from = 3;
  int dark_frames = 1;
  double readout_s = 0;
  DepthTiming depth_timing = {};
  double mirror_m = ProceduralRenderer::kNoMirror;
};

// Stage by stage what the odometry lets one see of a frame, so that a difference has a place: the prepared
// image, keypoints, segments, tracks as found, tracks that agree.
void print_stages(const FeatureView& view, const TrackResult& result, TextLine& line) {
  Fingerprint image, points, lines, matching, motion;
  for (int v = 0; v < view.image.height; ++v)
    for (int u = 0; u < view.image.width; ++u) image.add_byte(view.image.at(u, v));
  for (const Keypoint& k : view.keypoints) {
    points.add(static_cast<double>(k.u));
    points.add(static_cast<double>(k.v));
    points.add(static_cast<int>(k.level));
  }
  points.add(result.points.with_depth);
  for (const SegmentView& s : view.segments)
    for (float value : {s.a_u, s.a_v, s.b_u, s.b_v}) lines.add(static_cast<double>(value));
  lines.add(result.lines.with_depth);
  for (const PointTrackView& t : view.point_tracks) {
    for (float value : {t.u_reference, t.v_reference, t.u, t.v}) matching.add(static_cast<double>(value));
    motion.add(t.inlier ? 1 : 0);
  }
  for (const LineTrackView& t : view.line_tracks) {
    matching.add(static_cast<int>(t.reference));
    matching.add(static_cast<int>(t.current));
    motion.add(t.inlier ? 1 : 0);
  }
  motion.add(result.T_camera_reference.R);
  motion.add(result.T_camera_reference.t);
  motion.add(result.motion_covariance);
  for (const Fingerprint& stage : {image, points, lines, matching, motion})
    line.space().hex(stage.value() >> 32, 8);
}

bool prepare(int width, int height, const GoldenMemory& memory, ProceduralRenderer& sequence,
             void (*print)(std::string_view)) {
  if (sequence.init(width, height, memory.frames)) return true;
  print("too little memory for the frames");
  return false;
}

bool run(const GoldenCase& golden, const GoldenMemory& memory, ProceduralRenderer& sequence,
         void (*print)(std::string_view)) {
  // The rays of a size are computed once: on an emulated board that takes as long as frames do.
  if (sequence.camera().width != golden.limits.width &&
      !prepare(golden.limits.width, golden.limits.height, memory, sequence, print))
    return false;
  CameraModel camera = sequence.camera();
  camera.readout_s = golden.readout_s;
  camera.depth_timing = golden.depth_timing;
  const Status status = memory.odometry.init(memory.arena, camera, golden.config, golden.limits);
  if (!status.ok()) {
    print(status.message());
    return false;
  }
  for (int i = 0; i < golden.frames; ++i) {
    const bool dark = i >= golden.dark_from && i < golden.dark_from + golden.dark_frames;
    const TrackResult result =
        memory.odometry.track(dark ? sequence.render_dark(i) : sequence.render(i, golden.mirror_m));
    TextLine line;
    line.text(golden.name).space().integer(i).space().text(to_string(result.state));
    for (int axis = 0; axis < 3; ++axis)
      line.space().integer(static_cast<std::int64_t>(result.T_world_camera.t(axis) * 1e6));
    print_stages(memory.odometry.features(), result, line);
    line.space().hex(fingerprint_of(result).value(), 16);
    print(line.view());
  }
  return true;
}

// The bytes that the renderer makes: when they differ, everything does.
bool print_input(const GoldenMemory& memory, ProceduralRenderer& sequence, void (*print)(std::string_view)) {
  if (!prepare(320, 240, memory, sequence, print)) return false;
  Fingerprint input;
  const RgbdFrame first = sequence.render(0);
  for (int i = 0; i < 320 * 240; ++i) {
    input.add(static_cast<int>(first.colour.data[3 * i]));
    input.add(static_cast<int>(first.depth.data[i]));
  }
  print(TextLine().text("input ").hex(input.value(), 16).view());
  return true;
}

}  // namespace

bool golden_run(const GoldenMemory& memory, void (*print)(std::string_view)) {
  print("run frame state x_um y_um z_um image points lines matching motion result");
  ProceduralRenderer sequence;
  if (!print_input(memory, sequence, print)) return false;
  Config points, lines, keyframe, lost, window;
  Limits surfaces = kTestLimits;
  Limits three = kTestLimits;
  surfaces.surfaces = 200;
  points.features = Features::kPoints;
  lines.features = Features::kLines;
  keyframe.references.policy = ReferencePolicy::kKeyframe;
  lost.references.max_lost_s = 0.06;
  // A new keyframe every few frames, though the camera is slow.
  window.references.policy = ReferencePolicy::kWindow;
  window.references.keyframe_inlier_ratio = 0.8;
  three.references = 3;
  const GoldenCase cases[] = {
      {.name = "default", .config = {}, .frames = 20, .dark_from = 8},
      {.name = "paper", .config = Config::paper()},
      {.name = "points", .config = points},
      {.name = "lines", .config = lines},
      {.name = "keyframe", .config = keyframe},
      // Depth rows that are exposed before the colour rows of the same place.
      {.name = "kinect", .config = {}, .readout_s = kKinectReadout_s, .depth_timing = {true, -0.01, 0.03}},
      // Lost for so long that the reference is given up, then found again.
      {.name = "lost", .config = lost, .frames = 10, .dark_from = 2, .dark_frames = 5},
      {.name = "surfaces",
       .config = {},
       .limits = surfaces,
       .readout_s = kKinectReadout_s,
       .depth_timing = {true, -0.01, 0.03}},
      // Depth contradicts parallax from the third frame on, and the motion follows depth.
      {.name = "mirror", .config = {}, .limits = surfaces, .frames = 8, .dark_from = 8, .mirror_m = 1.3},
      {.name = "window", .config = window, .limits = three, .frames = 12},
      {.name = "vga", .config = {}, .limits = Limits::vga(), .frames = 10, .dark_from = 8},
  };
  for (const GoldenCase& golden : cases)
    if (!run(golden, memory, sequence, print)) return false;
  return true;
}

}  // namespace plvo

// SPDX-License-Identifier: Apache-2.0
// Runs the odometry over the procedural sequence and prints what came out: a line a frame, with the pose in
// the shortest form that names its bits, and a hash over every number of the results. The output must be the
// same bytes from every compiler, level and processor: golden.txt holds it.
#include <cinttypes>
#include <cstdio>
#include <vector>

#include "fingerprint.hpp"
#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace {

using namespace plvo;

Fingerprint fingerprint(const TrackResult& result) {
  Fingerprint print;
  print.add(static_cast<int>(result.state));
  print.add(static_cast<int>(result.status.code()));
  print.add(result.T_world_camera.R);
  print.add(result.T_world_camera.t);
  print.add(result.pose_covariance);
  print.add(result.T_camera_reference.R);
  print.add(result.T_camera_reference.t);
  print.add(result.motion_covariance);
  for (const FeatureCounts& counts : {result.points, result.lines})
    for (int n : {counts.detected, counts.dropped, counts.with_depth, counts.matched, counts.inliers})
      print.add(n);
  print.add(result.ransac_iterations);
  print.add(result.lm_iterations);
  print.add(result.mean_brightness);
  return print;
}

bool run(const char* name, const Config& config, ProceduralSequence& sequence, const CameraModel& camera,
         int frames) {
  constexpr Limits kLimits = Limits::qvga();
  std::vector<std::byte> memory(required_bytes(kLimits));
  Odometry odometry;
  const Status status = odometry.init(memory, camera, config, kLimits);
  if (!status.ok()) {
    std::fprintf(stderr, "%s: %s\n", name, status.message());
    return false;
  }
  for (int i = 0; i < frames; ++i) {
    // One frame in which there is nothing to see: being lost and going on belong to the golden run.
    const RgbdFrame frame = i == frames / 2 ? sequence.render_dark(i) : sequence.render(i);
    const TrackResult result = odometry.track(frame);
    const Quaternion q = to_quaternion(result.T_world_camera.R);
    const Vector3& t = result.T_world_camera.t;
    std::printf("%s %d %s %.17g %.17g %.17g %.17g %.17g %.17g %.17g %016" PRIx64 "\n", name, i,
                to_string(result.state), t.x(), t.y(), t.z(), q.x, q.y, q.z, q.w,
                fingerprint(result).value());
  }
  return true;
}

}  // namespace

int main() {
  ProceduralSequence sequence(320, 240);
  Fingerprint input;
  const RgbdFrame first = sequence.render(0);
  for (int i = 0; i < 320 * 240; ++i) {
    input.add(static_cast<int>(first.colour.data[3 * i]));
    input.add(static_cast<int>(first.depth.data[i]));
  }
  std::printf("input %016" PRIx64 "\n", input.value());

  Config keyframe;
  keyframe.references.policy = ReferencePolicy::kKeyframe;
  // Depth rows that are exposed before the colour rows of the same place.
  CameraModel kinect = sequence.camera();
  kinect.readout_s = kKinectReadout_s;
  kinect.depth_timing = {true, -0.01, 0.03};
  const CameraModel plain = sequence.camera();
  const bool ok =
      run("default", Config{}, sequence, plain, 16) && run("paper", Config::paper(), sequence, plain, 6) &&
      run("keyframe", keyframe, sequence, plain, 6) && run("kinect", Config{}, sequence, kinect, 8);
  return ok ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
// Runs the odometry over the procedural sequence and prints what came out: a line a frame, with the pose in
// the shortest form that names its bits, and a hash over every number of the results. The output must be the
// same bytes from every compiler, level and processor: golden.txt holds it.
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <vector>

#include "plvo/odometry/odometry.hpp"
#include "procedural_sequence.hpp"

namespace {

using namespace plvo;

class Fingerprint {
 public:
  void add(std::uint64_t bits) {
    for (int i = 0; i < 8; ++i) hash_ = (hash_ ^ ((bits >> (8 * i)) & 0xff)) * 1099511628211ULL;  // FNV-1a
  }
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(int value) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value))); }
  template <int Rows, int Cols>
  void add(const Matrix<Rows, Cols>& m) {
    for (int r = 0; r < Rows; ++r)
      for (int c = 0; c < Cols; ++c) add(m(r, c));
  }
  void add(const Se3& T) {
    add(T.R);
    add(T.t);
  }
  void add(const FeatureCounts& counts) {
    for (int n : {counts.detected, counts.dropped, counts.with_depth, counts.matched, counts.inliers}) add(n);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

Fingerprint fingerprint(const TrackResult& result) {
  Fingerprint print;
  print.add(static_cast<int>(result.state));
  print.add(static_cast<int>(result.status.code()));
  print.add(result.T_world_camera);
  print.add(result.pose_covariance);
  print.add(result.T_camera_reference);
  print.add(result.motion_covariance);
  print.add(result.points);
  print.add(result.lines);
  print.add(result.ransac_iterations);
  print.add(result.lm_iterations);
  print.add(result.mean_brightness);
  return print;
}

bool run(const char* name, const Config& config, ProceduralSequence& sequence, int frames) {
  constexpr Limits kLimits = Limits::qvga();
  std::vector<std::byte> memory(required_bytes(kLimits));
  Odometry odometry;
  const Status status = odometry.init(memory, sequence.camera(), config, kLimits);
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
  keyframe.reference = ReferencePolicy::kKeyframe;
  const bool ok = run("default", Config{}, sequence, 16) && run("paper", Config::paper(), sequence, 6) &&
                  run("keyframe", keyframe, sequence, 6);
  return ok ? 0 : 1;
}

// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "plvo/base/random.hpp"
#include "plvo/bench/map/evaluation.hpp"
#include "plvo/bench/map/posed_camera.hpp"
#include "plvo/bench/map/studies.hpp"
#include "plvo/map/loop_check.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo::bench {
namespace {

constexpr int kFramesOfTheSequence = 1800;
// A sample is drawn evenly from each cell of distance, as a share of the scene's depth, and angle.
constexpr std::array kShares = {0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0};
constexpr std::array kAngles_deg = {0.0, 10.0, 20.0, 30.0, 45.0, 60.0};
constexpr double kHeightShare = 0.3;  // of the other directions: people and robots stay on the ground
constexpr int kTriesPerPair = 20;     // to find a place where the camera can be

// The keyframe that an odometry makes of a view.
class ViewMaker {
 public:
  explicit ViewMaker(const CameraModel& camera) {
    Limits limits;
    limits.width = camera.width;
    limits.height = camera.height;
    memory_.resize(required_bytes(limits));
    need(odometry_.init(memory_, camera, Config(), limits));
    Arena sizer = Arena::counting();
    store_.allocate(sizer, kLimits);
    LoopCheck::reserve(sizer, kLimits, camera.width, camera.height);
    arena_memory_.resize(sizer.peak() + kArenaAlignment);
    arena_ = Arena(arena_memory_);
    store_.allocate(arena_, kLimits);
    arena_.seal();
    check_ = LoopCheck(camera, Config());
  }

  // False: the view has too few features for a keyframe.
  bool make(std::size_t slot, const RgbdFrame& frame) {
    odometry_.reset();
    if (!odometry_.track(frame).status.ok()) return false;
    const FrameFeatures* features = odometry_.keyframe().features;
    if (features == nullptr || !features->points.described) return false;
    store_.set(slot, features->points, features->lines, check_.camera, Vector6::Zero());
    return true;
  }
  // Median depth of the points.
  double depth(std::size_t slot) const {
    std::vector<float> depths;
    for (const MapPoint& point : store_.at(slot).points) depths.push_back(point.depth_m);
    if (depths.empty()) return 1;
    std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2),
                     depths.end());
    return static_cast<double>(depths[depths.size() / 2]);
  }
  LoopMeasurement compare(std::size_t older, std::size_t newer) {
    return check_(store_.at(older), store_.at(newer), arena_);
  }

 private:
  static constexpr MapLimits kLimits = {8, 200, 64};

  std::vector<std::byte> memory_, arena_memory_;
  Odometry odometry_;
  Arena arena_;
  MapFeatureStore store_;
  LoopCheck check_;
};

}  // namespace

void recall(const MapStudy& study) {
  const SimulatorOptions options =
      simulated(study.scene, study.light, study.seed, study.width, kFramesOfTheSequence);
  PosedCamera camera(options);
  ViewMaker maker(camera.model());
  Random random(study.seed, 0x7265);
  std::int64_t stamp_ns = 0;
  const auto take = [&](std::size_t slot, const Se3& T_world_camera, double t_s) {
    camera.arrive();
    return maker.make(slot,
                      camera.take([&](double) { return T_world_camera; }, t_s, stamp_ns += 1'000'000'000));
  };
  // [share, metres, degrees, accepted, wrong] of each pair.
  std::string pairs;
  for (int k = 0; k < study.amount; ++k) {
    const double t_s = camera.duration_s() * (k + random.uniform()) / study.amount;
    const Se3 T_world_old = camera.trajectory(t_s);
    if (!take(0, T_world_old, t_s)) continue;
    const double depth = maker.depth(0);
    for (std::size_t s = 0; s + 1 < kShares.size(); ++s) {
      for (std::size_t a = 0; a + 1 < kAngles_deg.size(); ++a) {
        const double share = kShares[s] + (kShares[s + 1] - kShares[s]) * random.uniform();
        const double angle = kAngles_deg[a] + (kAngles_deg[a + 1] - kAngles_deg[a]) * random.uniform();
        Vector3 t = T_world_old.t;
        for (int i = 0; i < kTriesPerPair; ++i) {
          Vector3 way(random.uniform() - 0.5, random.uniform() - 0.5,
                      kHeightShare * (random.uniform() - 0.5));
          if (way.norm() < 0.1) continue;
          t = T_world_old.t + way * (share * depth / way.norm());
          if (camera.is_free(T_world_old.t, t)) break;
          t = T_world_old.t;
        }
        if (t == T_world_old.t) continue;
        const double turn = (random.uniform() < 0.5 ? -1 : 1) * angle * kPi / 180;
        const Se3 T_world_new{rotation_exp(Vector3(0, 0, turn)) * T_world_old.R, t};
        // The light swings on: the second view is of another time.
        LoopMeasurement loop;
        if (take(1, T_world_new, camera.duration_s() * random.uniform())) loop = maker.compare(0, 1);
        const bool wrong =
            loop.found && pose_error(loop.T_old_new, T_world_old.inverse() * T_world_new).wrong();
        pairs += fmt::format("{}[{:.4f}, {:.4f}, {:.3f}, {}, {}]", pairs.empty() ? "" : ", ", share,
                             share * depth, angle, loop.found ? 1 : 0, wrong ? 1 : 0);
      }
    }
  }
  fmt::print("{{\"pairs\": [{}]}}\n", pairs);
}

}  // namespace plvo::bench

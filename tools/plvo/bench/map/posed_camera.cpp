// SPDX-License-Identifier: Apache-2.0
#include "plvo/bench/map/posed_camera.hpp"

#include <vector>

namespace plvo::bench {
namespace {

constexpr float kRoom_m = 0.25F;  // that a camera needs about it

}  // namespace

PosedCamera::PosedCamera(const SimulatorOptions& options)
    : options_(options),
      scene_(sim::build_scene(options.scene, options.seed)),
      trajectory_(sim::Trajectory::hand_held(*scene_, options.seed, (options.frames - 1) / options.fps)),
      lighting_(options.light, options.seed),
      things_(options, trajectory_, *scene_),
      renderer_(*scene_, options.camera, options.threads),
      sensor_(*scene_, options.camera, options.depth, options.seed, options.threads) {
  arrive();
}

RgbdFrame PosedCamera::take(const Motion& T_world_camera, double t_s, std::int64_t stamp_ns) {
  const Se3 T = T_world_camera(t_s);
  things_.place(t_s, film_->exposure_s(), *scene_);
  renderer_.render(std::vector<Se3>(static_cast<std::size_t>(options_.camera.height), T),
                   lighting_.at(t_s, T));
  const double half_s = 0.5 * film_->exposure_s();
  film_->blur(renderer_, T.inverse() * T_world_camera(t_s - half_s),
              T.inverse() * T_world_camera(t_s + half_s));
  film_->expose(taken_, frame_s());
  sensor_.sense(renderer_.hits(), taken_++);
  RgbdFrame frame;
  frame.stamp_ns = frame.depth_stamp_ns = stamp_ns;
  frame.colour = {film_->pixels(), options_.camera.width, options_.camera.height,
                  std::ptrdiff_t{3} * options_.camera.width, PixelFormat::kRgb8};
  frame.depth = sensor_.view();
  return frame;
}

bool PosedCamera::is_free(const Vector3& from, const Vector3& to) const {
  const Vector3 way = to - from;
  const double length = way.norm();
  if (length < 1e-6) return true;
  sim::Ray ray;
  ray.origin = sim::to_float(from);
  ray.direction = sim::to_float(way / length);
  return !scene_->occluded(ray, sim::kNear, static_cast<float>(length) + kRoom_m);
}

}  // namespace plvo::bench

// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/simulated_camera.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "plvo/simulator/motion/trajectory.hpp"
#include "plvo/simulator/render/renderer.hpp"
#include "plvo/simulator/scene/lighting.hpp"
#include "plvo/simulator/scene/scene.hpp"
#include "plvo/simulator/scene/things.hpp"
#include "plvo/simulator/sensor/carried.hpp"
#include "plvo/simulator/sensor/depth_clock.hpp"
#include "plvo/simulator/sensor/film.hpp"
#include "plvo/simulator/sensor/inertial_sensor.hpp"
#include "plvo/simulator/sensor/kinect_depth.hpp"
#include "plvo/simulator/sensor/wheel_sensor.hpp"

namespace plvo {
namespace {

constexpr std::int64_t kFirstStamp_us = 1'600'000'000'000'000;

std::int64_t since_start_us(int frame, double fps) {
  return static_cast<std::int64_t>(frame * 1e6 / fps + 0.5);
}

// True if the depth and the colour of each pixel are exposed at the same time.
bool with_colour(const SimulatorOptions& options) {
  const DepthSchedule& timing = options.depth_schedule;
  return timing.delay_s == 0 && timing.stamp_offset_s == 0 &&
         timing.fps.value_or(options.fps) == options.fps &&
         timing.readout_s.value_or(options.camera.readout_s) == options.camera.readout_s;
}

}  // namespace

struct SimulatedCamera::Parts {
  Parts(const SimulatorOptions& chosen, std::unique_ptr<sim::Scene> room, sim::Trajectory path)
      : options(chosen),
        scene(std::move(room)),
        trajectory(std::move(path)),
        lighting(chosen.light, chosen.seed),
        carried(chosen, *scene),
        things(chosen, trajectory, *scene),
        renderer(*scene, chosen.camera, chosen.threads),
        film(chosen.camera, chosen.seed, chosen.noise, chosen.threads),
        clock(chosen.depth_schedule, chosen.fps, chosen.seed),
        sensor(*scene, chosen.camera, chosen.depth, chosen.seed, chosen.threads),
        exact(static_cast<std::size_t>(chosen.camera.width) *
              static_cast<std::size_t>(chosen.camera.height)) {
    if (!with_colour(chosen)) depth_caster.emplace(*scene, chosen.camera, chosen.threads);
  }

  // T_world_camera of each row. `middle` is the pose at middle_s, the time of the middle row.
  std::vector<Se3> row_poses(double middle_s, const Se3& middle, double readout_s) const {
    const int height = options.camera.height;
    std::vector<Se3> poses(static_cast<std::size_t>(height), middle);
    for (int y = 0; y < height && readout_s > 0; ++y)
      poses[static_cast<std::size_t>(y)] = trajectory.at(middle_s + readout_s * (y / (height - 1.0) - 0.5));
    return poses;
  }

  // Hits of the depth camera at its own exposure time.
  ImageView<const sim::PixelHit> depth_hits(int frame) {
    if (!depth_caster) return renderer.hits();
    const DepthSchedule& timing = options.depth_schedule;
    const std::int64_t stamp_us = clock.nearest(frame, since_start_us(frame, options.fps)).true_stamp_us;
    const double middle_s = static_cast<double>(stamp_us) * 1e-6 + timing.delay_s;
    things.place(middle_s, 0, *scene);
    depth_caster->cast(
        row_poses(middle_s, trajectory.at(middle_s), timing.readout_s.value_or(options.camera.readout_s)));
    return depth_caster->hits();
  }

  // Renders the images of a frame into film and sensor.
  void take(int frame, double t_s, const Se3& T_world_camera) {
    const sim::LightState light = lighting.at(t_s, T_world_camera);
    things.place(t_s, film.exposure_s(), *scene);
    renderer.render(row_poses(t_s, T_world_camera, options.camera.readout_s), light);
    const ImageView<const sim::PixelHit> seen = carried.cover(renderer.hits());
    for (std::size_t i = 0; i < exact.size(); ++i) exact[i] = seen.data[i].depth_m;

    const double half_s = 0.5 * film.exposure_s();
    const Se3 T_camera_world = T_world_camera.inverse();
    film.blur(renderer, T_camera_world * trajectory.at(t_s - half_s),
              T_camera_world * trajectory.at(t_s + half_s));
    const sim::Float3 position = sim::to_float(T_world_camera.t);
    carried.add_light(renderer.irradiance(position, {0, 0, 1}, light), static_cast<float>(film.white()),
                      film.light());
    film.expose(static_cast<std::uint32_t>(frame), 1 / options.fps);
    carried.burn_in(t_s, film.pixels());

    const std::optional<int> frozen = options.difficulties.frozen_depth;
    if (frozen && frame > *frozen) return;
    const ImageView<const sim::PixelHit> measured = carried.cover(depth_hits(frame));
    if (options.noise) {
      sensor.sense(measured, static_cast<std::uint32_t>(frame));
    } else {
      sensor.copy_exact(measured);
    }
    if (options.difficulties.comb) sensor.comb();
  }

  // take(stamp_ns, t_s, index) for the samples of a sensor of this rate, from 0.1 s before the first frame
  // until after the last one.
  template <typename Take>
  void each_sample(double rate_hz, Take take) const {
    const double last_s = static_cast<double>(since_start_us(frames - 1, options.fps)) * 1e-6;
    const double first_s = -0.1, after_s = std::max(0.01, 1 / rate_hz);
    const auto count = static_cast<std::uint32_t>((last_s + after_s - first_s) * rate_hz) + 1;
    for (std::uint32_t k = 0; k < count; ++k) {
      // Files store whole microseconds.
      const auto at_us = static_cast<std::int64_t>((first_s + k / rate_hz) * 1e6);
      take((kFirstStamp_us + at_us) * 1000, static_cast<double>(at_us) * 1e-6, k);
    }
  }

  // Black image of a covered lens, allocated on first use.
  const std::uint8_t* black() {
    black_pixels.resize(exact.size() * 3);
    return black_pixels.data();
  }
  const std::uint16_t* no_depth() {
    depth_holes.resize(exact.size());
    return depth_holes.data();
  }

  SimulatorOptions options;
  std::unique_ptr<sim::Scene> scene;
  sim::Trajectory trajectory;
  sim::Lighting lighting;
  sim::Carried carried;
  sim::Things things;
  sim::Renderer renderer;
  sim::Film film;
  sim::DepthClock clock;
  std::optional<sim::RayCaster> depth_caster;  // none: depth and colour are exposed together
  sim::KinectDepth sensor;
  std::vector<float> exact;
  std::vector<std::uint8_t> black_pixels;
  std::vector<std::uint16_t> depth_holes;
  int frames = 0;
  int next = 0;
};

Status SimulatedCamera::create(const SimulatorOptions& options, std::unique_ptr<SimulatedCamera>& camera) {
  const Status valid = options.validate();
  if (!valid.ok()) return valid;
  std::unique_ptr<sim::Scene> scene = sim::build_scene(options.scene, options.seed, options.storey);
  if (scene == nullptr) return Status(StatusCode::kInvalidArgument, "simulator: there is no such scene");
  // From the stamp of the first frame to that of the last frame.
  const double duration_s = (options.frames - 1) / options.fps;
  sim::Trajectory trajectory;
  if (options.trajectory_file.empty()) {
    trajectory = sim::Trajectory::hand_held(*scene, options.seed, duration_s);
  } else {
    const Status read = sim::Trajectory::from_tum(options.trajectory_file, *scene, trajectory);
    if (!read.ok()) return read;
  }
  if (options.robot) trajectory.put_on_robot();
  if (options.still) trajectory.stop();
  auto parts = std::make_unique<Parts>(options, std::move(scene), std::move(trajectory));
  parts->frames = options.frames;
  if (!options.trajectory_file.empty())
    parts->frames =
        std::min(options.frames, static_cast<int>(parts->trajectory.duration_s() * options.fps + 1e-6) + 1);
  camera.reset(new SimulatedCamera(std::move(parts)));
  return {};
}

SimulatedCamera::SimulatedCamera(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
SimulatedCamera::~SimulatedCamera() = default;

CameraModel SimulatedCamera::model() const {
  const SimulatorOptions& options = parts_->options;
  CameraModel model = options.camera;
  if (!with_colour(options))
    model.depth_timing = {.known = true,
                          .delay_s = options.depth_schedule.delay_s,
                          .readout_s = options.depth_schedule.readout_s.value_or(options.camera.readout_s)};
  return model;
}
const SimulatorOptions& SimulatedCamera::options() const { return parts_->options; }
int SimulatedCamera::frames() const { return parts_->frames; }

std::int64_t SimulatedCamera::stamp_ns(int frame) const {
  return (kFirstStamp_us + since_start_us(frame, parts_->options.fps)) * 1000;
}

std::int64_t SimulatedCamera::depth_stamp_ns(int frame) const {
  const std::int64_t colour_us = since_start_us(frame, parts_->options.fps);
  return (kFirstStamp_us + parts_->clock.nearest(frame, colour_us).stamp_us) * 1000;
}

Se3 SimulatedCamera::ground_truth(std::int64_t stamp_ns) const {
  return parts_->trajectory.at(static_cast<double>(stamp_ns - kFirstStamp_us * 1000) * 1e-9);
}

Se3 SimulatedCamera::pose(int frame) const {
  // A closed trajectory ends exactly at its first pose, although stamps are whole microseconds.
  if (frame > 0 && frame + 1 == parts_->options.frames && parts_->options.trajectory_file.empty())
    return pose(0);
  return ground_truth(stamp_ns(frame));
}

void SimulatedCamera::inertial_samples(std::vector<ImuSample>& gyro,
                                       std::vector<ImuSample>& accelerometer) const {
  const SimulatorOptions& options = parts_->options;
  const sim::InertialSensor sensor(options.inertial, options.seed, options.noise);
  gyro.clear();
  accelerometer.clear();
  parts_->each_sample(options.inertial.rate_hz, [&](std::int64_t stamp, double t_s, std::uint32_t k) {
    gyro.push_back({stamp, sensor.rate(parts_->trajectory, t_s, k)});
    accelerometer.push_back({stamp, sensor.force(parts_->trajectory, t_s, k)});
  });
}

void SimulatedCamera::wheel_samples(std::vector<WheelSample>& samples) const {
  const SimulatorOptions& options = parts_->options;
  const sim::WheelSensor sensor(options.wheels, options.seed, options.noise);
  samples.clear();
  parts_->each_sample(options.wheels.rate_hz, [&](std::int64_t stamp, double t_s, std::uint32_t k) {
    samples.push_back({stamp, sensor.velocity(parts_->trajectory, t_s, k), Vector3::Zero()});
  });
}

ImageView<const float> SimulatedCamera::exact_depth() const {
  const CameraModel& camera = parts_->options.camera;
  return {parts_->exact.data(), camera.width, camera.height, camera.width};
}

Status SimulatedCamera::next(RgbdFrame& frame) {
  Parts& parts = *parts_;
  if (parts.next >= parts.frames) return Status(StatusCode::kEndOfStream, "the simulated sequence is over");
  const int k = parts.next++;
  const CameraModel& camera = parts.options.camera;
  const std::int64_t stamp = stamp_ns(k);
  const Se3 T_world_camera = pose(k);
  const double t_s = static_cast<double>(stamp - kFirstStamp_us * 1000) * 1e-9;
  if (!(parts.options.difficulties.repeated_frames && k % 2 == 1)) parts.take(k, t_s, T_world_camera);

  frame.stamp_ns = stamp;
  frame.depth_stamp_ns = depth_stamp_ns(k);
  const bool covered = k >= parts.options.covered_first && k < parts.options.covered_end;
  frame.colour = {covered ? parts.black() : parts.film.pixels(), camera.width, camera.height,
                  static_cast<std::ptrdiff_t>(camera.width) * 3, PixelFormat::kRgb8};
  frame.depth = parts.sensor.view();
  if (covered) frame.depth.data = parts.no_depth();
  return {};
}

}  // namespace plvo

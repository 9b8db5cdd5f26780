// SPDX-License-Identifier: Apache-2.0
#include "plvo/simulator/scene/things.hpp"

#include <algorithm>
#include <cmath>

#include "plvo/math/trigonometry.hpp"

namespace plvo::sim {
namespace {

constexpr Float3 kUp{0, 0, 1};
constexpr float kEyeHeight_m = 1.45F;  // of the camera over the floor on which the person stands
constexpr double kStrides_hz = 0.9;
constexpr float kPanelHalfDepth_m = 0.01F;
constexpr float kMirrorAhead_m = 2;
constexpr float kMirrorCentre_m = -0.55F;  // to the right
constexpr float kMirrorHalfWidth_m = 0.4F;
constexpr float kMirrorHalfHeight_m = 0.8F;
constexpr float kBoardHalfHeight_m = 0.9F;  // at a distance of 1 m; grows with the distance

float sine_of(double x) { return static_cast<float>(sin(x)); }

Solid limb(Float3 a, Float3 b, float radius, std::uint16_t material, std::uint32_t seed) {
  Solid solid;
  solid.shape = Solid::Shape::kCylinder;
  solid.aligned = false;
  solid.centre = (a + b) * 0.5F;
  solid.half = {radius, radius, 0.5F * norm(b - a)};
  solid.axes = axes_along(normalised(b - a));
  solid.material.fill(material);
  solid.seed = seed;
  return solid;
}

}  // namespace

Things::Upright Things::upright(const Se3& T_world_camera) {
  Upright frame;
  frame.origin = to_float(T_world_camera.t);
  const Float3 forward = to_float(T_world_camera.R.col(2));
  frame.forward = normalised(Float3{forward.x, forward.y, 0});
  frame.right = cross(frame.forward, kUp);
  return frame;
}

Float3 Things::mean_velocity(const Trajectory& trajectory, double from_s, double to_s) {
  return to_float((trajectory.at(to_s).t - trajectory.at(from_s).t) / (to_s - from_s));
}

Things::Things(const SimulatorOptions& options, const Trajectory& trajectory, Scene& scene)
    : options_(options.difficulties) {
  const auto add = [&scene](const Material& material) {
    scene.materials.push_back(material);
    return static_cast<std::uint16_t>(scene.materials.size() - 1);
  };
  if (options_.board) {
    const MovingBoard& board = *options_.board;
    board_frame_ = upright(trajectory.at(board.from_s));
    board_velocity_ = mean_velocity(trajectory, board.from_s, board.to_s) +
                      board_frame_.right * static_cast<float>(board.speed_mps);
    // Metres per image width at the board's distance.
    const CameraModel& camera = options.camera;
    const double width_m = camera.width / camera.pinhole.fx * board.distance_m;
    const double left_m = -camera.pinhole.cx / camera.pinhole.fx * board.distance_m;
    board_half_width_m_ = static_cast<float>(0.5 * board.share * width_m);
    board_centre_m_ = static_cast<float>(left_m + board.first_column * width_m) + board_half_width_m_;
    board_material_ =
        add({.pattern = Pattern::kPoster, .base = {0.6F, 0.55F, 0.4F}, .second = {0.03F, 0.03F, 0.04F}});
  }
  if (options_.person) {
    const WalkingPerson& person = *options_.person;
    person_frame_ = upright(trajectory.at(person.from_s));
    person_velocity_ = person.ahead ? mean_velocity(trajectory, person.from_s, person.to_s)
                                    : person_frame_.right * static_cast<float>(person.speed_mps);
    person_velocity_.z = 0;
    shirt_ = add({.pattern = Pattern::kPoster, .base = {0.5F, 0.2F, 0.15F}, .second = {0.04F, 0.04F, 0.05F}});
    sleeve_ = add({.pattern = Pattern::kTiles,
                   .base = {0.45F, 0.18F, 0.15F},
                   .second = {0.75F, 0.7F, 0.6F},
                   .scale = 0.05F,
                   .contrast = 2});
    trousers_ = add({.pattern = Pattern::kCarpet,
                     .base = {0.3F, 0.35F, 0.5F},
                     .second = {0.05F, 0.06F, 0.12F},
                     .contrast = 1.5F});
    skin_ = add({.pattern = Pattern::kPlaster,
                 .base = {0.55F, 0.38F, 0.28F},
                 .second = {0.1F, 0.06F, 0.04F},
                 .contrast = 2});
  }
  if (options_.mirror) {
    mirror_frame_ = upright(trajectory.at(0));
    mirror_material_ = add({.base = {0.02F, 0.02F, 0.02F}, .mirror = 0.85F});
  }
}

Solid Things::panel(Float3 centre, const Upright& frame, Float3 half, std::uint16_t material) const {
  Solid solid;
  solid.aligned = false;
  solid.centre = centre;
  solid.half = half;
  solid.axes = {frame.right, frame.forward, kUp};
  solid.material.fill(material);
  solid.seed = 0x426f6172U;
  return solid;
}

std::vector<Solid> Things::at(double present_s, double t_s) const {
  std::vector<Solid> solids;
  if (options_.mirror) {
    const Float3 centre =
        mirror_frame_.origin + mirror_frame_.forward * kMirrorAhead_m + mirror_frame_.right * kMirrorCentre_m;
    solids.push_back(panel(centre, mirror_frame_,
                           {kMirrorHalfWidth_m, kPanelHalfDepth_m, kMirrorHalfHeight_m}, mirror_material_));
  }
  const auto present = [present_s](const auto& thing) {
    return thing && present_s >= thing->from_s && present_s < thing->to_s;
  };
  if (present(options_.board)) {
    const auto distance = static_cast<float>(options_.board->distance_m);
    const auto since_s = static_cast<float>(t_s - options_.board->from_s);
    // The distance is that of the surface that faces the camera.
    const Float3 centre = board_frame_.origin + board_frame_.forward * (distance + kPanelHalfDepth_m) +
                          board_frame_.right * board_centre_m_ + board_velocity_ * since_s;
    solids.push_back(panel(centre, board_frame_,
                           {board_half_width_m_, kPanelHalfDepth_m, kBoardHalfHeight_m * distance},
                           board_material_));
  }
  if (present(options_.person)) add_person(t_s, solids);
  return solids;
}

void Things::add_person(double t_s, std::vector<Solid>& solids) const {
  const WalkingPerson& person = *options_.person;
  const double since_s = t_s - person.from_s;
  const double phase = 2 * kPi * kStrides_hz * since_s;
  Upright body = person_frame_;
  Float3 foot = person_frame_.origin + person_frame_.forward * static_cast<float>(person.distance_m) +
                person_velocity_ * static_cast<float>(since_s);
  if (!person.ahead) {
    foot = foot -
           person_frame_.right * static_cast<float>(0.5 * person.speed_mps * (person.to_s - person.from_s));
    body.forward = person_frame_.right;
    body.right = -person_frame_.forward;
  }
  foot.z = person_frame_.origin.z - kEyeHeight_m + 0.02F * sine_of(2 * phase);
  // A point over the foot: metres forward, to the right and upwards.
  const auto point = [&](float forward, float right, float up) {
    return foot + body.forward * forward + body.right * right + kUp * up;
  };
  const auto hanging = [&](Float3 from, float length, double angle) {
    return from + body.forward * (length * sine_of(angle)) - kUp * (length * static_cast<float>(cos(angle)));
  };
  // The chest turns against the legs, and the shoulders with it.
  const double turn = 0.15 * sin(phase);
  const auto cosine = static_cast<float>(cos(turn));
  Upright chest = body;
  chest.forward = body.forward * cosine + body.right * sine_of(turn);
  chest.right = body.right * cosine - body.forward * sine_of(turn);
  Solid torso = panel(point(0, 0, 1.18F), chest, {0.2F, 0.12F, 0.28F}, shirt_);
  torso.seed = 1;
  solids.push_back(torso);
  solids.push_back(limb(point(0.02F, 0, 1.48F), point(0.03F, 0, 1.75F), 0.1F, skin_, 2));
  for (const float side : {-1.0F, 1.0F}) {
    const double swing = phase + (side > 0 ? kPi : 0);
    const auto seed = static_cast<std::uint32_t>(side > 0 ? 10 : 20);
    const double thigh = 0.45 * sin(swing);
    const double shin = thigh - 0.3 * (1 - cos(swing));
    const Float3 hip = point(0, 0.1F * side, 0.92F);
    const Float3 knee = hanging(hip, 0.44F, thigh);
    solids.push_back(limb(hip, knee, 0.085F, trousers_, seed));
    solids.push_back(limb(knee, hanging(knee, 0.46F, shin), 0.065F, trousers_, seed + 1));
    const double upper_arm = -0.5 * sin(swing);
    const Float3 shoulder = point(0, 0, 1.42F) + chest.right * (0.255F * side);
    const Float3 elbow = hanging(shoulder, 0.3F, upper_arm);
    solids.push_back(limb(shoulder, elbow, 0.05F, sleeve_, seed + 2));
    solids.push_back(
        limb(elbow, hanging(elbow, 0.28F, upper_arm + 0.35 + 0.2 * cos(swing)), 0.04F, skin_, seed + 3));
  }
}

void Things::place(double t_s, double exposure_s, Scene& scene) const {
  const std::vector<Solid> now = at(t_s, t_s);
  scene.solids.resize(scene.first_thing);
  scene.solids.insert(scene.solids.end(), now.begin(), now.end());
  scene.things_opening = at(t_s, t_s - 0.5 * exposure_s);
  scene.things_closing = at(t_s, t_s + 0.5 * exposure_s);
  scene.bound_things();
}

}  // namespace plvo::sim

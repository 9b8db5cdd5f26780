// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/calibration/calibration_keys.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "plvo/camera/camera_info.hpp"
#include "plvo/host/number_text.hpp"

namespace plvo::calibration_form {
namespace {

namespace fs = std::filesystem;

using N = Numbers;
constexpr auto kKeys = std::to_array<Key>({
    {"fx", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.pinhole.fx; }},
    {"fy", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.pinhole.fy; }},
    {"cx", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.pinhole.cx; }},
    {"cy", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.pinhole.cy; }},
    {"depth_scale", KeyKind::kSensor, [](N& n) -> double& { return n.calibration.depth_units_per_metre; }},
    {"k1", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.k1; }},
    {"k2", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.k2; }},
    {"p1", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.p1; }},
    {"p2", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.p2; }},
    {"k3", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.k3; }},
    {"readout_s", KeyKind::kSensor, [](N& n) -> double& { return n.calibration.camera.readout_s; }},
    // The following have keys only, no place among the numbers.
    {"k4", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.k4; }},
    {"k5", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.k5; }},
    {"k6", KeyKind::kLens, [](N& n) -> double& { return n.calibration.camera.distortion.k6; }},
    {"depth_delay_s", KeyKind::kSensor,
     [](N& n) -> double& { return n.calibration.camera.depth_timing.delay_s; }},
    {"depth_readout_s", KeyKind::kSensor,
     [](N& n) -> double& { return n.calibration.camera.depth_timing.readout_s; }},
    {"stamp_sigma_s", KeyKind::kSensor, [](N& n) -> double& { return n.calibration.camera.stamp_sigma_s; }},
    {"depth_fx", KeyKind::kDepthPinhole,
     [](N& n) -> double& { return n.calibration.depth_camera.pinhole.fx; }},
    {"depth_fy", KeyKind::kDepthPinhole,
     [](N& n) -> double& { return n.calibration.depth_camera.pinhole.fy; }},
    {"depth_cx", KeyKind::kDepthPinhole,
     [](N& n) -> double& { return n.calibration.depth_camera.pinhole.cx; }},
    {"depth_cy", KeyKind::kDepthPinhole,
     [](N& n) -> double& { return n.calibration.depth_camera.pinhole.cy; }},
    {"depth_tx", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.tx; }},
    {"depth_ty", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.ty; }},
    {"depth_tz", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.tz; }},
    {"depth_qx", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.qx; }},
    {"depth_qy", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.qy; }},
    {"depth_qz", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.qz; }},
    {"depth_qw", KeyKind::kDepthPlace, [](N& n) -> double& { return n.calibration.depth_camera.qw; }},
    {"width", KeyKind::kSize, [](N& n) -> double& { return n.width; }},
    {"height", KeyKind::kSize, [](N& n) -> double& { return n.height; }},
});
static_assert(kKeys.size() <= kMaxKeys && kPlaces <= kKeys.size());

std::string all_names() {
  std::string names;
  for (const Key& key : kKeys) names.append(names.empty() ? "" : " ").append(key.name);
  return names.append(" ").append(kLensModelKey);
}

bool is_image_side(double value) { return value >= 1 && value <= 100000 && value == std::floor(value); }

}  // namespace

std::span<const Key> keys() { return kKeys; }

bool is_key(std::string_view name) {
  return name == kLensModelKey ||
         std::any_of(kKeys.begin(), kKeys.end(), [&](const Key& key) { return key.name == name; });
}

bool parse_number(std::string_view text, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  return parse_whole_text(text, value);
}

Status damaged(const fs::path& path, std::string_view what) {
  return {StatusCode::kDamaged, fmt::format("{}: {}", path.string(), what)};
}

void Collector::put(std::size_t index, double value) {
  kKeys[index].of(numbers_) = value;
  given_[index] = true;
}

void Collector::set_place(std::size_t place, double value) { put(place, value); }

void Collector::set_lens(const Pinhole& pinhole, const Distortion& distortion) {
  numbers_.calibration.camera.pinhole = pinhole;
  numbers_.calibration.camera.distortion = distortion;
  for (std::size_t i = 0; i < kKeys.size(); ++i)
    if (kKeys[i].kind == KeyKind::kLens) given_[i] = true;
}

Status Collector::set_lens_model(std::string_view name) {
  if (!lens_model_.empty()) return damaged(path_, fmt::format("'{}' is said twice", kLensModelKey));
  if (name.empty())
    return damaged(path_, fmt::format("'{}' needs plumb_bob, rational_polynomial or equidistant after it",
                                      kLensModelKey));
  lens_model_ = name;
  const Status status = lens_model_of(name, numbers_.calibration.camera.distortion.model);
  return status.ok() ? status
                     : Status(status.code(), fmt::format("{}: {}", path_.string(), status.message()));
}

Status Collector::set(std::string_view key, std::string_view value) {
  if (key == kLensModelKey) return set_lens_model(value);
  for (std::size_t i = 0; i < kKeys.size(); ++i) {
    if (kKeys[i].name != key) continue;
    double number = 0;
    if (!parse_number(value, number)) return damaged(path_, fmt::format("'{}' needs a number after it", key));
    if (given_[i]) return damaged(path_, fmt::format("'{}' is said twice", key));
    put(i, number);
    return {};
  }
  return damaged(path_, fmt::format("'{}' is not known; the keys are {}", key.substr(0, 40), all_names()));
}

bool Collector::given(std::string_view key) const {
  for (std::size_t i = 0; i < kKeys.size(); ++i)
    if (kKeys[i].name == key) return given_[i];
  return false;
}

Status Collector::finish_depth_camera(DepthCamera& depth) const {
  const auto count = [&](std::initializer_list<const char*> names) {
    return std::count_if(names.begin(), names.end(), [&](const char* name) { return given(name); });
  };
  const auto pinhole = count({"depth_fx", "depth_fy", "depth_cx", "depth_cy"});
  const auto place = count({"depth_tx", "depth_ty", "depth_tz"});
  const auto turn = count({"depth_qx", "depth_qy", "depth_qz", "depth_qw"});
  if (pinhole % 4 != 0) return damaged(path_, "depth_fx, depth_fy, depth_cx and depth_cy go together");
  if (turn % 4 != 0) return damaged(path_, "depth_qx, depth_qy, depth_qz and depth_qw go together");
  depth.known = pinhole + place + turn > 0;
  depth.as_colour = depth.known && pinhole == 0;
  return {};
}

Status Collector::finish(Calibration& calibration) {
  if (!given("fx") || !given("fy") || !given("cx") || !given("cy"))
    return damaged(path_, "fx, fy, cx and cy must all be given");
  if (given("width") != given("height"))
    return damaged(path_, "width and height must be given both, or neither");
  Calibration& result = numbers_.calibration;
  if (lens_model_ == "plumb_bob" && !result.camera.distortion.is_plumb_bob())
    return damaged(path_, "plumb_bob has no k4 k5 k6; the lens that has them is rational_polynomial");
  if (Status status = finish_depth_camera(result.depth_camera); !status.ok()) return status;
  result.has_size = given("width");
  if (result.has_size) {
    if (!is_image_side(numbers_.width) || !is_image_side(numbers_.height))
      return damaged(path_, "width and height must be whole numbers of pixels");
    result.camera.width = static_cast<int>(numbers_.width);
    result.camera.height = static_cast<int>(numbers_.height);
  }
  result.depth_scale_given = given("depth_scale");
  result.readout_given = given("readout_s");
  // If the delay of depth is known, the readout of depth is taken to equal that of colour unless the file has
  // another.
  DepthTiming& depth = result.camera.depth_timing;
  depth.known = given("depth_delay_s");
  if (given("depth_readout_s") && !depth.known)
    return damaged(path_, "depth_readout_s needs depth_delay_s beside it");
  if (depth.known && !given("depth_readout_s")) depth.readout_s = result.camera.readout_s;
  calibration = result;
  return {};
}

}  // namespace plvo::calibration_form

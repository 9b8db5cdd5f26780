// SPDX-License-Identifier: Apache-2.0
// The integrator of a gyro and an accelerometer behind imu.h. Its handle stands at the front of the caller's
// block; the samples that wait follow.
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <type_traits>

#include "plvo/base/arena.hpp"
#include "plvo/c/boundary.hpp"
#include "plvo/c/imu.h"
#include "plvo/c/matrices.hpp"
#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/odometry/track_result.hpp"

struct plvo_imu {
  plvo::ImuIntegrator integrator;
};
static_assert(std::is_trivially_destructible_v<plvo_imu> && std::is_trivially_destructible_v<plvo::ImuSample>,
              "it is never destroyed: the caller only frees its memory");

namespace plvo::c {
namespace {

constexpr std::size_t kHandleBytes = align_up(sizeof(plvo_imu));
constexpr std::int32_t kMostSamples = 1000000;
constexpr const char* kNoImu = "imu is NULL: plvo_imu_init comes first";

plvo_imu_config default_imu_config() {
  const ImuConfig defaults;
  plvo_imu_config config;
  std::memset(&config, 0, sizeof config);
  config.struct_size = sizeof config;
  config.gyro_samples = config.accelerometer_samples = 128;
  put(defaults.R_camera_imu, config.R_camera_imu);
  config.gyro_noise = defaults.gyro_noise;
  config.gyro_offset_sigma = defaults.gyro_offset_sigma;
  config.gyro_offset_walk = defaults.gyro_offset_walk;
  config.gyro_scale_sigma = defaults.gyro_scale_sigma;
  config.accelerometer_noise = defaults.accelerometer_noise;
  config.accelerometer_offset_sigma = defaults.accelerometer_offset_sigma;
  config.acceleration = defaults.acceleration;
  config.acceleration_s = defaults.acceleration_s;
  config.longest_gap_s = defaults.longest_gap_s;
  return config;
}

bool can_wait(std::int32_t samples) { return samples == 0 || (samples >= 2 && samples <= kMostSamples); }

// whole: with the defaults for what the caller does not know.
Status take_config(const plvo_imu_config* given, plvo_imu_config& whole, ImuConfig& config) {
  whole = default_imu_config();
  if (given != nullptr)
    if (Status status = take_struct(given, whole, "imu_config"); !status.ok()) return status;
  if (!can_wait(whole.gyro_samples) || !can_wait(whole.accelerometer_samples))
    return refuse("imu: gyro_samples and accelerometer_samples must be 0, or 2 to 1000000");
  config.R_camera_imu = matrix<3>(whole.R_camera_imu);
  config.gyro_noise = whole.gyro_noise;
  config.gyro_offset_sigma = whole.gyro_offset_sigma;
  config.gyro_offset_walk = whole.gyro_offset_walk;
  config.gyro_scale_sigma = whole.gyro_scale_sigma;
  config.accelerometer_noise = whole.accelerometer_noise;
  config.accelerometer_offset_sigma = whole.accelerometer_offset_sigma;
  config.acceleration = whole.acceleration;
  config.acceleration_s = whole.acceleration_s;
  config.longest_gap_s = whole.longest_gap_s;
  return config.validate();
}

std::span<ImuSample> place_samples(std::byte* block, std::int32_t count) {
  auto* samples = reinterpret_cast<ImuSample*>(block);
  std::uninitialized_default_construct_n(samples, count);
  return {samples, static_cast<std::size_t>(count)};
}

std::size_t bytes_for(const plvo_imu_config& config) {
  return kHandleBytes + array_bytes(static_cast<std::size_t>(config.gyro_samples), sizeof(ImuSample)) +
         array_bytes(static_cast<std::size_t>(config.accelerometer_samples), sizeof(ImuSample)) +
         kArenaAlignment;
}

plvo_status add(plvo_imu* imu, std::int64_t stamp_ns, const double* values,
                bool (ImuIntegrator::*add_sample)(const ImuSample&)) {
  if (imu == nullptr) return to_c(refuse(kNoImu));
  if (values == nullptr) return to_c(refuse("imu: a sample is NULL"));
  const ImuSample sample{stamp_ns, {values[0], values[1], values[2]}};
  if ((imu->integrator.*add_sample)(sample)) return to_c(Status());
  return to_c(
      refuse("imu: a sample must be finite and later than the one before, of a sensor that has memory"));
}

void give_prior(const MotionPrior& prior, plvo_prior* caller) {
  plvo_prior whole;
  std::memset(&whole, 0, sizeof whole);
  if (prior.rotation) {
    whole.has_rotation = 1;
    put(prior.rotation->R_now_before, whole.R_now_before);
    put(prior.rotation->covariance, whole.rotation_covariance);
  }
  if (prior.gravity) {
    whole.has_gravity = 1;
    put(prior.gravity->down, whole.down);
    put(prior.gravity->covariance, whole.gravity_covariance);
    whole.gravity_offset_sigma = prior.gravity->offset_sigma;
  }
  give_struct(whole, caller);
}

Status take_rotation(std::int32_t code, const plvo_result* given, std::optional<ObservedRotation>& observed) {
  TrackResult result;
  if (Status status = take_result(given, result); !status.ok()) return status;
  if (code != PLVO_OK) result.status = refuse("not tracked");
  if (!result.T_camera_reference.R.allFinite() || !result.motion_covariance.allFinite())
    return refuse("result: a number is not finite");
  observed = observed_rotation(result);
  return {};
}

}  // namespace
}  // namespace plvo::c

using plvo::c::refuse;
using plvo::c::to_c;

void plvo_imu_config_init(plvo_imu_config* config, std::size_t size) {
  plvo::c::init_struct(plvo::c::default_imu_config(), config, size);
}

std::size_t plvo_imu_required_bytes(const plvo_imu_config* given) {
  plvo_imu_config whole;
  plvo::ImuConfig config;
  return plvo::c::take_config(given, whole, config).ok() ? plvo::c::bytes_for(whole) : 0;
}

plvo_status plvo_imu_init(void* memory, std::size_t bytes, const plvo_imu_config* given, plvo_imu** imu) {
  if (imu == nullptr) return to_c(refuse("imu is NULL: nowhere to put the new one"));
  *imu = nullptr;
  if (memory == nullptr) return to_c(refuse("memory is NULL"));
  plvo_imu_config whole;
  plvo::ImuConfig config;
  if (plvo::Status status = plvo::c::take_config(given, whole, config); !status.ok()) return to_c(status);
  const std::size_t needed = plvo::c::bytes_for(whole);
  if (bytes < needed) return to_c(plvo::c::too_small("for these samples", needed, bytes));

  std::byte* block = plvo::c::aligned_part(memory, bytes).data();
  auto* handle = new (block) plvo_imu;
  const auto gyro = plvo::c::place_samples(block + plvo::c::kHandleBytes, whole.gyro_samples);
  const auto accelerometer = plvo::c::place_samples(
      block + plvo::c::kHandleBytes + plvo::array_bytes(gyro.size(), sizeof(plvo::ImuSample)),
      whole.accelerometer_samples);
  const plvo::Status status = handle->integrator.init(gyro, accelerometer, config);
  if (status.ok()) *imu = handle;
  return to_c(status);
}

plvo_status plvo_imu_add_gyro(plvo_imu* imu, std::int64_t stamp_ns, const double rate[3]) {
  return plvo::c::add(imu, stamp_ns, rate, &plvo::ImuIntegrator::add_gyro);
}
plvo_status plvo_imu_add_acceleration(plvo_imu* imu, std::int64_t stamp_ns, const double force[3]) {
  return plvo::c::add(imu, stamp_ns, force, &plvo::ImuIntegrator::add_acceleration);
}

plvo_status plvo_imu_prior(plvo_imu* imu, std::int64_t stamp_ns, plvo_prior* prior) {
  if (imu == nullptr) return to_c(refuse(plvo::c::kNoImu));
  if (plvo::Status status = plvo::c::check_struct(prior, "prior"); !status.ok()) return to_c(status);
  constexpr std::int64_t kFarthest_ns = std::int64_t{1} << 61;
  if (stamp_ns > kFarthest_ns || stamp_ns < -kFarthest_ns)
    return to_c(refuse("imu: a stamp must be within 2^61 ns of 0"));
  plvo::c::give_prior(imu->integrator.prior(stamp_ns), prior);
  return to_c(plvo::Status());
}

plvo_status plvo_imu_learn(plvo_imu* imu, std::int32_t code, const plvo_result* result) {
  if (imu == nullptr) return to_c(refuse(plvo::c::kNoImu));
  std::optional<plvo::ObservedRotation> observed;
  if (plvo::Status status = plvo::c::take_rotation(code, result, observed); !status.ok()) return to_c(status);
  if (observed) imu->integrator.correct(*observed);
  return to_c(plvo::Status());
}

plvo_status plvo_imu_gyro_offset(const plvo_imu* imu, double offset[3], double variance[3]) {
  if (imu == nullptr) return to_c(refuse(plvo::c::kNoImu));
  for (int axis = 0; axis < 3; ++axis) {
    if (offset != nullptr) offset[axis] = imu->integrator.gyro_offset()[axis];
    if (variance != nullptr) variance[axis] = imu->integrator.gyro_offset_variance()[axis];
  }
  return to_c(plvo::Status());
}

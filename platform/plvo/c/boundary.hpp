// SPDX-License-Identifier: Apache-2.0
// What crosses between C and the library: statuses, blocks of memory, and structs whose sizes tell how their
// caller was compiled.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

#include "plvo/base/status.hpp"
#include "plvo/c/imu.h"
#include "plvo/c/map.h"
#include "plvo/c/plvo.h"
#include "plvo/camera/camera_model.hpp"
#include "plvo/odometry/track_result.hpp"

namespace plvo::c {

// The size of each struct when it was first released: no caller has a smaller one.
template <typename Struct>
inline constexpr std::size_t kFirstSize = 0;
template <typename Struct, typename Member>
constexpr std::size_t end_of(std::size_t offset, Member Struct::*) {
  return offset + sizeof(Member);
}
template <>
inline constexpr std::size_t kFirstSize<plvo_camera> = end_of(offsetof(plvo_camera, depth_readout_s),
                                                              &plvo_camera::depth_readout_s);
template <>
inline constexpr std::size_t kFirstSize<plvo_limits> = end_of(offsetof(plvo_limits, segments),
                                                              &plvo_limits::segments);
template <>
inline constexpr std::size_t kFirstSize<plvo_config> = end_of(offsetof(plvo_config, stage_clock),
                                                              &plvo_config::stage_clock);
template <>
inline constexpr std::size_t kFirstSize<plvo_frame> = end_of(offsetof(plvo_frame, metres_per_unit),
                                                             &plvo_frame::metres_per_unit);
template <>
inline constexpr std::size_t kFirstSize<plvo_prior> = end_of(offsetof(plvo_prior, gravity_offset_sigma),
                                                             &plvo_prior::gravity_offset_sigma);
template <>
inline constexpr std::size_t kFirstSize<plvo_result> = end_of(offsetof(plvo_result, stage_ns),
                                                              &plvo_result::stage_ns);
template <>
inline constexpr std::size_t kFirstSize<plvo_imu_config> = end_of(offsetof(plvo_imu_config, longest_gap_s),
                                                                  &plvo_imu_config::longest_gap_s);
template <>
inline constexpr std::size_t kFirstSize<plvo_map_limits> = end_of(offsetof(plvo_map_limits, segments),
                                                                  &plvo_map_limits::segments);
template <>
inline constexpr std::size_t kFirstSize<plvo_map_result> = end_of(offsetof(plvo_map_result, T_into_removed),
                                                                  &plvo_map_result::T_into_removed);

// kInvalidArgument unless the struct is there and its size one that this library knows.
template <typename Struct>
Status check_struct(const Struct* given, const char* name) {
  if (given == nullptr) return Status(StatusCode::kInvalidArgument, name).append(" is NULL");
  if (given->struct_size < kFirstSize<Struct>)
    return Status(StatusCode::kInvalidArgument, name)
        .append(".struct_size is ")
        .append(static_cast<std::ptrdiff_t>(given->struct_size))
        .append("; set it to sizeof(plvo_")
        .append(name)
        .append(")");
  if (given->struct_size > sizeof(Struct))
    return Status(StatusCode::kInvalidArgument, name)
        .append(".struct_size is ")
        .append(static_cast<std::ptrdiff_t>(given->struct_size))
        .append(" and this library knows ")
        .append(static_cast<std::ptrdiff_t>(sizeof(Struct)))
        .append(" bytes: the program was compiled for a newer plvo");
  return {};
}

// Overwrites as much of `whole`, which holds the defaults, as the caller knows of.
template <typename Struct>
Status take_struct(const Struct* given, Struct& whole, const char* name) {
  if (Status status = check_struct(given, name); !status.ok()) return status;
  std::memcpy(&whole, given, given->struct_size);
  return {};
}

// The caller's struct_size stays what it is. The size must have been checked.
template <typename Struct>
void give_struct(Struct whole, Struct* caller) {
  whole.struct_size = caller->struct_size;
  std::memcpy(caller, &whole, caller->struct_size);
}

// What every plvo_…_init of a struct does. A struct of another size is left alone but for its size, by which
// the next function refuses it.
template <typename Struct>
void init_struct(const Struct& defaults, Struct* caller, std::size_t size) {
  caller->struct_size = static_cast<std::uint32_t>(size);
  if (check_struct(caller, "").ok()) give_struct(defaults, caller);
}

inline plvo_status to_c(const Status& status) {
  plvo_status result;
  static_assert(sizeof result.message >= Status::kCapacity && sizeof result == 256);
  std::memset(&result, 0, sizeof result);
  result.code = static_cast<std::int32_t>(status.code());
  std::memcpy(result.message, status.message(), std::strlen(status.message()));
  return result;
}

inline Status refuse(const char* why) { return {StatusCode::kInvalidArgument, why}; }

// kOutOfMemory, and how many bytes are needed.
Status too_small(const char* for_what, std::size_t needed, std::size_t bytes);

// The part of the caller's block that begins at the first aligned address. bytes: more than kArenaAlignment.
std::span<std::byte> aligned_part(void* memory, std::size_t bytes);

plvo_camera to_c(const CameraModel& model);
// kInvalidArgument for an unknown lens model; CameraModel::validate checks the rest.
Status take_camera(const plvo_camera* given, CameraModel& model);
// As give_struct; kInvalidArgument where the caller's struct has no room for the lens.
Status give_camera(const plvo_camera& whole, plvo_camera* caller);

// State, stamps, poses, covariances, world and restart of a result of plvo_track. kInvalidArgument for an
// unknown state; the numbers are not checked.
Status take_result(const plvo_result* given, TrackResult& result);

}  // namespace plvo::c

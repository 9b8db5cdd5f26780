// SPDX-License-Identifier: Apache-2.0
// The map behind map.h. Its handle stands at the front of the caller's block; the core's memory follows.
#include <new>
#include <span>
#include <type_traits>

#include "plvo/c/boundary.hpp"
#include "plvo/c/map.h"
#include "plvo/c/matrices.hpp"
#include "plvo/c/odometry_handle.hpp"
#include "plvo/map/map.hpp"

struct plvo_map {
  plvo::Map map;
};
static_assert(std::is_trivially_destructible_v<plvo_map>,
              "it is never destroyed: the caller only frees its memory");

namespace plvo::c {
namespace {

constexpr std::size_t kMapHandleBytes = align_up(sizeof(plvo_map));
constexpr const char* kNoMap = "map is NULL: plvo_map_init comes first";

plvo_map_limits limits_to_c(const MapLimits& limits) {
  return {sizeof(plvo_map_limits), limits.keyframes, limits.keypoints, limits.segments};
}

Status take_map_limits(const plvo_map_limits* given, MapLimits& limits) {
  if (given == nullptr) return {};
  plvo_map_limits whole = limits_to_c(limits);
  if (Status status = take_struct(given, whole, "map_limits"); !status.ok()) return status;
  limits = {whole.keyframes, whole.keypoints, whole.segments};
  return limits.validate();
}

Status take_map_camera(const plvo_camera* given, CameraModel& model) {
  const Status status = take_camera(given, model);
  return status.ok() ? model.validate() : status;
}

std::size_t map_bytes_for(const MapLimits& limits, const CameraModel& camera) {
  return Map::required_bytes(limits, camera.width, camera.height) + kMapHandleBytes + kArenaAlignment;
}

// What Map::update looks at.
Status take_tracked(const plvo_result* given, TrackResult& result) {
  if (Status taken = take_result(given, result); !taken.ok()) return taken;
  return make_sound(result) ? Status()
                            : refuse("result: a number is not finite, or a matrix is not a rotation");
}

void give_map_result(const MapResult& in_map, plvo_map_result* caller) {
  plvo_map_result whole;
  std::memset(&whole, 0, sizeof whole);
  whole.located = in_map.located ? 1 : 0;
  whole.recognised = in_map.recognised ? 1 : 0;
  whole.keyframe = in_map.keyframe;
  put(in_map.T_map_world, whole.T_map_world);
  put(in_map.pose_covariance, whole.pose_covariance);
  put(in_map.T_keyframe_camera, whole.T_keyframe_camera);
  whole.removed = in_map.removed;
  whole.removed_into = in_map.removed_into;
  put(in_map.T_into_removed, whole.T_into_removed);
  give_struct(whole, caller);
}

Status handed(std::int32_t failed, const char* function) {
  if (failed == 0) return {};
  return Status(StatusCode::kIo, "the program's function to ").append(function).append(" the map failed");
}

class CallerSink final : public ByteSink {
 public:
  CallerSink(plvo_map_write function, void* context) : write_(function), context_(context) {}
  Status write(std::span<const std::byte> piece) override {
    return handed(write_(context_, piece.data(), piece.size()), "write");
  }

 private:
  plvo_map_write write_;
  void* context_;
};

class CallerSource final : public ByteSource {
 public:
  CallerSource(plvo_map_read function, void* context) : read_(function), context_(context) {}
  Status read(std::span<std::byte> piece) override {
    return handed(read_(context_, piece.data(), piece.size()), "read");
  }

 private:
  plvo_map_read read_;
  void* context_;
};

}  // namespace
}  // namespace plvo::c

using plvo::c::refuse;
using plvo::c::to_c;

void plvo_map_limits_init(plvo_map_limits* limits, std::size_t size) {
  plvo::c::init_struct(plvo::c::limits_to_c(plvo::MapLimits()), limits, size);
}

std::size_t plvo_map_required_bytes(const plvo_camera* camera, const plvo_map_limits* limits) {
  plvo::MapLimits known_limits;
  plvo::CameraModel model;
  if (!plvo::c::take_map_limits(limits, known_limits).ok() || !plvo::c::take_map_camera(camera, model).ok())
    return 0;
  return plvo::c::map_bytes_for(known_limits, model);
}

plvo_status plvo_map_init(void* memory, std::size_t bytes, const plvo_camera* camera,
                          const plvo_config* config, const plvo_map_limits* limits, plvo_map** map) {
  if (map == nullptr) return to_c(refuse("map is NULL: nowhere to put the new one"));
  *map = nullptr;
  if (memory == nullptr) return to_c(refuse("memory is NULL"));
  plvo::MapLimits known_limits;
  plvo::CameraModel model;
  plvo::Config known_config;
  for (const plvo::Status& status :
       {plvo::c::take_map_limits(limits, known_limits), plvo::c::take_map_camera(camera, model),
        plvo::c::take_config(config, known_config)})
    if (!status.ok()) return to_c(status);
  const std::size_t needed = plvo::c::map_bytes_for(known_limits, model);
  if (bytes < needed) return to_c(plvo::c::too_small("for these map limits", needed, bytes));

  const std::span<std::byte> block = plvo::c::aligned_part(memory, bytes);
  auto* handle = new (block.data()) plvo_map;
  const plvo::Status status =
      handle->map.init(block.subspan(plvo::c::kMapHandleBytes), model, known_config, known_limits);
  if (status.ok()) *map = handle;
  return to_c(status);
}

plvo_status plvo_map_update(plvo_map* map, const plvo_odometry* odometry, const plvo_result* result,
                            plvo_map_result* in_map) {
  if (map == nullptr) return to_c(refuse(plvo::c::kNoMap));
  if (odometry == nullptr) return to_c(refuse(plvo::c::kNoOdometry));
  if (plvo::Status known = plvo::c::check_struct(in_map, "map_result"); !known.ok()) return to_c(known);
  plvo::TrackResult tracked;
  if (plvo::Status taken = plvo::c::take_tracked(result, tracked); !taken.ok()) return to_c(taken);
  plvo::c::give_map_result(map->map.update(odometry->odometry, tracked), in_map);
  return to_c(plvo::Status());
}

plvo_status plvo_map_settle(plvo_map* map) {
  if (map == nullptr) return to_c(refuse(plvo::c::kNoMap));
  (void)map->map.settle();
  return to_c(plvo::Status());
}

std::int32_t plvo_map_keyframe_pose(const plvo_map* map, std::uint32_t keyframe, double T[12]) {
  if (map == nullptr || T == nullptr) return 0;
  const std::optional<plvo::Se3> pose = map->map.keyframe_pose(keyframe);
  if (!pose) return 0;
  double values[12];
  plvo::c::put(*pose, values);
  std::memcpy(T, values, sizeof values);
  return 1;
}

std::size_t plvo_map_keyframes(const plvo_map* map) { return map == nullptr ? 0 : map->map.graph().size(); }
std::size_t plvo_map_loops(const plvo_map* map) {
  return map == nullptr ? 0 : map->map.graph().loops().size();
}
std::size_t plvo_map_saved_bytes(const plvo_map* map) { return map == nullptr ? 0 : map->map.saved_bytes(); }

plvo_status plvo_map_save(plvo_map* map, plvo_map_write write, void* context) {
  if (map == nullptr) return to_c(refuse(plvo::c::kNoMap));
  if (write == nullptr) return to_c(refuse("write is NULL: it must take the bytes of the map"));
  plvo::c::CallerSink sink(write, context);
  return to_c(map->map.save(sink));
}

plvo_status plvo_map_load(plvo_map* map, plvo_map_read read, void* context) {
  if (map == nullptr) return to_c(refuse(plvo::c::kNoMap));
  if (read == nullptr) return to_c(refuse("read is NULL: it must give the bytes of the map"));
  plvo::c::CallerSource source(read, context);
  return to_c(map->map.load(source));
}

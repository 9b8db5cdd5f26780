/* SPDX-License-Identifier: Apache-2.0 */
/* A map of the places that the camera has seen, for C. Like the odometry it lives in a block of the caller's,
 * takes no memory of its own and needs no end. C99.
 *
 *   status = plvo_track(odometry, &frame, &result);
 *   plvo_map_update(map, odometry, &result, &in_map);  // for each frame, in their order
 *   if (in_map.located) ...                            // in_map.T_map_world * result.T_world_camera
 */
#ifndef PLVO_C_MAP_H
#define PLVO_C_MAP_H

#include "plvo/c/plvo.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Capacities. They decide the memory, and are never exceeded. */
typedef struct plvo_map_limits {
  uint32_t struct_size;
  int32_t keyframes; /* 8 to 512 */
  int32_t keypoints; /* of a keyframe, 50 to 400 */
  int32_t segments;  /* of a keyframe, with 3D lines, 1 to 256 */
} plvo_map_limits;

/* Sets struct_size and the defaults. */
PLVO_API void plvo_map_limits_init(plvo_map_limits* limits, size_t size);

/* Matrices as in plvo_result. */
typedef struct plvo_map_result {
  uint32_t struct_size;
  /* 1: it is known where the camera is in the map. 0 after plvo_map_load, and in another plvo_result.world,
   * until a place is recognised: T_map_world has no meaning, and pose_covariance is large. */
  int32_t located;
  int32_t recognised; /* 1: a place was, in this frame */
  uint32_t keyframe;  /* the latest one; 0: none yet */
  double T_map_world[12];
  double pose_covariance[36]; /* of the camera in the map */
  /* With plvo_map_keyframe_pose of a later time, the pose of this frame with the corrections that came since.
   */
  double T_keyframe_camera[12];
  /* A keyframe that made room in this frame, or 0, and its pose relative to one that stays. */
  uint32_t removed, removed_into;
  double T_into_removed[12];
} plvo_map_result;

typedef struct plvo_map plvo_map;

/* Bytes of the block that plvo_map_init needs, wherever it starts; 0 for limits or a camera that it would
 * refuse. NULL for `limits`: the defaults, 256 keyframes. */
PLVO_API size_t plvo_map_required_bytes(const plvo_camera* camera, const plvo_map_limits* limits);

/* camera, config: those of the odometry. On failure *map is NULL. */
PLVO_API plvo_status plvo_map_init(void* memory, size_t bytes, const plvo_camera* camera,
                                   const plvo_config* config, const plvo_map_limits* limits, plvo_map** map);

/* Right after plvo_track, with what it gave. Does a bounded part of the work that waits. */
PLVO_API plvo_status plvo_map_update(plvo_map* map, const plvo_odometry* odometry, const plvo_result* result,
                                     plvo_map_result* in_map);

/* Does all the work that waits, however long it takes; for the end of a run. */
PLVO_API plvo_status plvo_map_settle(plvo_map* map);

/* The pose of a keyframe as it is known now: T_map_keyframe. Returns 0, and writes nothing, if it was removed
 * or its place in the map is not known. */
PLVO_API int32_t plvo_map_keyframe_pose(const plvo_map* map, uint32_t keyframe, double T[12]);

/* How many keyframes the map holds, and how many pairs of them are joined as the same place. */
PLVO_API size_t plvo_map_keyframes(const plvo_map* map);
PLVO_API size_t plvo_map_loops(const plvo_map* map);

/* Takes, or fills, all `count` bytes, and returns 0; another number ends plvo_map_save or plvo_map_load with
 * PLVO_IO. */
typedef int32_t (*plvo_map_write)(void* context, const void* bytes, size_t count);
typedef int32_t (*plvo_map_read)(void* context, void* bytes, size_t count);

/* Settles the map, then writes it in blocks. plvo_map_saved_bytes says how many bytes that is: exactly after
 * plvo_map_settle; before, pairs may join. The bytes are the same on every platform. PLVO_NOT_FOUND: it holds
 * no keyframe yet. Write to a new file, and rename it when it is whole. */
PLVO_API plvo_status plvo_map_save(plvo_map* map, plvo_map_write write, void* context);
PLVO_API size_t plvo_map_saved_bytes(const plvo_map* map);

/* Replaces the map by a saved one. The camera is not located until it sees a place of the map. On failure the
 * map is empty: PLVO_DAMAGED, PLVO_UNSUPPORTED (another format), PLVO_INVALID_ARGUMENT (another camera),
 * PLVO_OUT_OF_MEMORY (these limits hold less), PLVO_IO. */
PLVO_API plvo_status plvo_map_load(plvo_map* map, plvo_map_read read, void* context);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* The functions of docs/user/c.md, as C11 gives them to C++. */
#ifndef PLVO_TESTS_C_PAGE_FUNCTIONS_H
#define PLVO_TESTS_C_PAGE_FUNCTIONS_H

#include "plvo/c/imu.h"
#include "plvo/c/map.h"
#include "plvo/c/plvo.h"
#include "plvo/c/thread_pair.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The page's clock: each look at it is 60 ms later than the one before, and so is every frame too late. */
int64_t now_ns(void);

plvo_status start_tiny(const plvo_camera* camera, plvo_odometry** odometry);
plvo_status track_in_time(plvo_odometry* odometry, const plvo_frame* frame, plvo_result* result);
plvo_status track_turned(plvo_odometry* odometry, const plvo_frame* frame, const double R[9],
                         plvo_result* result);
plvo_status track_driven(plvo_odometry* odometry, const plvo_frame* frame, double seconds, double speed,
                         double turn_rate, const double T_base_camera[12], plvo_result* result);
plvo_status start_imu(plvo_imu** imu);
void on_sample(plvo_imu* imu, int64_t stamp_ns, const double rate[3], const double force[3]);
plvo_status track_with_imu(plvo_odometry* odometry, plvo_imu* imu, const plvo_frame* frame,
                           plvo_result* result);
plvo_status start_on_two_cores(plvo_thread_pair* pair, const plvo_camera* camera,
                               void (*feed)(void* watchdog, int32_t stage), void* watchdog,
                               plvo_odometry** odometry);

plvo_status save_map(plvo_map* map, const char* path, const char* part);
plvo_status load_map(plvo_map* map, const char* path);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0 */
/* A second core for C, on a machine with threads. C99.
 *
 *   plvo_thread_pair* pair;
 *   plvo_status status = plvo_thread_pair_start(&pair);
 *   limits.cores = 2;
 *   config.executor = plvo_thread_pair_run;
 *   config.executor_runner = pair;
 *
 * Unlike the odometry it takes memory from the heap, and a thread, which waits without taking time while
 * there is nothing for it to do. */
#ifndef PLVO_C_THREAD_PAIR_H
#define PLVO_C_THREAD_PAIR_H

#include "plvo/c/plvo.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct plvo_thread_pair plvo_thread_pair;

/* On failure *pair is NULL. */
PLVO_API plvo_status plvo_thread_pair_start(plvo_thread_pair** pair);

/* For plvo_config.executor; pair: a plvo_thread_pair, of one odometry alone. */
PLVO_API void plvo_thread_pair_run(void* pair, plvo_task here, plvo_task beside);

/* Nanoseconds of processor time that the second thread took so far, for plvo_frame_took. */
PLVO_API int64_t plvo_thread_pair_cpu_ns(const plvo_thread_pair* pair);

/* After the last plvo_track of the odometry that has it. NULL is allowed. */
PLVO_API void plvo_thread_pair_stop(plvo_thread_pair* pair);

#ifdef __cplusplus
}
#endif

#endif

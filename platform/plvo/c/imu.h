/* SPDX-License-Identifier: Apache-2.0 */
/* A gyro and an accelerometer for C: their samples in, a prior for each frame out. Like the odometry it lives
 * in a block of the caller's, takes no memory of its own and needs no end. C99.
 *
 *   plvo_imu_prior(imu, frame.stamp_ns, &prior);  // for each frame, in their order
 *   status = plvo_track_with_prior(odometry, &frame, &prior, &result);
 *   plvo_imu_learn(imu, status.code, &result);
 */
#ifndef PLVO_C_IMU_H
#define PLVO_C_IMU_H

#include "plvo/c/plvo.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the sensors are good for; the defaults are a cheap part's (MPU-6050). Matrices are row-major. */
typedef struct plvo_imu_config {
  uint32_t struct_size;
  /* Samples that may wait for a frame, 2 to 1000000, or 0 for a sensor that is not there; beyond them the
   * oldest is dropped. 0.2 s at 200 Hz is 40. They decide the memory. */
  int32_t gyro_samples, accelerometer_samples;
  /* Turns the sensor's axes into the camera's; a reflection where they are of the other hand. */
  double R_camera_imu[9];
  double gyro_noise;                 /* rad/s/sqrt(Hz), white */
  double gyro_offset_sigma;          /* rad/s, at the start, of each axis; learnt from what is seen */
  double gyro_offset_walk;           /* rad/s/sqrt(s), how it wanders */
  double gyro_scale_sigma;           /* share of the rate, of each axis */
  double accelerometer_noise;        /* m/s^2/sqrt(Hz), white */
  double accelerometer_offset_sigma; /* m/s^2, of each axis */
  /* What the camera itself is accelerated by, SD of each axis in m/s^2, and for how long in one go, s. */
  double acceleration, acceleration_s;
  double longest_gap_s; /* between samples; over a longer one nothing is said */
} plvo_imu_config;

/* Sets struct_size and the defaults. */
PLVO_API void plvo_imu_config_init(plvo_imu_config* config, size_t size);

typedef struct plvo_imu plvo_imu;

/* Bytes of the block that plvo_imu_init needs, wherever it starts; 0 for a config that it would refuse. NULL:
 * the defaults. */
PLVO_API size_t plvo_imu_required_bytes(const plvo_imu_config* config);

/* On failure *imu is NULL. NULL for `config`: the defaults. */
PLVO_API plvo_status plvo_imu_init(void* memory, size_t bytes, const plvo_imu_config* config, plvo_imu** imu);

/* One sample, in the sensor's axes: rad/s; m/s^2, which at rest is 9.8 upwards. Its stamp counts on the clock
 * of the frames. PLVO_INVALID_ARGUMENT, and nothing changes, for one that is not later than the one before,
 * or not finite. */
PLVO_API plvo_status plvo_imu_add_gyro(plvo_imu* imu, int64_t stamp_ns, const double rate[3]);
PLVO_API plvo_status plvo_imu_add_acceleration(plvo_imu* imu, int64_t stamp_ns, const double force[3]);

/* Of the frame at this stamp, since the frame of the call before. Without a rotation at the first call, and
 * where samples are missing; without gravity where the accelerometer said nothing. prior->struct_size must be
 * set. */
PLVO_API plvo_status plvo_imu_prior(plvo_imu* imu, int64_t stamp_ns, plvo_prior* prior);

/* What became of the frame of the last prior: where it was tracked with it, the gyro's offset is learnt.
 * `code` is that of the status which came with the result. */
PLVO_API plvo_status plvo_imu_learn(plvo_imu* imu, int32_t code, const plvo_result* result);

/* What is learnt, rad/s, in the sensor's axes, and the variance of each. Either may be NULL. */
PLVO_API plvo_status plvo_imu_gyro_offset(const plvo_imu* imu, double offset[3], double variance[3]);

#ifdef __cplusplus
}
#endif

#endif

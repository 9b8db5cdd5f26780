/* SPDX-License-Identifier: Apache-2.0 */
/* Recorded sequences and calibrations for C: a folder or a ROS bag as a camera. Unlike the odometry, these
 * read files and take memory from the heap. C99. */
#ifndef PLVO_C_SEQUENCE_H
#define PLVO_C_SEQUENCE_H

#include "plvo/c/plvo.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A calibration by name (tum-fr1, tum-fr2, tum-fr3, 7scenes, kinect-v1-default) or from a file of any form
 * that plvo reads. camera->struct_size must be set (plvo_camera_init). A file that names no image size leaves
 * width and height as they are. metres_per_unit, of the depth, may be NULL. */
PLVO_API plvo_status plvo_camera_builtin(const char* name, plvo_camera* camera, double* metres_per_unit);
PLVO_API plvo_status plvo_camera_read(const char* file, plvo_camera* camera, double* metres_per_unit);

typedef struct plvo_sequence plvo_sequence;

/* Opens a folder with rgb.txt and depth.txt, or with numbered frames, 30 a second, or a recording of ROS.
 * `calibration`: a file, or a name as above, or NULL: the calibration in the folder (calibration.txt and the
 * other names of docs/user/calibration.md), or TUM's camera where the folder has the name of a recording of
 * TUM's; of a bag its camera_info. On failure *sequence is NULL. What is opened is closed by
 * plvo_sequence_close. PLVO_UNSUPPORTED for a recording of ROS if the library was built without them. */
PLVO_API plvo_status plvo_sequence_open(const char* path, const char* calibration, plvo_sequence** sequence);

/* Of a bag. NULL: TUM's topics (/camera/rgb/image_color, /camera/depth/image), else the only one with such
 * images; camera_info beside colour; for plvo_sequence_imu the only sensor_msgs/Imu with such readings. */
typedef struct plvo_bag_topics {
  uint32_t struct_size; /* plvo_bag_topics topics = {sizeof topics}; */
  const char* colour;
  const char* depth;
  const char* camera_info;
  const char* gyro;
  const char* accelerometer;
} plvo_bag_topics;

/* As plvo_sequence_open, with the topics to read; topics may be NULL. */
PLVO_API plvo_status plvo_sequence_open_bag(const char* file, const char* calibration,
                                            const plvo_bag_topics* topics, plvo_sequence** sequence);

/* The camera that the frames obey, and how many pairs of images there are. Images above 2047 pixels a side
 * are scaled down by the smallest whole factor that fits, and the camera is that of the small ones. */
PLVO_API plvo_status plvo_sequence_camera(const plvo_sequence* sequence, plvo_camera* camera);
PLVO_API size_t plvo_sequence_frame_count(const plvo_sequence* sequence);

/* The next frame; its images are valid until the next call. PLVO_DAMAGED: this pair cannot be decoded (the
 * message says why), the next call goes on after it. PLVO_END_OF_STREAM: nothing more will come. */
PLVO_API plvo_status plvo_sequence_next(plvo_sequence* sequence, plvo_frame* frame);

/* rad/s of a gyro; m/s^2 of an accelerometer, which at rest reads 9.8 upwards. */
typedef struct plvo_imu_sample {
  int64_t stamp_ns; /* on the clock of the frames */
  double value[3];  /* in the sensor's axes */
} plvo_imu_sample;

/* Oldest first, stamps increasing; NULL and 0 for a sensor that is not there. */
typedef struct plvo_imu_readings {
  uint32_t struct_size; /* plvo_imu_readings readings = {sizeof readings}; */
  const plvo_imu_sample* gyro;
  size_t gyro_count;
  const plvo_imu_sample* accelerometer;
  size_t accelerometer_count;
  size_t left_out; /* damaged, not finite, or not later than the one before */
} plvo_imu_readings;

/* What a gyro and an accelerometer recorded beside the images: gyroscope.txt and accelerometer.txt of the
 * folder, or sensor_msgs/Imu of the bag. For plvo_imu_add_gyro and plvo_imu_add_acceleration (imu.h). They
 * are all read now, and stay until the next call or the sequence's end. PLVO_NOT_FOUND where there are none,
 * PLVO_INVALID_ARGUMENT where several topics could be meant, PLVO_DAMAGED with the line that is not
 * understood; *readings then has none. */
PLVO_API plvo_status plvo_sequence_imu(plvo_sequence* sequence, plvo_imu_readings* readings);

/* NULL is allowed. */
PLVO_API void plvo_sequence_close(plvo_sequence* sequence);

#ifdef __cplusplus
}
#endif

#endif

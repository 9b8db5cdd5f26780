/* SPDX-License-Identifier: Apache-2.0 */
/* The public API for C, and for every language that calls C: frames in, poses with covariances out. C99.
 *
 *   plvo_limits limits;
 *   plvo_limits_init(&limits, sizeof limits);
 *   size_t bytes = plvo_required_bytes(&limits);
 *   void* memory = malloc(bytes);  // or a static array: the library takes no memory of its own
 *   plvo_odometry* odometry = NULL;
 *   plvo_status status = plvo_init(memory, bytes, &camera, NULL, &limits, &odometry);
 *   plvo_result result = {sizeof result};
 *   status = plvo_track(odometry, &frame, &result);
 *
 * Sizes: the first member of a struct is struct_size, its size as the caller was compiled. A library that is
 * newer than the caller takes the defaults for what it lacks; one that is older refuses the struct and says
 * so. Units: metres, radians, nanoseconds, pixels. The camera looks along z, x is right and y down. Threads:
 * an odometry is used by one thread at a time; several odometries do not know each other. No function
 * throws, and none keeps a pointer to what it was given but plvo_init, which keeps `memory` and what the
 * config's functions are called with. imu.h makes priors of a gyro and an accelerometer, thread_pair.h is a
 * second core, sequence.h reads recorded folders. */
#ifndef PLVO_C_PLVO_H
#define PLVO_C_PLVO_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define PLVO_API __attribute__((visibility("default")))
#else
#define PLVO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Version of the library, as MAJOR.MINOR.PATCH. */
PLVO_API const char* plvo_version(void);

enum {
  PLVO_OK = 0,
  PLVO_INVALID_ARGUMENT,
  PLVO_OUT_OF_MEMORY, /* the block is too small; the message says how many bytes are needed */
  PLVO_NOT_FOUND,
  PLVO_PERMISSION,
  PLVO_BUSY,
  PLVO_DAMAGED, /* this item is lost; the next one may be good */
  PLVO_END_OF_STREAM,
  PLVO_TIMEOUT,
  PLVO_UNPLUGGED,
  PLVO_UNSUPPORTED,
  PLVO_IO,
  PLVO_TOO_FEW_FEATURES,
  PLVO_NO_CONSENSUS,
  PLVO_DEGENERATE,
  PLVO_NOT_CONVERGED
};

/* What went wrong and, in words a user can act on, what to do. The message of PLVO_OK is empty, or a note on
 * the frame. */
typedef struct plvo_status {
  int32_t code;
  char message[252];
} plvo_status;

/* "ok", "invalid_argument", …; "unknown" for a number that is no code. Never NULL. */
PLVO_API const char* plvo_status_name(int32_t code);

/* The lens: Brown-Conrady with or without a denominator (rational_polynomial and plumb_bob of ROS and
 * OpenCV), or the fisheye of Kannala and Brandt (equidistant). */
enum { PLVO_LENS_RATIONAL = 0, PLVO_LENS_EQUIDISTANT = 1 };

/* A pinhole and a lens. Coefficients in OpenCV's and ROS's order: of PLVO_LENS_RATIONAL k1 k2 p1 p2 k3, and
 * k4 k5 k6 in distortion_more; of PLVO_LENS_EQUIDISTANT k1 k2 k3 k4 and then zeros. */
typedef struct plvo_camera {
  uint32_t struct_size;
  int32_t width, height;
  int32_t depth_timing_known; /* 0: the depth's stamps are not looked at */
  double fx, fy, cx, cy;
  double distortion[5];
  double readout_s;       /* rolling shutter: from the first row's exposure to the last's; 0: all at once */
  double depth_delay_s;   /* the depth's middle row is exposed so long after the depth's stamp */
  double depth_readout_s; /* as readout_s, of the depth image */
  double distortion_more[3];
  int64_t lens;         /* PLVO_LENS_… */
  double stamp_sigma_s; /* error of the colour stamps, standard deviation; 0: exact */
} plvo_camera;

/* Capacities. They decide the memory; what does not fit is dropped by a stated rule and counted. */
typedef struct plvo_limits {
  uint32_t struct_size;
  int32_t width, height;       /* the largest image */
  int32_t keypoints, segments; /* per frame */
  int32_t references;          /* frames that one is matched with, 1 to 3; 0: the default, 2 */
  int32_t line_bands;          /* of the image, searched for segments one by one, 1 to 8; 0: the default, 1 */
  int32_t kept_keyframes;      /* after a loss, 0 to 4, or 3 beside 3 references */
  int32_t cores;               /* 2: room for plvo_config.executor; 0: the default, 1 */
  int32_t surfaces;            /* samples of bare surfaces per frame, 0 to 1000; 0: none */
  int32_t mask;                /* 1: room for plvo_config.mask, width * height * 33 / 16 bytes; 0: none */
} plvo_limits;

/* PLVO_PRESET_PAPER: the settings of Lu & Song (2015). PLVO_PRESET_TINY: what the limits of that name have
 * the room for (plvo_limits_of_preset). */
enum { PLVO_PRESET_DEFAULT = 0, PLVO_PRESET_PAPER = 1, PLVO_PRESET_TINY = 2 };
/* 0 leaves it to the preset. */
enum { PLVO_FEATURES_OF_PRESET = 0, PLVO_FEATURES_POINTS, PLVO_FEATURES_LINES, PLVO_FEATURES_BOTH };
enum {
  PLVO_REFERENCE_OF_PRESET = 0,
  PLVO_REFERENCE_PREVIOUS, /* the frame before */
  PLVO_REFERENCE_KEYFRAME,
  PLVO_REFERENCE_BOTH,  /* the keyframe and a recent frame */
  PLVO_REFERENCE_WINDOW /* both and the keyframe before; needs plvo_limits.references = 3 */
};

enum { PLVO_STAGE_IMAGE = 0, PLVO_STAGE_POINTS, PLVO_STAGE_LINES, PLVO_STAGE_MATCHING, PLVO_STAGE_MOTION };

/* A function and what it is called with. */
typedef struct plvo_task {
  void (*call)(void* context);
  void* context;
} plvo_task;

typedef struct plvo_config {
  uint32_t struct_size;
  int32_t preset;    /* PLVO_PRESET_… */
  int32_t features;  /* PLVO_FEATURES_… */
  int32_t reference; /* PLVO_REFERENCE_… */
  uint64_t seed;     /* seeds the random generators */
  /* For plvo_result.stage_ns: a monotonic clock in nanoseconds, or NULL. */
  int64_t (*stage_clock)(void);
  /* What a frame may take, where somebody waits for it (plvo_frame_took); 0: as long as it takes. */
  int64_t frame_budget_ns;
  /* More features again after so many frames in a row that took less than this share of it; 0 leaves it to
   * the preset. */
  int32_t budget_patience_frames;
  double budget_spare_share;
  /* Called when a stage of a frame (PLVO_STAGE_…) is over, several times a frame for matching and motion:
   * where a watchdog is fed between stages. It may not call the odometry. NULL: nothing is. */
  void (*stage_hook)(void* context, int32_t stage);
  void* stage_hook_context;
  /* A second core, where there is one: does both, `here` on the calling thread, and returns when both are
   * done; called several times a frame. It needs plvo_limits.cores = 2. The results are the same bits.
   * plvo_thread_pair_run (thread_pair.h) is one. NULL: one thing after the other. */
  void (*executor)(void* runner, plvo_task here, plvo_task beside);
  void* executor_runner;
  /* 1: a level world. Its y axis points down, its heading is the first camera's; the first frame waits for
   * one whose plvo_prior brings gravity. plvo_set_pose before the first frame comes before it. */
  int32_t level_world;
  /* Pixels that show what travels with the camera (a part of the robot, burnt-in text): a byte for each, 0
   * where the image must not be used. Of the size of the camera's images, before undistortion. The odometry
   * does not copy it: it must stay as it is while the odometry is used. It needs plvo_limits.mask = 1. NULL:
   * all pixels are used. */
  const uint8_t* mask;
  int32_t mask_width, mask_height;
  int64_t mask_stride_bytes; /* from the start of a row to the next; 0: mask_width */
} plvo_config;

/* Each sets struct_size and the defaults. `size` is sizeof of the struct. */
PLVO_API void plvo_camera_init(plvo_camera* camera, size_t size);
PLVO_API void plvo_limits_init(plvo_limits* limits, size_t size);
PLVO_API void plvo_config_init(plvo_config* config, size_t size);

/* The limits that go with a preset: 640x480, but for PLVO_PRESET_TINY, which is 320x240 in 512 KiB.
 * limits->struct_size must be set. */
PLVO_API plvo_status plvo_limits_of_preset(int32_t preset, plvo_limits* limits);

enum { PLVO_PIXELS_GRAY8 = 0, PLVO_PIXELS_RGB8, PLVO_PIXELS_BGR8 };

/* The images stay the caller's; they are read while plvo_track runs, and not afterwards. Both have the
 * camera's size, and depth is registered to colour: 0 is no depth. */
typedef struct plvo_frame {
  uint32_t struct_size;
  int32_t width, height;
  int32_t colour_format;  /* PLVO_PIXELS_… */
  int64_t stamp_ns;       /* of the colour image; strictly increasing */
  int64_t depth_stamp_ns; /* equal to stamp_ns where the camera does not say */
  const uint8_t* colour;
  const uint16_t* depth;
  int64_t colour_stride_bytes, depth_stride_bytes; /* from one row to the next */
  double metres_per_unit;                          /* of the depth: 0.001 for millimetres */
} plvo_frame;

/* PLVO_PREDICTED: nothing could be seen; the pose is new, from plvo_prior alone. */
enum { PLVO_INITIALISING = 0, PLVO_TRACKING, PLVO_LOST, PLVO_PREDICTED };
/* "initialising", "tracking", "lost", "predicted"; "unknown" for another number. Never NULL. */
PLVO_API const char* plvo_state_name(int32_t state);

typedef struct plvo_counts {
  int32_t detected;   /* before the selection; of points, in the latest frame where they were looked for */
  int32_t dropped;    /* beyond the capacity */
  int32_t with_depth; /* lifted to 3D */
  int32_t matched;    /* to the reference */
  int32_t inliers;    /* of the motion */
} plvo_counts;

/* Matrices are row-major: T is the 3×4 matrix [R t]; a covariance is 6×6, position before orientation. */
typedef struct plvo_result {
  uint32_t struct_size;
  /* PLVO_INITIALISING: the frame defines the world, or starts anew from the last good pose (restarted). Where
   * the status is not PLVO_OK, the first usable frame is waited for. */
  int32_t state;
  int64_t stamp_ns, reference_stamp_ns;
  /* Camera to world; the world is the camera of the first frame. While lost, the last good pose. The
   * covariance is that of the position and of the orientation in the axes of the world. */
  double T_world_camera[12];
  double pose_covariance[36];
  /* The motion from the reference to this frame. */
  double T_camera_reference[12];
  double motion_covariance[36];
  plvo_counts points, lines;
  int32_t ransac_iterations, lm_iterations;
  double mean_brightness; /* 0 … 255 */
  int64_t stage_ns[5];    /* PLVO_STAGE_…; zero without plvo_config.stage_clock */
  int32_t relocalised;    /* 1: the view of a keyframe from before a loss corrected the pose */
  int32_t feature_step;   /* of plvo_config.frame_budget_ns: 0, all the features that fit, to 8 */
  /* 1: the colour image is that of the frame before, so the pose is predicted; the state is PLVO_TRACKING,
   * the status PLVO_OK with a message. */
  int32_t repeated;
  /* Of T_world_camera, from 0. Poses in different worlds have no known relation. It rises with plvo_reset,
   * and after a loss so long that the position may be anywhere. */
  uint32_t world;
  /* 1: tracking goes on in the same world after a loss, and the images did not observe the motion meanwhile;
   * pose_covariance includes it. */
  int32_t restarted;
  /* By how much points, lines and surfaces disagree about the motion: the factor by which motion_covariance
   * is multiplied, 1 to 1000. Above 100 the message of the status says so. */
  double disagreement;
} plvo_result;

/* The unit quaternion x y z w (Hamilton, w >= 0) of the rotation in a 3×4 matrix. */
PLVO_API void plvo_quaternion(const double T[12], double xyzw[4]);

typedef struct plvo_odometry plvo_odometry;

/* Bytes of the block that plvo_init needs, wherever it starts; 0 for limits that it would refuse. NULL: the
 * defaults, 640×480. */
PLVO_API size_t plvo_required_bytes(const plvo_limits* limits);

/* Checks everything once and makes an odometry inside `memory`; it needs no end, only the memory back. NULL
 * for `config` or `limits`: the defaults. On failure *odometry is NULL. */
PLVO_API plvo_status plvo_init(void* memory, size_t bytes, const plvo_camera* camera,
                               const plvo_config* config, const plvo_limits* limits,
                               plvo_odometry** odometry);

/* One frame. The status says why there is no new pose (result->state is then not PLVO_TRACKING); the next
 * good frame goes on. A frame of the wrong size, without images, or not later than the one before is refused
 * with PLVO_INVALID_ARGUMENT and changes nothing. */
PLVO_API plvo_status plvo_track(plvo_odometry* odometry, const plvo_frame* frame, plvo_result* result);

/* For plvo_config.frame_budget_ns: what the last plvo_track took, by the caller's clock. The features of the
 * next frames are stepped down after one that took too long, in a fixed order, and up again when there is
 * time to spare; the same words give the same bits. Without a budget it has no effect. */
PLVO_API plvo_status plvo_frame_took(plvo_odometry* odometry, int64_t ns);

/* What sensors other than the camera say of a frame: how the camera moved since the frame before (a gyro,
 * wheel odometry), and where down is (an accelerometer). "Now" is this frame, "before" the one before it that
 * plvo_track did not refuse. Axes are the camera's now; matrices are row-major, 3×3. A part whose has_… is 0
 * is not looked at. Covariances are symmetric and positive definite, variances between 1e-16 and 1e6. */
typedef struct plvo_prior {
  uint32_t struct_size;
  int32_t has_rotation, has_translation, has_gravity;
  double R_now_before[9];        /* X_now = R_now_before X_before for a camera that only turns */
  double rotation_covariance[9]; /* rad^2 */
  double t_now_before[3];        /* where the camera before stands, seen from now, m */
  double translation_covariance[9];
  double down[3];               /* in which things fall, of any length */
  double gravity_covariance[9]; /* of the unit vector, rad^2, of what is new in each frame */
  double gravity_offset_sigma;  /* SD of what stays the same from frame to frame, rad; 0: nothing does */
} plvo_prior;

/* Sets struct_size and says nothing. */
PLVO_API void plvo_prior_init(plvo_prior* prior, size_t size);

/* What wheel odometry measured: a twist of the robot's base that holds for `seconds`. */
typedef struct plvo_wheel_step {
  double seconds;
  double twist[6];       /* vx vy vz wx wy wz, m/s and rad/s, in the axes of the base (x forward, z up) */
  double covariance[36]; /* of the twist, row-major; wheels measure neither vz nor wx nor wy: their variances
                          * say how much the robot bounces and tilts */
} plvo_wheel_step;

/* Rotation and translation of the prior, from the steps since the frame before; gravity stays. error_s: for
 * how long an error of a twist lasts (slip); 0: a step. T_base_camera: where the camera sits, 3×4, row-major.
 * prior->struct_size must be set. PLVO_INVALID_ARGUMENT, and nothing changes, for what is no motion. */
PLVO_API plvo_status plvo_wheel_prior(const plvo_wheel_step* steps, size_t count, double error_s,
                                      const double T_base_camera[12], plvo_prior* prior);

/* plvo_track with a prior: it leads the search for features and joins the estimate. What vision leaves open
 * then has a large covariance and is no loss; a frame that shows nothing is PLVO_PREDICTED, and the status
 * says why. A prior that is no good is refused with its frame. NULL is a prior that says nothing. */
PLVO_API plvo_status plvo_track_with_prior(plvo_odometry* odometry, const plvo_frame* frame,
                                           const plvo_prior* prior, plvo_result* result);

/* As after plvo_init: the next usable frame defines a world, of the next number. */
PLVO_API plvo_status plvo_reset(plvo_odometry* odometry);

/* The pose of the last frame that has one, in a world of the caller's, with the covariance of position and
 * orientation; before the first frame, that of the first usable one. T: 3×4, row-major, within 1e8 m. */
PLVO_API plvo_status plvo_set_pose(plvo_odometry* odometry, const double T_world_camera[12],
                                   const double covariance[36]);

/* For drawing: what the last frame was made of, in pixels of the undistorted image. Each function writes up
 * to `capacity` elements and returns how many there are; with capacity 0 it only counts. */
typedef struct plvo_pixel {
  float u, v;
} plvo_pixel;
typedef struct plvo_segment {
  plvo_pixel a, b;
  int32_t has_3d;
} plvo_segment;
typedef struct plvo_point_track {
  plvo_pixel reference, current;
  int32_t inlier;
} plvo_point_track;
typedef struct plvo_line_track {
  uint32_t reference, current; /* indices into the reference's segments and the frame's */
  int32_t inlier;
} plvo_line_track;

/* None in a frame where points were not looked for, for it will not be matched with. */
PLVO_API size_t plvo_keypoints(const plvo_odometry* odometry, plvo_pixel* keypoints, size_t capacity);
PLVO_API size_t plvo_segments(const plvo_odometry* odometry, plvo_segment* segments, size_t capacity);
PLVO_API size_t plvo_reference_segments(const plvo_odometry* odometry, plvo_segment* segments,
                                        size_t capacity);
PLVO_API size_t plvo_point_tracks(const plvo_odometry* odometry, plvo_point_track* tracks, size_t capacity);
PLVO_API size_t plvo_line_tracks(const plvo_odometry* odometry, plvo_line_track* tracks, size_t capacity);

/* The undistorted grey image: its first pixel, or NULL before the first frame; valid until the next
 * plvo_track. Width and height are the camera's. */
PLVO_API const uint8_t* plvo_image(const plvo_odometry* odometry, int64_t* stride_bytes);

#ifdef __cplusplus
}
#endif

#endif

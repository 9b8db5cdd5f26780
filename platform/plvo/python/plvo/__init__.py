# SPDX-License-Identifier: Apache-2.0
"""RGB-D visual odometry from points and lines. share/doc/plvo/user/python.md has examples."""
import json as _json
import os as _os
import time as _time

from . import _evaluation, _plvo
from ._plvo import Camera, Config, Counts, Error, Features, Frame, Imu, Map, MapResult, MotionPrior, Odometry, RecordedImu, Result, Sequence, __version__

__all__ = [
    "Camera", "Config", "Counts", "Error", "Features", "Frame", "Imu", "Map", "MapResult", "MotionPrior", "Odometry",
    "RecordedImu", "Result", "Sequence", "evaluate", "run",
]


def run(recording, camera=None, config=None, *, imu=False, R_camera_imu=None, cores=1, topics=None, mask=None):
    """Tracks a recorded folder or recording of ROS: a Result for each frame. imu: with the folder's gyroscope.txt and
    accelerometer.txt, or the bag's sensor_msgs/Imu, turned into the camera's axes by R_camera_imu. topics: of a bag, where
    plvo cannot choose by itself; a dictionary with colour, depth, camera_info, gyro or accelerometer. cores: 2 for a second
    thread; the same bits. mask: False or 0 where a pixel must not be used, as in Odometry. A budget of config's is held against the processor time of this thread; results then depend on
    the machine."""
    sequence = Sequence(recording, camera, topics=topics)
    odometry = Odometry(sequence.camera, config, cores=cores, mask=mask)
    readings = sequence.imu(R_camera_imu=R_camera_imu) if imu else None
    for frame in sequence:
        began_ns = _time.thread_time_ns()
        result = odometry.track(*frame, prior=readings and readings.prior(frame.stamp_ns))
        odometry.frame_took(_time.thread_time_ns() - began_ns)
        if readings:
            readings.learn(result)
        yield result


def evaluate(truth, estimate, *, sampling="interpolated", max_difference_s=0.02, offset_s=0.0, rpe_deltas=("1f", "1s"),
             truth_sigma=(0.0, 0.0), fit_truth=False):
    """Errors of an estimate, which is a file or an iterable of Result, against the true poses, which are a file, or those of
    a recorded folder or recording of ROS (FILE-groundtruth.txt beside FILE.bag, or its topic of poses): what `plvo eval
    --json` says, as a dictionary. truth_sigma: how far a true pose is off, in each axis (m, rad); joins the covariances in
    the NEES. fit_truth: compare with the truth turned and its clock shifted as explains the estimate best."""
    if isinstance(estimate, (str, bytes, _os.PathLike)):
        estimate = _os.fsencode(estimate)
    text = _evaluation.evaluate(truth, estimate, sampling, max_difference_s, offset_s, list(rpe_deltas),
                                tuple(truth_sigma), fit_truth)
    return _json.loads(text)

# SPDX-License-Identifier: Apache-2.0
"""RGB-D visual odometry from points and lines. share/doc/plvo/user/python.md has examples."""
import json as _json
import os as _os
import time as _time

import numpy as _np

from . import _evaluation, _plvo
from ._plvo import Camera, Config, Counts, Error, Features, Frame, Imu, Map, MapResult, MotionPrior, Odometry, RecordedImu, Result, Sequence, __version__

__all__ = [
    "Camera", "Config", "Counts", "Error", "Features", "Frame", "Imu", "Map", "MapResult", "MotionPrior", "Odometry",
    "RecordedImu", "Result", "Sequence", "Trajectory", "evaluate", "run", "to_dataframe",
]


def _documented(thing):
    """Gives a function, or a class and its members, the docstrings of __init__.pyi."""
    thing.__doc__ = _plvo._docstring(thing.__name__)
    for name, member in vars(thing).items() if isinstance(thing, type) else ():
        if not name.startswith("_"):
            member.__doc__ = _plvo._docstring(f"{thing.__name__}.{name}")
    return thing


@_documented
def run(recording, camera=None, config=None, *, imu=False, R_camera_imu=None, cores=1, topics=None, mask=None):
    sequence = Sequence(recording, camera, topics=topics)
    odometry = Odometry(sequence.camera, config, cores=cores, mask=mask)
    readings = sequence.imu(R_camera_imu=R_camera_imu) if imu else None
    return _results(sequence, odometry, readings)


def _results(sequence, odometry, readings):
    for frame in sequence:
        began_ns = _time.thread_time_ns()
        result = odometry.track(*frame, prior=readings and readings.prior(frame.stamp_ns))
        odometry.frame_took(_time.thread_time_ns() - began_ns)
        if readings:
            readings.learn(result)
        yield result


@_documented
def evaluate(truth, estimate, *, sampling="interpolated", max_difference_s=0.02, offset_s=0.0, rpe_deltas=("1f", "1s"),
             truth_sigma=(0.0, 0.0), fit_truth=False):
    if isinstance(estimate, (str, bytes, _os.PathLike)):
        estimate = _os.fsencode(estimate)
    text = _evaluation.evaluate(truth, estimate, sampling, max_difference_s, offset_s, list(rpe_deltas),
                                tuple(truth_sigma), fit_truth)
    return _json.loads(text)


def _checked(results):
    for result in results:
        if not isinstance(result, Result):
            raise TypeError(f"results: expected plvo.Result objects, got {type(result).__name__}")
        yield result


@_documented
class Trajectory:
    def __init__(self, results):
        posed = [result for result in _checked(results) if result.has_pose]
        self._stamps_ns = _np.array([r.stamp_ns for r in posed], dtype=_np.int64)
        self._positions = _np.array([r.position for r in posed], dtype=float).reshape(-1, 3)
        self._quaternions = _np.array([r.quaternion for r in posed], dtype=float).reshape(-1, 4)

    stamps_ns = property(lambda self: self._stamps_ns)
    positions = property(lambda self: self._positions)
    quaternions = property(lambda self: self._quaternions)

    def __len__(self):
        return len(self._stamps_ns)

    def __repr__(self):
        return f"<plvo.Trajectory of {len(self)} poses>"

    def __eq__(self, other):
        if not isinstance(other, Trajectory):
            return NotImplemented
        return all(_np.array_equal(a, b) for a, b in ((self.stamps_ns, other.stamps_ns), (self.positions, other.positions),
                                                      (self.quaternions, other.quaternions)))

    __hash__ = None

    def save(self, path):
        with open(path, "w", encoding="ascii") as file:
            file.write("# timestamp tx ty tz qx qy qz qw\n")
            for stamp, p, q in zip(self.stamps_ns.tolist(), self.positions, self.quaternions):
                seconds, rest = divmod(stamp, 10**9)
                file.write(f"{seconds}.{rest:09d} " + " ".join(f"{value:.9f}" for value in (*p, *q)) + "\n")


@_documented
def to_dataframe(results):
    try:
        import pandas
    except ImportError as error:
        raise ImportError("plvo.to_dataframe needs pandas: sudo apt install python3-pandas, or pip install pandas") from error
    rows = []
    for result in _checked(results):
        pose = (*result.position.ravel(), *result.quaternion) if result.has_pose else (_np.nan,) * 7
        sigma = _np.sqrt(_np.diag(result.covariance)) if result.has_pose else (_np.nan,) * 6
        row = {"stamp_ns": result.stamp_ns, "state": result.state, "message": result.message}
        row.update(zip(("tx", "ty", "tz", "qx", "qy", "qz", "qw"), pose))
        row.update(zip(("sigma_x", "sigma_y", "sigma_z", "sigma_rx", "sigma_ry", "sigma_rz"), sigma))
        for kind in ("points", "lines"):
            counts = getattr(result, kind)
            row.update({f"{kind}_{name}": getattr(counts, name) for name in ("detected", "with_depth", "matched", "inliers")})
        rows.append(row)
    return pandas.DataFrame(rows)

# SPDX-License-Identifier: Apache-2.0
"""RGB-D visual odometry from points and lines. docs/python.md has examples."""
import json as _json
import os as _os

from . import _evaluation, _plvo
from ._plvo import Camera, Config, Counts, Error, Features, Frame, Odometry, Result, Sequence, __version__

__all__ = ["Camera", "Config", "Counts", "Error", "Features", "Frame", "Odometry", "Result", "Sequence", "evaluate", "run"]


def run(folder, camera=None, config=None):
    """Tracks a recorded folder: a Result for each frame."""
    sequence = Sequence(folder, camera)
    odometry = Odometry(sequence.camera, config)
    for frame in sequence:
        yield odometry.track(*frame)


def evaluate(truth, estimate, *, sampling="interpolated", max_difference_s=0.02, offset_s=0.0, rpe_deltas=("1f", "1s")):
    """Errors of an estimate, which is a file or an iterable of Result, against the file of the true poses: what
    `plvo eval --json` says, as a dictionary."""
    if isinstance(estimate, (str, bytes, _os.PathLike)):
        estimate = _os.fsdecode(estimate)
    text = _evaluation.evaluate(_os.fsdecode(truth), estimate, sampling, max_difference_s, offset_s, list(rpe_deltas))
    return _json.loads(text)

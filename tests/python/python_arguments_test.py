# SPDX-License-Identifier: Apache-2.0
"""Whatever is handed to the package, in whatever place: a TypeError, a ValueError or plvo.Error, or it works."""
import math
import os
import shutil

import numpy as np
import pytest

import plvo
from python_stubs_test import runtime_parameters

EYE = np.eye(3)
PINHOLE = {"width": 320, "height": 240, "fx": 277, "fy": 277, "cx": 159.5, "cy": 119.5}
CAMERA = plvo.Camera(**PINHOLE, depth_units_per_metre=5000)
CLASSES = [getattr(plvo, name) for name in plvo.__all__ if isinstance(getattr(plvo, name), type)]
BOUND = [cls for cls in CLASSES if cls.__module__ == "plvo._plvo"]


class Odd:
    """Has no meaning for anybody."""


class Failing:
    def __fspath__(self):
        raise ZeroDivisionError


WRONG = [
    None, True, 3, -1, 2**31, -(2**40), 2**64, 10**400, 3.5, math.nan, math.inf, "", "x", "a\0b", "\udcff", "\ud800", b"", b"\xff",
    b"a\0b", (), [1], ["x"], [None], (1, 2), ("a", "b"), (EYE, "x"), {}, {"colour": 3}, {3: "x"}, {b"\xff": b"\xff"}, Odd(), Odd, len,
    EYE, np.zeros((0, 0)), np.zeros(()), np.array(["x"]), np.array([Odd()]), np.float32(2), np.int64(-5), iter([3]), range(3),
    CAMERA, plvo.Config(), plvo.MotionPrior(), plvo.Imu(), *(cls.__new__(cls) for cls in BOUND),
]


def results(recording):
    return [result for result, _ in zip(plvo.run(recording), range(3))]


def fresh(recording):
    """An odometry that has seen a frame, and the next one."""
    sequence = plvo.Sequence(recording)
    odometry = plvo.Odometry(sequence.camera)
    odometry.track(*next(sequence))
    return odometry, next(sequence)


def places(recording):
    """Name, what is called, and one right argument for each parameter."""
    odometry, frame = fresh(recording)
    return [
        ("Camera", plvo.Camera, {**PINHOLE, "distortion": (0.1, 0, 0, 0), "depth_units_per_metre": 1000, "readout_s": 0.0,
                                 "depth_delay_s": 0.0, "depth_readout_s": 0.0, "distortion_model": "plumb_bob", "stamp_sigma_s": 0.0}),
        ("Camera.builtin", plvo.Camera.builtin, {"name": "tum-fr1"}),
        ("Camera.read", plvo.Camera.read, {"path": recording / "calibration.txt"}),
        ("Config", plvo.Config, {"preset": "default", "features": None, "reference": None, "seed": None, "frame_budget_ns": 0,
                                 "budget_patience_frames": 10, "budget_spare_share": 0.5, "level_world": False}),
        ("MotionPrior", plvo.MotionPrior, {"rotation": (EYE, EYE), "translation": ([0, 0, 0], EYE), "gravity": ([0, 1, 0], EYE),
                                           "gravity_offset_sigma": 0.0}),
        ("MotionPrior.of_wheels", plvo.MotionPrior.of_wheels, {"steps": [(0.1, np.ones(6), np.eye(6))], "T_base_camera": np.eye(4),
                                                               "error_s": 0.0}),
        ("Imu", plvo.Imu, {"R_camera_imu": EYE, "gyro_noise": 1e-3, "gyro_offset_sigma": 1e-3, "gyro_offset_walk": 1e-3,
                           "gyro_scale_sigma": 1e-3, "accelerometer_noise": 1e-2, "accelerometer_offset_sigma": 1e-2,
                           "acceleration": 0.5, "acceleration_s": 0.5, "longest_gap_s": 0.1}),
        ("Imu.add_gyro", plvo.Imu().add_gyro, {"stamp_ns": 1, "rate": [0, 0, 0]}),
        ("Imu.add_acceleration", plvo.Imu().add_acceleration, {"stamp_ns": 1, "force": [0, 0, 0]}),
        ("Imu.prior", plvo.Imu().prior, {"stamp_ns": 1}),
        ("Imu.learn", plvo.Imu().learn, {"result": results(recording)[0]}),
        ("RecordedImu.prior", plvo.Sequence(recording).imu().prior, {"stamp_ns": 1}),
        ("RecordedImu.learn", plvo.Sequence(recording).imu().learn, {"result": results(recording)[0]}),
        ("Odometry", plvo.Odometry, {"camera": CAMERA, "config": None, "keypoints": None, "segments": None, "references": None,
                                     "line_bands": None, "kept_keyframes": None, "surfaces": None, "cores": 1, "mask": None}),
        ("Odometry.track", odometry.track, {"colour": frame.colour, "depth": frame.depth, "stamp_ns": frame.stamp_ns,
                                            "depth_stamp_ns": None, "bgr": False, "prior": None}),
        ("Odometry.frame_took", odometry.frame_took, {"ns": 1}),
        ("Odometry.set_pose", odometry.set_pose, {"T_world_camera": np.eye(4), "covariance": np.eye(6)}),
        ("Map", plvo.Map, {"camera": CAMERA, "config": None, "keyframes": 8, "keypoints": 100, "segments": 32}),
        ("Map.update", plvo.Map(CAMERA).update, {"odometry": odometry, "result": results(recording)[0]}),
        # An empty map: nothing is saved.
        ("Map.save", plvo.Map(CAMERA).save, {"path": recording.parent / "empty.map"}),
        ("Map.load", plvo.Map(CAMERA).load, {"path": recording.parent / "none.map"}),
        ("Map.keyframe_pose", plvo.Map(CAMERA).keyframe_pose, {"keyframe": 1}),
        ("Sequence", plvo.Sequence, {"recording": recording, "camera": None, "topics": None}),
        ("Sequence.imu", plvo.Sequence(recording).imu, {"R_camera_imu": EYE}),
        ("run", lambda **given: next(plvo.run(**given)), {"recording": recording, "camera": None, "config": None, "imu": True,
                                                          "R_camera_imu": EYE, "cores": 1, "topics": None, "mask": None}),
        ("evaluate", plvo.evaluate, {"truth": recording / "groundtruth.txt", "estimate": recording / "groundtruth.txt",
                                     "sampling": "interpolated", "max_difference_s": 0.02, "offset_s": 0.0, "rpe_deltas": ["1f"],
                                     "truth_sigma": (0.0, 0.0), "fit_truth": False}),
    ]


@pytest.mark.filterwarnings("ignore:The truth value of an empty array")
def test_every_wrong_argument_is_named_for_what_it_is(recording):
    wrong_ones = 0
    for name, call, right in places(recording):
        for parameter in right:
            for wrong in WRONG:
                try:
                    call(**{**right, parameter: wrong})
                except (TypeError, ValueError, plvo.Error):
                    wrong_ones += 1
                except Exception as error:
                    pytest.fail(f"{name}({parameter}={wrong!r}): {error!r}")
    assert wrong_ones > 1000


def test_no_parameter_is_left_out(recording):
    known = {name: set(right) for name, _, right in places(recording)}
    for cls in BOUND:
        for method in ("__init__", *(name for name in vars(cls) if not name.startswith("_"))):
            function = getattr(cls, method)
            if callable(function) and "No constructor" not in (function.__doc__ or "") and (function.__doc__ or "").startswith(method):
                name = cls.__name__ + ("" if method == "__init__" else "." + method)
                assert set(runtime_parameters(function)) == known.get(name, set()), name


def test_elements_are_named_too(recording):
    for call, match in [
        (lambda: plvo.Camera(**PINHOLE, distortion="abcd"), "distortion: expected a number, got str"),
        (lambda: plvo.Camera(**PINHOLE, depth_delay_s="soon"), "depth_delay_s: expected a number, got str"),
        (lambda: plvo.Config(seed="x"), "seed: expected an int from 0 to 18446744073709551615, got str"),
        (lambda: plvo.Config(features=3), "features: expected a str, got int"),
        (lambda: plvo.Odometry(CAMERA, 3), "config: expected a plvo.Config, got int"),
        (lambda: plvo.Map(CAMERA, 3), "config: expected a plvo.Config, got int"),
        (lambda: plvo.Odometry(CAMERA, keypoints=1.5), "keypoints: expected an int from .*, got float"),
        (lambda: fresh(recording)[0].track(*fresh(recording)[1], prior=3), "prior: expected a plvo.MotionPrior, got int"),
        (lambda: plvo.Sequence(recording, topics=3), "topics: expected a dict, got int"),
        (lambda: plvo.Sequence(recording, topics={"depth": 3}), r"topics\['depth'\]: expected a str, got int"),
        (lambda: plvo.Sequence(3), "os.PathLike"),
        (lambda: plvo.evaluate(recording, [3]), "estimate: expected plvo.Result objects, got int"),
        (lambda: plvo.evaluate(recording, 3), "estimate: expected a file or an iterable of plvo.Result objects, got int"),
        (lambda: plvo.evaluate(recording, recording / "groundtruth.txt", rpe_deltas=[1]), "rpe_deltas: expected a str, got int"),
        (lambda: plvo.Odometry.features(3), "self: expected a plvo.Odometry, got int"),
        (lambda: plvo.Sequence.__next__(3), "self: expected a plvo.Sequence, got int"),
        (lambda: plvo.Result.covariance.fget(3), "self: expected a plvo.Result, got int"),
    ]:
        with pytest.raises(TypeError, match=match):
            call()
    for call, match in [
        (lambda: plvo.Config(seed=-1), "seed: expected an int from 0 to 18446744073709551615, got -1"),
        (lambda: plvo.Odometry(CAMERA, surfaces=2**31), "surfaces: expected an int from .* to 2147483647, got 2147483648"),
        (lambda: fresh(recording)[0].track(*fresh(recording)[1][:2], 2, 2**63), "depth_stamp_ns: expected an int from .*, got 9223372036854775808"),
        (lambda: plvo.Sequence("a\0b"), "null character"),
        (lambda: plvo.Sequence("\ud800"), "surrogates not allowed"),
        (lambda: plvo.evaluate("\ud800", recording), "surrogates not allowed"),
    ]:
        with pytest.raises(ValueError, match=match):
            call()


def test_a_path_may_be_any_bytes(recording, tmp_path):
    odd = os.fsencode(tmp_path) + b"/w\xffalk"
    shutil.copytree(os.fsencode(recording), odd)
    assert len(plvo.Sequence(odd)) == len(plvo.Sequence(os.fsdecode(odd))) == 24
    assert plvo.Camera.read(odd + b"/calibration.txt").fx == plvo.Camera.read(recording / "calibration.txt").fx
    truth = odd + b"/groundtruth.txt"
    assert plvo.evaluate(odd, truth) == plvo.evaluate(recording, recording / "groundtruth.txt")
    for call in (plvo.Sequence, plvo.Camera.read, lambda path: plvo.evaluate(path, path)):
        with pytest.raises(plvo.Error, match=r"w\\xffhere"):
            call(os.fsencode(tmp_path) + b"/w\xffhere")


def test_what_was_not_initialised_is_refused(recording):
    odometry, frame = fresh(recording)
    given = {"track": frame, "frame_took": (1,), "set_pose": (np.eye(4),), "prior": (1,), "learn": (results(recording)[0],),
             "add_gyro": (1, [0, 0, 0]), "add_acceleration": (1, [0, 0, 0]), "update": (odometry, results(recording)[0]),
             "save": ("x",), "load": ("x",), "keyframe_pose": (1,)}
    uses = 0
    for cls in BOUND:
        for name in [name for name in dir(cls) if not name.startswith("_")] + ["__next__", "__len__", "__iter__"]:
            if not hasattr(cls, name) or name in ("builtin", "read", "of_wheels"):
                continue
            with pytest.raises(TypeError, match=f"this plvo.{cls.__name__} was not initialised"):
                getattr(cls.__new__(cls), name)(*given.get(name, ()))
            uses += 1
    assert uses > 50

    def new(cls):
        return cls.__new__(cls)

    for call in (
        lambda: repr(new(plvo.Result)),
        lambda: plvo.Sequence(recording, new(plvo.Camera)),
        lambda: plvo.Odometry(new(plvo.Camera)),
        lambda: plvo.Odometry(CAMERA, new(plvo.Config)),
        lambda: odometry.track(*frame, prior=new(plvo.MotionPrior)),
        lambda: plvo.Imu().learn(new(plvo.Result)),
        lambda: plvo.evaluate(recording, [new(plvo.Result)]),
    ):
        with pytest.raises(TypeError, match="was not initialised"):
            call()


def test_what_was_initialised_late_is_like_any_other(recording):
    class Late(plvo.Sequence):
        def __init__(self, path):
            with pytest.raises(TypeError, match="not initialised"):
                len(self)
            with pytest.raises(plvo.Error):
                super().__init__(path / "nowhere")
            with pytest.raises(TypeError, match="not initialised"):
                len(self)
            super().__init__(path)

    assert len(Late(recording)) == len(list(Late(recording))) == 24

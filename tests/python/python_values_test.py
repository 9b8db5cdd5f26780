# SPDX-License-Identifier: Apache-2.0
"""Values behave as Python's users expect: repr, equality, pickling, with blocks, tables and files."""
import copy
import pickle
import sys
import types

import numpy as np
import pytest

import plvo
from python_stubs_test import runtime_parameters


@pytest.fixture(scope="module", name="results")
def tracked(recording):
    return list(plvo.run(recording))


def test_a_camera_has_its_matrix_and_says_what_it_is():
    camera = plvo.Camera(320, 240, fx=277, fy=278, cx=159.5, cy=119.5, depth_units_per_metre=5000)
    assert np.array_equal(camera.K, [[277, 0, 159.5], [0, 278, 119.5], [0, 0, 1]])
    camera.K[0, 0] = 1
    assert camera.K[0, 0] == 277
    assert repr(camera) == (
        "<plvo.Camera 320x240, fx=277 fy=278 cx=159.5 cy=119.5, no distortion, 5000 units of depth per metre>")
    assert "plumb_bob" in repr(plvo.Camera.builtin("tum-fr1"))


EYE = np.eye(3)
WHEELS = ([(0.1, [1, 0, 0, 0, 0, 0.1], 1e-4 * np.eye(6))], np.eye(4))
# A value of each class, and other ones: one for each parameter of its constructor.
PARAMETERS = {
    plvo.Camera: ({"width": 320, "height": 240, "fx": 277, "fy": 278, "cx": 159.5, "cy": 119.5},
                  {"width": 336, "height": 256, "fx": 278, "fy": 279, "cx": 160, "cy": 120, "distortion": (0.1, 0, 0, 0, 0.2),
                   "depth_units_per_metre": 5000, "readout_s": 0.02, "depth_delay_s": 0.01, "depth_readout_s": None,
                   "distortion_model": "equidistant", "stamp_sigma_s": 0.001}),
    plvo.Config: ({}, {"preset": "tiny", "features": "lines", "reference": "window", "seed": 2**64 - 1, "frame_budget_ns": 10**12,
                       "budget_patience_frames": 3, "budget_spare_share": 0.1, "level_world": True}),
    plvo.MotionPrior: ({}, {"rotation": (EYE, EYE), "translation": ([0, 0.1, 1 / 3], EYE), "gravity": ([0, 1, 0], EYE),
                            "gravity_offset_sigma": None}),
}
# What means nothing by itself, with what it needs.
TOGETHER = {
    "depth_readout_s": {"depth_delay_s": 0.01, "depth_readout_s": 0.02},
    "distortion_model": {"distortion": (0.1, 0, 0, 0), "distortion_model": "equidistant"},
    "gravity_offset_sigma": {"gravity": ([0, 1, 0], EYE), "gravity_offset_sigma": 0.01},
}


def variants(cls):
    first, others = PARAMETERS[cls]
    assert set(runtime_parameters(cls.__init__)) == set(first) | set(others), cls
    return [cls(**first)] + [cls(**{**first, **TOGETHER.get(name, {name: other})}) for name, other in others.items()]


@pytest.fixture(scope="module", name="values")
def all_values(recording, results):
    """Of each class that is a value some that differ."""
    cameras = [plvo.Camera.builtin("tum-fr1"), plvo.Camera.builtin("7scenes"), plvo.Camera.read(recording / "calibration.txt")]
    sequence = plvo.Sequence(recording)
    odometry, places = plvo.Odometry(sequence.camera), plvo.Map(sequence.camera, keyframes=8)
    in_map = [places.update(odometry, odometry.track(*frame)) for frame in sequence]
    lost = plvo.Odometry(sequence.camera).track(np.zeros((240, 320), np.uint8), np.zeros((240, 320), np.uint16), 1)
    assert lost.message
    return {
        plvo.Camera: variants(plvo.Camera) + cameras,
        plvo.Config: variants(plvo.Config) + [plvo.Config(preset="paper")],
        plvo.MotionPrior: variants(plvo.MotionPrior) + [plvo.MotionPrior.of_wheels(*WHEELS)],
        plvo.Counts: [results[2].points, results[3].points, results[3].lines],
        plvo.Result: [*results[:4], lost],
        plvo.MapResult: in_map[:4],
    }


def same(one, other):
    return np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other


def test_values_are_equal_where_all_their_numbers_are(values):
    assert set(values) == {cls for cls in vars(plvo).values() if isinstance(cls, type) and "__setstate__" in vars(cls)}
    for cls, different in values.items():
        for i, value in enumerate(different):
            assert [value == other for other in different] == [i == j for j in range(len(different))], value
        assert len({hash(value) for value in different}) == len(different)
        assert different[0] != 3 and not different[0] == "x", cls
    for cls in PARAMETERS:
        assert variants(cls) == variants(cls) and set(variants(cls)) == set(variants(cls))


def test_copies_and_pickled_values_are_equal(values):
    for cls, different in values.items():
        attributes = [name for name in dir(cls) if isinstance(getattr(cls, name), property)]
        assert len(attributes) > 4
        for value in different:
            pickled = [pickle.loads(pickle.dumps(value, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)]
            for other in (*pickled, copy.copy(value), copy.deepcopy(value)):
                assert type(other) is cls and other == value and hash(other) == hash(value) and repr(other) == repr(value)
                assert all(same(getattr(value, name), getattr(other, name)) for name in attributes)


def test_pickled_values_give_the_same_bits(recording):
    def run(camera, config, prior, keep):
        odometry = plvo.Odometry(keep(camera), keep(config))
        return [odometry.track(*frame, prior=keep(prior)) for frame, _ in zip(plvo.Sequence(recording), range(6))]

    camera = plvo.Camera(320, 240, 277.1, 278.2, 159.3, 119.4, (0.01, 0, 0, 0.001, 1e-3), 5000, 0.01, 0.002, 0.005, stamp_sigma_s=1e-4)
    prior = plvo.MotionPrior(rotation=(EYE, 1e-3 * EYE), translation=([0, 0, -0.01], 1e-3 * EYE), gravity=([0, 1, 0], 1e-2 * EYE),
                             gravity_offset_sigma=0.01)
    for config in (plvo.Config(seed=5, level_world=True), plvo.Config(preset="tiny", features="lines")):
        direct = run(camera, config, prior, lambda value: value)
        assert [result.state for result in direct][1:] == ["tracking"] * 5
        assert direct == run(camera, config, prior, lambda value: pickle.loads(pickle.dumps(value)))
    assert direct != run(camera, plvo.Config(seed=6, preset="tiny"), prior, lambda value: value)


def test_what_is_no_pickled_value_is_refused():
    config = plvo.Config()
    version, state = config.__getstate__()
    assert version == plvo.__version__
    for wrong in ((), (version,), (version, state[:-1]), (version, (*state, 1)), (version, 3), (version, tuple("x" for _ in state)), 3):
        with pytest.raises((TypeError, ValueError)):
            plvo.Config.__new__(plvo.Config).__setstate__(wrong)
    with pytest.raises(ValueError, match=r"this was pickled by plvo 0\.0\.1; this is plvo " + version):
        plvo.Config.__new__(plvo.Config).__setstate__(("0.0.1", state))


def test_what_is_no_value_cannot_be_pickled(recording):
    sequence = plvo.Sequence(recording)
    for thing in (sequence, plvo.Odometry(sequence.camera), plvo.Map(sequence.camera, keyframes=8), plvo.Imu(), sequence.imu()):
        with pytest.raises(TypeError, match="cannot pickle"):
            pickle.dumps(thing)
        with pytest.raises(TypeError, match="cannot pickle"):
            copy.deepcopy(thing)


def test_frames_and_errors_can_be_pickled(recording):
    frame = next(plvo.Sequence(recording))
    for other in (pickle.loads(pickle.dumps(frame)), copy.deepcopy(frame)):
        assert type(other) is plvo.Frame and all(map(same, frame, other))
    with pytest.raises(plvo.Error) as raised:
        plvo.Camera.builtin("nikon")
    other = pickle.loads(pickle.dumps(raised.value))
    assert type(other) is plvo.Error and other.code == "not_found" and str(other) == str(raised.value)


def test_values_say_what_they_are(values):
    for cls, parameters in PARAMETERS.items():
        assert all(repr(value).startswith(f"<plvo.{cls.__name__}") for value in values[cls]), parameters
    config = {"preset": "tiny", "features": "lines", "reference": "previous", "seed": 7, "frame_budget_ns": 8,
              "budget_patience_frames": 9, "budget_spare_share": 0.5, "level_world": True}
    assert set(config) == set(runtime_parameters(plvo.Config.__init__))
    assert repr(plvo.Config(**config)) == "<plvo.Config " + " ".join(f"{name}={value!r}" for name, value in config.items()) + ">"
    for name, value in config.items():
        assert getattr(plvo.Config(**config), name) == value
    assert repr(plvo.MotionPrior()) == "<plvo.MotionPrior without a part>"
    assert repr(plvo.MotionPrior(rotation=(EYE, EYE), gravity=([0, 1, 0], EYE))) == "<plvo.MotionPrior of rotation gravity>"
    counts = values[plvo.Counts][0]
    assert repr(counts) == (f"<plvo.Counts detected={counts.detected} dropped={counts.dropped} with_depth={counts.with_depth} "
                            f"matched={counts.matched} inliers={counts.inliers}>")
    assert repr(values[plvo.MapResult][0]) == "<plvo.MapResult located=True recognised=False keyframe=1 removed=0>"


def test_a_sequence_ends_with_its_block(recording):
    with plvo.Sequence(recording) as sequence:
        frame = next(sequence)
    assert frame.colour.any()
    with pytest.raises(ValueError, match="the with block of this sequence has ended"):
        next(sequence)
    with pytest.raises(ZeroDivisionError), plvo.Sequence(recording):
        raise ZeroDivisionError


def test_a_missing_file_fails_at_the_call(tmp_path):
    with pytest.raises(plvo.Error):
        plvo.run(tmp_path / "nowhere")


def test_a_trajectory_is_saved_as_others_read_it(recording, results, tmp_path):
    trajectory = plvo.Trajectory(results)
    assert len(trajectory) == sum(result.has_pose for result in results)
    assert trajectory.positions.shape == (len(trajectory), 3) and trajectory.quaternions.shape == (len(trajectory), 4)
    assert trajectory == plvo.Trajectory(iter(results)) != plvo.Trajectory([])
    assert pickle.loads(pickle.dumps(trajectory)) == trajectory
    trajectory.save(tmp_path / "t.txt")
    saved = plvo.evaluate(recording, tmp_path / "t.txt")
    direct = plvo.evaluate(recording, results)
    assert saved["poses"] == direct["poses"]
    assert saved["ate_m"]["rmse"] == pytest.approx(direct["ate_m"]["rmse"], abs=1e-8)
    with pytest.raises(TypeError, match="results: expected plvo.Result objects, got int"):
        plvo.Trajectory([3])


def test_a_table_needs_pandas_and_says_so(results, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="plvo.to_dataframe needs pandas: sudo apt install python3-pandas"):
        plvo.to_dataframe(results)
    # A stand-in that keeps the rows shows what pandas would get.
    monkeypatch.setitem(sys.modules, "pandas", types.SimpleNamespace(DataFrame=list))
    rows = plvo.to_dataframe(results)
    assert len(rows) == len(results)
    assert rows[3]["stamp_ns"] == results[3].stamp_ns and rows[3]["points_inliers"] == results[3].points.inliers
    assert rows[3]["tx"] == results[3].position[0]
    assert rows[3]["sigma_x"] == pytest.approx(results[3].covariance[0, 0] ** 0.5)
    with pytest.raises(TypeError, match="results: expected"):
        plvo.to_dataframe([3])

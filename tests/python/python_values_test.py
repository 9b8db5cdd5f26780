# SPDX-License-Identifier: Apache-2.0
"""Values behave as Python's users expect: repr, equality, pickling, with blocks, tables and files."""
import pickle
import sys
import types

import numpy as np
import pytest

import plvo


@pytest.fixture(scope="module", name="results")
def tracked(walk):
    return list(plvo.run(walk))


def test_a_camera_has_its_matrix_and_says_what_it_is():
    camera = plvo.Camera(320, 240, fx=277, fy=278, cx=159.5, cy=119.5, depth_units_per_metre=5000)
    assert np.array_equal(camera.K, [[277, 0, 159.5], [0, 278, 119.5], [0, 0, 1]])
    camera.K[0, 0] = 1
    assert camera.K[0, 0] == 277
    assert repr(camera) == (
        "<plvo.Camera 320x240, fx=277 fy=278 cx=159.5 cy=119.5, no distortion, 5000 units of depth per metre>")
    assert "plumb_bob" in repr(plvo.Camera.builtin("tum-fr1"))


def test_counts_are_values(results):
    first, second = results[1].points, results[2].points
    assert first == results[1].points and first != second and first != 3
    assert hash(first) == hash(results[1].points)
    assert pickle.loads(pickle.dumps(first)) == first
    assert repr(first).startswith(f"<plvo.Counts detected={first.detected} dropped=")


def test_a_sequence_ends_with_its_block(walk):
    with plvo.Sequence(walk) as sequence:
        frame = next(sequence)
    assert frame.colour.any()
    with pytest.raises(ValueError, match="the with block of this sequence has ended"):
        next(sequence)
    with pytest.raises(ZeroDivisionError), plvo.Sequence(walk):
        raise ZeroDivisionError


def test_a_missing_file_fails_at_the_call(tmp_path):
    with pytest.raises(plvo.Error):
        plvo.run(tmp_path / "nowhere")


def test_a_trajectory_is_saved_as_others_read_it(walk, results, tmp_path):
    trajectory = plvo.Trajectory(results)
    assert len(trajectory) == sum(result.has_pose for result in results)
    assert trajectory.positions.shape == (len(trajectory), 3) and trajectory.quaternions.shape == (len(trajectory), 4)
    assert trajectory == plvo.Trajectory(iter(results)) != plvo.Trajectory([])
    assert pickle.loads(pickle.dumps(trajectory)) == trajectory
    trajectory.save(tmp_path / "t.txt")
    saved = plvo.evaluate(walk, tmp_path / "t.txt")
    direct = plvo.evaluate(walk, results)
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

# SPDX-License-Identifier: Apache-2.0
"""A map: the poses of `plvo run --map`, saved and loaded again; what cannot be loaded is refused with words."""
import os
import subprocess

import numpy as np
import pytest

import plvo

PLVO = os.environ["PLVO_BINARY"]


def mapped(sequence, room):
    """What the map says of each frame, with its result."""
    odometry = plvo.Odometry(sequence.camera)
    found = []
    for frame in sequence:
        result = odometry.track(*frame)
        found.append((result, room.update(odometry, result)))
    return found


def test_gives_the_map_of_plvo_run(recording, tmp_path):
    sequence = plvo.Sequence(recording)
    room = plvo.Map(sequence.camera, keyframes=8)
    found = mapped(sequence, room)
    room.save(tmp_path / "python.map")
    subprocess.run([PLVO, "run", recording, "--quiet", "--map", "8", "--map-out", tmp_path / "run.map"], check=True)
    assert (tmp_path / "python.map").read_bytes() == (tmp_path / "run.map").read_bytes()
    assert sorted(os.listdir(tmp_path)) == ["python.map", "run.map"]
    result, in_map = found[-1]
    assert in_map.located and not in_map.recognised
    assert in_map.keyframe == room.keyframes >= 1
    assert np.allclose(room.keyframe_pose(in_map.keyframe) @ in_map.T_keyframe_camera,
                       in_map.T_map_world @ result.T_world_camera, atol=1e-12)
    assert in_map.covariance.shape == (6, 6) and in_map.removed == 0
    assert room.keyframe_pose(1000) is None
    assert room.loops == 0 and room.memory_bytes > 1e5


def test_a_loaded_map_does_not_know_where_the_camera_is_until_it_sees_a_place(recording, tmp_path):
    sequence = plvo.Sequence(recording)
    room = plvo.Map(sequence.camera, keyframes=8)
    mapped(sequence, room)
    room.settle()
    room.save(tmp_path / "room.map")
    again = plvo.Map(sequence.camera, keyframes=8)
    again.load(tmp_path / "room.map")
    assert again.keyframes == room.keyframes
    sequence = plvo.Sequence(recording)
    odometry = plvo.Odometry(sequence.camera)
    in_map = again.update(odometry, odometry.track(*next(sequence)))
    assert not in_map.located and in_map.covariance[0, 0] > 1e3
    assert again.keyframe_pose(in_map.keyframe) is None


def test_what_cannot_be_loaded_is_refused(recording, tmp_path):
    camera = plvo.Sequence(recording).camera
    room = plvo.Map(camera)
    (tmp_path / "text.map").write_text("no map")
    for call, code, words in (
        (lambda: room.save(tmp_path / "none.map"), "not_found", "the map holds no keyframe yet"),
        (lambda: room.load(tmp_path / "none.map"), "not_found", "cannot read"),
        (lambda: room.load(tmp_path / "text.map"), "damaged", "text.map: this is not a map"),
        (lambda: plvo.Map(camera, keyframes=7), "invalid_argument", "MapLimits::keyframes"),
    ):
        with pytest.raises(plvo.Error, match=words) as error:
            call()
        assert error.value.code == code
    assert os.listdir(tmp_path) == ["text.map"]

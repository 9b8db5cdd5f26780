# SPDX-License-Identifier: Apache-2.0
"""The tiny preset, limits and the budget of time from Python."""
import os
import subprocess

import numpy as np
import pytest

import plvo

PLVO = os.environ["PLVO_BINARY"]


def test_the_tiny_preset_is_that_of_the_command_line(recording, tmp_path):
    subprocess.run([PLVO, "run", recording, "--preset", "tiny", "--quiet", "--out", tmp_path / "t"], check=True)
    poses = np.loadtxt(tmp_path / "t")
    results = list(plvo.run(recording, config=plvo.Config(preset="tiny")))
    assert len(results) == len(poses) == 24
    for result, pose in zip(results, poses):
        assert np.array_equal(np.round(np.hstack([result.position, result.quaternion]), 9), pose[1:])
    assert not np.array_equal(results[-1].position, list(plvo.run(recording))[-1].position)


def test_limits_decide_the_memory(recording):
    camera, tiny = plvo.Sequence(recording).camera, plvo.Config(preset="tiny")
    bytes_of_tiny = plvo.Odometry(camera, tiny).memory_bytes
    assert bytes_of_tiny <= 512 * 1024
    assert plvo.Odometry(camera, tiny, line_bands=1).memory_bytes > bytes_of_tiny
    whole = plvo.Odometry(camera).memory_bytes
    assert plvo.Odometry(camera, kept_keyframes=0).memory_bytes < whole
    assert plvo.Odometry(camera, surfaces=0).memory_bytes < whole
    assert plvo.Odometry(camera, plvo.Config(reference="keyframe"), references=1).memory_bytes < whole
    assert plvo.Odometry(camera, plvo.Config(reference="window")).memory_bytes > whole
    for wrong in ({"references": 4}, {"line_bands": 9}, {"kept_keyframes": -1}, {"surfaces": 1001}):
        with pytest.raises(plvo.Error, match=f"Limits::{next(iter(wrong))}"):
            plvo.Odometry(camera, **wrong)
    with pytest.raises(plvo.Error, match="Limits::references"):
        plvo.Odometry(camera, plvo.Config(preset="tiny", reference="both"))


def test_a_window_tracks_what_both_references_track(recording):
    poses = {
        reference: [r.position for r in plvo.run(recording, config=plvo.Config(reference=reference))]
        for reference in ("both", "window")
    }
    assert len(poses["window"]) == len(poses["both"])
    assert np.allclose(poses["window"], poses["both"], atol=0.02)


def test_a_budget_steps_the_features_by_what_one_says(recording):
    def steps(config):
        odometry, found = plvo.Odometry(plvo.Sequence(recording).camera, config), []
        for i, frame in zip(range(12), plvo.Sequence(recording)):
            found.append(odometry.track(*frame).feature_step)
            odometry.frame_took(1001 if i < 4 else 501 if i < 7 else 499)
        return found

    config = plvo.Config(frame_budget_ns=1000, budget_patience_frames=2, budget_spare_share=0.5)
    assert config.frame_budget_ns == 1000 and plvo.Config().frame_budget_ns == 0
    assert steps(config) == [0, 1, 1, 1, 2, 2, 2, 2, 2, 1, 1, 1]
    assert steps(plvo.Config()) == [0] * 12
    for wrong in ({"frame_budget_ns": -1}, {"budget_patience_frames": 0}, {"budget_spare_share": 2.0}):
        with pytest.raises(plvo.Error, match="budget"):
            plvo.Config(**wrong)


def test_run_holds_a_budget_against_the_processor_time(recording):
    """No frame is tracked within a nanosecond."""
    results = list(plvo.run(recording, config=plvo.Config(frame_budget_ns=1)))
    assert [r.feature_step for r in results] == [(i + 2) // 3 for i in range(24)]
    assert results[-1].points.matched < list(plvo.run(recording))[-1].points.matched


def test_two_cores_give_the_same_bits(recording):
    def run(cores):
        return [(r.T_world_camera, r.covariance, r.points.inliers) for r in plvo.run(recording, cores=cores)]

    threads = len(os.listdir("/proc/self/task"))
    odometry = plvo.Odometry(plvo.Sequence(recording).camera, cores=2)
    assert len(os.listdir("/proc/self/task")) == threads + 1, "it has a second thread"
    del odometry
    assert len(os.listdir("/proc/self/task")) == threads
    one, two = run(1), run(2)
    assert len(one) == len(two) == 24
    for a, b in zip(one, two):
        assert all(np.array_equal(x, y) for x, y in zip(a, b))
    for wrong in (0, 3):
        with pytest.raises(plvo.Error, match="Limits::cores"):
            plvo.Odometry(plvo.Sequence(recording).camera, cores=wrong)

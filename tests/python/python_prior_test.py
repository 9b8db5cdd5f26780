# SPDX-License-Identifier: Apache-2.0
"""Priors, gyros and accelerometers, set_pose and reset from Python."""
import os
import subprocess

import numpy as np
import pytest

import plvo

PLVO = os.environ["PLVO_BINARY"]


@pytest.fixture(scope="module")
def covered(tmp_path_factory):
    """A sequence with a hand over the lens for five frames."""
    folder = tmp_path_factory.mktemp("covered") / "sequence"
    subprocess.run(
        [PLVO, "simulate", "--out", folder, "--scene", "desk", "--size", "320x240", "--frames", "24", "--covered", "12:17",
         "--quiet"],
        check=True,
    )
    return folder


def test_run_with_imu_gives_the_poses_of_the_command_line(covered, tmp_path):
    subprocess.run([PLVO, "run", covered, "--imu", "--quiet", "--out", tmp_path / "t"], check=True)
    poses = np.loadtxt(tmp_path / "t")
    results = list(plvo.run(covered, imu=True))
    assert len(results) == len(poses) == 24
    for result, pose in zip(results, poses):
        assert np.array_equal(np.round(np.hstack([result.position, result.quaternion]), 9), pose[1:])
    assert [r.state for r in results[12:17]] == ["predicted"] * 5 and all(r.has_pose for r in results)
    assert results[12].message.startswith("predicted: ")
    assert [r.state for r in plvo.run(covered)][12:17] == ["lost"] * 5


def test_samples_one_by_one_are_those_of_the_folder(covered):
    gyro, accelerometer = (np.loadtxt(covered / f"{name}.txt") for name in ("gyroscope", "accelerometer"))
    recorded, imu = plvo.Sequence(covered).imu(), plvo.Imu()
    for stamp, *rate in gyro[:60]:
        assert imu.add_gyro(round(stamp * 1e6) * 1000, rate)
    for stamp, *force in accelerometer[:60]:
        assert imu.add_acceleration(round(stamp * 1e6) * 1000, np.array(force))
    assert not imu.add_gyro(0, [0, 0, 0]) and not imu.add_gyro(2**60, [0, np.nan, 0])
    stamps = [frame.stamp_ns for frame, _ in zip(plvo.Sequence(covered), range(4))]
    assert imu.prior(stamps[0]).R_now_before is None and recorded.prior(stamps[0]).R_now_before is None
    for stamp in stamps[1:]:
        a, b = imu.prior(stamp), recorded.prior(stamp)
        assert np.array_equal(a.R_now_before, b.R_now_before)
        assert np.array_equal(a.rotation_covariance, b.rotation_covariance) and a.t_now_before is None
        assert np.allclose(a.down, b.down) and a.gravity_covariance.shape == (3, 3)


def learnt_offset(folder, more):
    sequence = plvo.Sequence(folder)
    odometry, imu = plvo.Odometry(sequence.camera), plvo.Imu(gyro_offset_sigma=0.05, longest_gap_s=0.1)
    samples = [(round(stamp * 1e6) * 1000, np.array(rate) + more)
               for stamp, *rate in np.loadtxt(folder / "gyroscope.txt")]
    assert np.array_equal(imu.gyro_offset, [0, 0, 0])
    for frame, _ in zip(sequence, range(12)):
        while samples and samples[0][0] <= frame.stamp_ns + 10_000_000:
            imu.add_gyro(*samples.pop(0))
        imu.learn(odometry.track(*frame, prior=imu.prior(frame.stamp_ns)))
    assert np.all(imu.gyro_offset_variance < 0.05**2 / 4)
    return imu.gyro_offset


def test_the_offset_of_the_gyro_is_learnt(covered):
    more = np.array([0.02, -0.01, 0.015])
    # The simulated gyro has an offset of its own.
    assert np.all(np.abs(learnt_offset(covered, more) - learnt_offset(covered, 0) - more) < 0.003)
    with pytest.raises(plvo.Error, match="longest_gap_s"):
        plvo.Imu(longest_gap_s=-1)


def test_a_prior_of_ones_own(covered):
    camera = plvo.Sequence(covered).camera
    odometry = plvo.Odometry(camera)
    wheels = plvo.MotionPrior(
        rotation=(np.eye(3), 1e-4 * np.eye(3)),
        translation=([0, 0, -0.01], 1e-6 * np.eye(3)),
        gravity=((0, 9.8, 0), 0.01 * np.eye(3)),
    )
    assert np.array_equal(wheels.down, [0, 9.8, 0]) and np.array_equal(wheels.t_now_before, [0, 0, -0.01])
    results = [odometry.track(*frame, prior=wheels) for frame, _ in zip(plvo.Sequence(covered), range(13))]
    assert results[12].state == "predicted"
    ahead = results[12].T_world_camera[:3, :3].T @ (results[12].position - results[11].position)
    assert np.allclose(ahead, [0, 0, 0.01], atol=2e-3)
    for nonsense in (
        {"rotation": (2 * np.eye(3), np.eye(3))},
        {"rotation": (np.eye(3), -np.eye(3))},
        {"translation": ([np.nan, 0, 0], np.eye(3))},
        {"gravity": ([0, 0, 0], np.eye(3))},
    ):
        with pytest.raises(plvo.Error, match="prior: "):
            plvo.MotionPrior(**nonsense)
    with pytest.raises(ValueError, match="pair"):
        plvo.MotionPrior(rotation=np.eye(3))
    with pytest.raises(ValueError, match="shape"):
        plvo.MotionPrior(translation=([0, 0], np.eye(3)))


def test_set_pose_and_reset(covered):
    frames = [plvo.Frame(f.colour.copy(), f.depth.copy(), *f[2:]) for f, _ in zip(plvo.Sequence(covered), range(4))]
    odometry = plvo.Odometry(plvo.Sequence(covered).camera)
    first = [odometry.track(*frame).T_world_camera for frame in frames]
    odometry.reset()
    T = np.eye(4)
    T[:3, 3] = 1, 2, 3
    odometry.set_pose(T, 1e-4 * np.eye(6))
    again = [odometry.track(*frame) for frame in frames]
    assert np.allclose(again[-1].T_world_camera, T @ first[-1], atol=1e-12)
    assert again[0].covariance[0, 0] == 1e-4
    assert {result.world for result in again} == {1}
    assert not any(result.restarted for result in again)
    with pytest.raises(plvo.Error, match="rotation"):
        odometry.set_pose(2 * np.eye(4) - np.diag([0, 0, 0, 1.0]))
    with pytest.raises(ValueError, match="last row"):
        odometry.set_pose(np.ones((4, 4)))


def test_a_level_world_waits_for_gravity(recording, tmp_path):
    sequence = plvo.Sequence(recording)
    odometry = plvo.Odometry(sequence.camera, plvo.Config(level_world=True))
    waiting = odometry.track(*next(sequence))
    assert waiting.state == "initialising" and not waiting.has_pose and "waiting for gravity" in waiting.message
    down = np.array([0.2, 0.9, 0.1])
    first = odometry.track(*next(sequence), prior=plvo.MotionPrior(gravity=(down, 0.01 * np.eye(3))))
    assert first.has_pose
    assert np.allclose(first.T_world_camera[:3, :3] @ down / np.linalg.norm(down), [0, 1, 0], atol=1e-12)
    subprocess.run([PLVO, "run", recording, "--imu", "--level", "--quiet", "--out", tmp_path / "t"], check=True)
    positions = [r.position for r in plvo.run(recording, imu=True, config=plvo.Config(level_world=True)) if r.has_pose]
    assert np.allclose(positions, np.loadtxt(tmp_path / "t")[:, 1:4], atol=1e-8)


def test_wheels_give_a_prior():
    ahead, left = np.array([0.6, 0, 0, 0, 0, 0]), np.array([0, 0, 0, 0, 0, 0.5])
    C = np.diag([0.02, 0.01, 0.01, 0.02, 0.02, 0.05]) ** 2
    T_base_camera = np.array([[0, 0, 1, 0.2], [-1, 0, 0, 0], [0, -1, 0, 0.5], [0, 0, 0, 1.0]])
    prior = plvo.MotionPrior.of_wheels([(0.1, ahead, C)], T_base_camera)
    assert np.allclose(prior.t_now_before, [0, 0, -0.06], atol=1e-15) and np.allclose(prior.R_now_before, np.eye(3))
    assert np.allclose(np.diag(prior.rotation_covariance), [0.002**2, 0.005**2, 0.002**2])  # pitch, heading, roll
    turn = plvo.MotionPrior.of_wheels([(0.1, ahead, C), (0.05, left, C)], T_base_camera, error_s=0.4)
    # To the left is about the camera's -y; the scene turns the other way.
    assert np.isclose(turn.R_now_before[0, 2], np.sin(0.025)) and turn.translation_covariance.shape == (3, 3)
    assert np.isclose(turn.rotation_covariance[1, 1], 0.4 * 0.15 * 0.05**2, rtol=1e-2)
    with pytest.raises(plvo.Error, match="longer than 0 s"):
        plvo.MotionPrior.of_wheels([(0.0, ahead, C)], T_base_camera)
    with pytest.raises(plvo.Error, match="a step at least"):
        plvo.MotionPrior.of_wheels([], T_base_camera)
    with pytest.raises(ValueError, match="for each step"):
        plvo.MotionPrior.of_wheels([(0.1, ahead)], T_base_camera)

# SPDX-License-Identifier: Apache-2.0
"""ROS 1 bags from Python: the poses of the folder that the bag was made of, topics by name, errors in the library's words."""
import os
import subprocess
import warnings

import numpy as np
import pytest

import plvo

WRITE_BAG = os.environ["PLVO_WRITE_BAG"]


def write_bag(recording, file, prefix="", *imu):
    subprocess.run([WRITE_BAG, recording, file, prefix, *imu], check=True)
    return file


@pytest.fixture(scope="module")
def bag(recording, tmp_path_factory):
    return write_bag(recording, tmp_path_factory.mktemp("bag") / "recording.bag", "", "imu")


def assert_same(results, expected):
    results, expected = list(results), list(expected)
    assert len(results) == len(expected) > 0
    for a, b in zip(results, expected):
        assert a.stamp_ns == b.stamp_ns and a.state == b.state
        assert np.array_equal(a.T_world_camera, b.T_world_camera) and np.array_equal(a.covariance, b.covariance)


@pytest.mark.filterwarnings("ignore:the calibration does not say")
def test_run_gives_the_bits_of_the_folder(recording, bag):
    assert_same(plvo.run(bag), plvo.run(recording))
    assert_same(plvo.run(str(bag), config=plvo.Config(features="points"), cores=2),
                plvo.run(recording, config=plvo.Config(features="points")))


@pytest.mark.filterwarnings("ignore:the calibration does not say")
def test_imu_in_axes_of_its_own_is_that_of_the_command_line(bag, tmp_path):
    words = ["--imu", "--imu-axes", "x,-y,-z", "--quiet", "--covariance", tmp_path / "c"]
    subprocess.run([os.environ["PLVO_BINARY"], "run", bag, *words], check=True, stderr=subprocess.DEVNULL)
    covariances = np.loadtxt(tmp_path / "c")[:, 1:]
    results = list(plvo.run(bag, imu=True, R_camera_imu=np.diag([1, -1, -1])))
    assert np.allclose([r.covariance.ravel() for r in results if r.has_pose], covariances, rtol=1e-9, atol=0)
    assert not np.array_equal(results[-1].covariance, list(plvo.run(bag, imu=True))[-1].covariance)


@pytest.mark.filterwarnings("ignore:the calibration does not say")
def test_imu_gives_the_bits_of_the_folder(recording, bag):
    with_imu = list(plvo.run(recording, imu=True))
    assert_same(plvo.run(bag, imu=True), with_imu)
    assert not np.array_equal(with_imu[-1].covariance, list(plvo.run(recording))[-1].covariance)


def test_the_camera_is_the_bags_or_ones_own(recording, bag):
    with pytest.warns(RuntimeWarning, match="does not say how the colour camera's shutter rolls"):
        sequence = plvo.Sequence(bag)
    camera = plvo.Sequence(recording).camera
    assert (sequence.camera.width, sequence.camera.fx, sequence.camera.cy) == (camera.width, camera.fx, camera.cy)
    assert sequence.camera.depth_units_per_metre == 5000 and len(sequence) == 24
    frame, expected = next(sequence), next(plvo.Sequence(recording))
    assert np.array_equal(frame.colour, expected.colour) and np.array_equal(frame.depth, expected.depth)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        own = plvo.Sequence(bag, plvo.Camera(320, 240, fx=200, fy=200, cx=160, cy=120))
    assert own.camera.fx == 200 and own.camera.depth_units_per_metre == 5000, "the encoding says metres"
    with pytest.raises(plvo.Error, match="640x480 images, these are 320x240"):
        plvo.run(bag, "tum-fr1").__next__()


@pytest.mark.filterwarnings("ignore:the calibration does not say")
def test_topics_by_name(recording, tmp_path):
    front = write_bag(recording, tmp_path / "front.bag", "/front", "imu")
    assert len(plvo.Sequence(front)) == 24, "the only ones of their kind"
    named = {"colour": "/front/camera/rgb/image_color", "depth": "/front/camera/depth/image", "gyro": "/front/imu"}
    assert_same(plvo.run(front, imu=True, topics=named), plvo.run(recording, imu=True))
    with pytest.raises(plvo.Error, match="there are no images on /back; images are on: /front") as raised:
        plvo.Sequence(front, topics={"depth": "/back"})
    assert raised.value.code == "not_found"
    with pytest.raises(plvo.Error, match="no readings of a gyro .* on /imu; they are on /front/imu"):
        plvo.Sequence(front, topics={"gyro": "/imu"}).imu()
    with pytest.raises(ValueError, match="'color' is not one of colour, depth"):
        plvo.Sequence(front, topics={"color": "/front"})
    with pytest.raises(ValueError, match="for a ROS bag"):
        plvo.Sequence(recording, topics={"depth": "/front"})


@pytest.mark.filterwarnings("ignore:the calibration does not say")
def test_true_poses_lie_beside_the_bag(recording, bag, tmp_path):
    results = list(plvo.run(bag))
    with pytest.raises(plvo.Error, match="put the true ones beside it, as recording-groundtruth.txt"):
        plvo.evaluate(bag, results)
    (tmp_path / "recording-groundtruth.txt").write_bytes((recording / "groundtruth.txt").read_bytes())
    assert plvo.evaluate(tmp_path / "recording.bag", results) == plvo.evaluate(recording / "groundtruth.txt", results)


def test_what_is_no_bag_is_refused(tmp_path):
    with pytest.raises(plvo.Error, match="is not there"):
        plvo.Sequence(tmp_path / "none.bag")
    (tmp_path / "no.bag").write_text("a folder's name")
    with pytest.raises(plvo.Error, match="is not a ROS 1 bag"):
        plvo.Sequence(tmp_path / "no.bag")


@pytest.mark.filterwarnings("ignore:the calibration does not say")
def test_a_bag_cut_short_is_warned_of(recording, bag, tmp_path):
    whole = bag.read_bytes()
    (tmp_path / "cut.bag").write_bytes(whole[: len(whole) * 7 // 10])
    with pytest.warns(RuntimeWarning, match="cut.bag is cut short"):
        results = list(plvo.run(tmp_path / "cut.bag"))
    assert 10 < len(results) < 24
    assert_same(results, list(plvo.run(recording))[: len(results)])

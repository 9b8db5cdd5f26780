# SPDX-License-Identifier: Apache-2.0
"""The odometry for Python: the poses of `plvo run`, arrays that are views, errors in the library's words."""
import os
import pathlib
import shutil
import struct
import subprocess
import threading
import warnings
import zlib

import numpy as np
import pytest

import plvo

PLVO = os.environ["PLVO_BINARY"]


def frames_of(recording, count=24):
    """Copies, to be kept."""
    sequence = plvo.Sequence(recording)
    return sequence.camera, [plvo.Frame(f.colour.copy(), f.depth.copy(), *f[2:]) for f, _ in zip(sequence, range(count))]


def test_run_gives_the_poses_and_covariances_of_the_command_line(recording, tmp_path):
    subprocess.run([PLVO, "run", recording, "--quiet", "--out", tmp_path / "t", "--covariance", tmp_path / "c"], check=True)
    poses, covariances = np.loadtxt(tmp_path / "t"), np.loadtxt(tmp_path / "c")
    results = [result for result in plvo.run(recording) if result.has_pose]
    assert len(results) == len(poses) == 24
    for result, pose, covariance in zip(results, poses, covariances):
        assert np.array_equal(np.round(np.hstack([result.position, result.quaternion]), 9), pose[1:])
        assert np.allclose(result.covariance.ravel(), covariance[1:], rtol=1e-9, atol=0)


def test_run_is_the_odometry_frame_by_frame(recording):
    camera, frames = frames_of(recording, 6)
    odometry = plvo.Odometry(camera, plvo.Config())
    for frame, expected in zip(frames, plvo.run(recording)):
        result = odometry.track(frame.colour, frame.depth, frame.stamp_ns, frame.depth_stamp_ns)
        assert np.array_equal(result.T_world_camera, expected.T_world_camera)
        assert np.array_equal(result.covariance, expected.covariance)


def test_a_result_says_what_the_library_knows(recording):
    first, *_, last = list(plvo.run(recording))
    assert (first.state, first.code, first.message) == ("initialising", "ok", "")
    assert last.state == "tracking" and last.has_pose
    assert last.stamp == pytest.approx(last.stamp_ns * 1e-9)
    assert first.stamp_ns <= last.reference_stamp_ns < last.stamp_ns
    assert last.T_world_camera.shape == (4, 4) and np.array_equal(last.T_world_camera[3], [0, 0, 0, 1])
    assert np.array_equal(last.T_world_camera[:3, 3], last.position)
    assert np.allclose(last.T_world_camera[:3, :3] @ last.T_world_camera[:3, :3].T, np.eye(3))
    for covariance in (last.covariance, last.motion_covariance):
        assert covariance.shape == (6, 6) and np.allclose(covariance, covariance.T, rtol=1e-9, atol=0)
        assert np.linalg.eigvalsh(covariance).min() > 0
        assert not covariance.flags.writeable and covariance.base is last, "a view of the result"
    assert last.points.detected >= last.points.with_depth > 0
    assert last.points.matched >= last.points.inliers > 0, "with all references"
    assert "tracking" in repr(last)


def test_settings_change_the_estimate(recording):
    both = [r.position for r in plvo.run(recording)][-1]
    points = [r for r in plvo.run(recording, config=plvo.Config(features="points", reference="previous"))][-1]
    assert points.lines.inliers == 0 and points.points.inliers > 0
    assert not np.array_equal(both, points.position)
    paper = [r.position for r in plvo.run(recording, config=plvo.Config(preset="paper"))][-1]
    assert not np.array_equal(both, paper)
    assert plvo.Config(seed=7).seed == 7


def test_images_are_read_where_they_lie(recording):
    camera, frames = frames_of(recording, 3)

    def track(change):
        odometry = plvo.Odometry(camera)
        results = [odometry.track(*change(frame)[:2], frame.stamp_ns, **change(frame)[2]) for frame in frames]
        return results[-1]

    plain = track(lambda f: (f.colour, f.depth, {}))

    def padded(f):
        colour, depth = np.zeros((240, 400, 3), np.uint8), np.zeros((240, 330), np.uint16)
        colour[:, :320], depth[:, :320] = f.colour, f.depth
        return colour[:, :320], depth[:, :320], {}

    assert np.array_equal(track(padded).T_world_camera, plain.T_world_camera), "rows with a gap between them"
    bgr = track(lambda f: (np.ascontiguousarray(f.colour[:, :, ::-1]), f.depth, {"bgr": True}))
    assert np.array_equal(bgr.T_world_camera, plain.T_world_camera)
    grey = track(lambda f: (f.colour[:, :, 1].copy(), f.depth, {}))
    assert grey.state == "tracking"


def test_features_are_views_of_what_is_drawn(recording):
    camera, frames = frames_of(recording, 2)
    odometry = plvo.Odometry(camera)
    for frame in frames:
        result = odometry.track(*frame)
    features = odometry.features()
    assert features.image.shape == (240, 320) and features.image.dtype == np.uint8
    assert features.image.base is odometry and not features.image.flags.writeable
    n = len(features.keypoints)
    assert features.keypoints.shape == (n, 2) and n > 10
    assert features.keypoints.base is odometry
    assert ((features.keypoints >= 0) & (features.keypoints < [320, 240])).all()
    assert features.point_tracks.shape == (len(features.point_inliers), 4)
    assert 0 < features.point_inliers.sum() <= len(features.point_tracks) <= n
    assert features.segments.shape == (len(features.segment_has_3d), 4)
    assert features.segment_has_3d.sum() == result.lines.with_depth
    assert features.line_tracks.shape == (len(features.line_inliers), 2)
    assert (features.line_tracks < [len(features.reference_segments), len(features.segments)]).all()


def test_before_the_first_frame_there_are_no_features(recording):
    features = plvo.Odometry(plvo.Sequence(recording).camera).features()
    assert features.image.size == 0 and len(features.keypoints) == 0


def test_a_sequence_gives_frames_without_copies(recording):
    sequence = plvo.Sequence(recording)
    assert len(sequence) == 24
    assert (sequence.camera.width, sequence.camera.height) == (320, 240)
    frame = next(sequence)
    assert frame.colour.shape == (240, 320, 3) and frame.depth.shape == (240, 320)
    assert frame.colour.base is sequence and frame.depth.base is sequence
    assert (frame.depth > 0).mean() > 0.5
    later = next(sequence)
    assert np.shares_memory(frame.colour, later.colour), "valid until the next frame"
    assert len(list(sequence)) == 22


def test_arrays_outlive_what_they_look_into(recording):
    """A view holds on to its owner."""
    covariance = list(plvo.run(recording))[-1].covariance
    colour = next(plvo.Sequence(recording)).colour
    assert np.linalg.eigvalsh(covariance).min() > 0
    assert colour.mean() > 0


def test_cameras(tmp_path):
    tum = plvo.Camera.builtin("tum-fr1")
    assert tum.fx == pytest.approx(517.3, abs=0.1) and tum.depth_units_per_metre == 5000
    assert len(tum.distortion) == 5 and tum.readout_s > 0 and tum.stamp_sigma_s == 0.0012
    (tmp_path / "c.txt").write_text("300 301 160 120 1000\n")
    assert plvo.Camera.read(tmp_path / "c.txt").fy == 301
    camera = plvo.Camera(640, 480, 525, 525, 319.5, 239.5, (0.1, 0, 0, 0), depth_units_per_metre=5000)
    assert camera.distortion == (0.1, 0, 0, 0, 0) and camera.distortion_model == "plumb_bob"
    assert camera.stamp_sigma_s == 0
    assert plvo.Camera(640, 480, 525, 525, 319.5, 239.5, stamp_sigma_s=0.002).stamp_sigma_s == 0.002


def test_lenses(tmp_path):
    def camera(distortion, model=""):
        return plvo.Camera(640, 480, 525, 525, 319.5, 239.5, distortion, distortion_model=model)

    eight = (0.1, 0.02, 0.001, -0.001, 0.01, 0.05, 0.01, 0.002)
    for rational in (camera(eight), camera(list(eight), "rational_polynomial")):
        assert rational.distortion == eight and rational.distortion_model == "rational_polynomial"
    fisheye = camera((0.1, -0.02, 0.003, 0.0004), "equidistant")
    assert fisheye.distortion == (0.1, -0.02, 0.003, 0.0004) and fisheye.distortion_model == "equidistant"
    (tmp_path / "info.yaml").write_text(
        "width: 640\nheight: 480\nK: [525, 0, 320, 0, 525, 240, 0, 0, 1]\n"
        "distortion_model: equidistant\nD: [0.1, 0, 0, 0]\n"
    )
    read = plvo.Camera.read(tmp_path / "info.yaml")
    assert read.distortion_model == "equidistant" and read.distortion[0] == 0.1
    with pytest.raises(ValueError, match="k1 k2 k3 k4, not 5"):
        camera((1, 2, 3, 4, 5), "equidistant")
    with pytest.raises(ValueError, match="'pinhole' is not supported"):
        camera((), "pinhole")
    with pytest.raises(plvo.Error, match="folds the image") as error:
        camera((-3, 0, 0, 0), "equidistant")
    assert error.value.code == "invalid_argument"


def test_errors_are_the_librarys_words(recording, tmp_path):
    with pytest.raises(plvo.Error, match="tum-fr1") as error:
        plvo.Camera.builtin("nikon")
    assert error.value.code == "not_found"
    with pytest.raises(plvo.Error, match="fx") as error:
        plvo.Camera(640, 480, -1, 525, 320, 240)
    assert error.value.code == "invalid_argument"
    with pytest.raises(plvo.Error) as error:
        next(plvo.run(tmp_path / "nowhere"))
    assert error.value.code == "not_found"
    with pytest.raises(plvo.Error, match="keypoints"):
        plvo.Odometry(plvo.Camera.builtin("tum-fr1"), keypoints=10**9)
    with pytest.raises(ValueError, match="points, lines, both"):
        plvo.Config(features="squares")
    with pytest.raises(ValueError, match="distortion"):
        plvo.Camera(640, 480, 525, 525, 320, 240, (1, 2, 3))

    camera, (first, second) = frames_of(recording, 2)
    odometry = plvo.Odometry(camera)
    odometry.track(*second)
    with pytest.raises(plvo.Error, match="not later"):
        odometry.track(*first)
    with pytest.raises(plvo.Error, match="320x240"):
        odometry.track(first.colour[:100], first.depth[:100], second.stamp_ns + 1)
    with pytest.raises(TypeError, match="uint16"):
        odometry.track(first.colour, first.depth.astype(np.float32), second.stamp_ns + 1)
    with pytest.raises(TypeError, match="uint8"):
        odometry.track(first.colour.astype(np.int16), first.depth, second.stamp_ns + 1)
    with pytest.raises(TypeError, match="uint16"):
        odometry.track(first.colour, first.depth.astype(">u2"), second.stamp_ns + 1)
    with pytest.raises(ValueError, match="ascontiguousarray"):
        odometry.track(first.colour[:, ::-1], first.depth, second.stamp_ns + 1)
    with pytest.raises(ValueError, match="height, width"):
        odometry.track(first.colour[:, :, :2], first.depth, second.stamp_ns + 1)


def test_a_dark_frame_is_lost_and_the_next_one_goes_on(recording):
    camera, frames = frames_of(recording, 5)
    odometry = plvo.Odometry(camera)
    results = []
    for i, frame in enumerate(frames):
        dark = i == 2
        colour, depth = (np.zeros_like(frame.colour), np.zeros_like(frame.depth)) if dark else frame[:2]
        results.append(odometry.track(colour, depth, frame.stamp_ns))
    assert [r.state for r in results] == ["initialising", "tracking", "lost", "tracking", "tracking"]
    assert results[2].message and not results[2].has_pose


def test_a_damaged_image_costs_its_frame(recording, tmp_path):
    copy = tmp_path / "sequence"
    subprocess.run(["cp", "-r", recording, copy], check=True)
    sorted((copy / "depth").iterdir())[3].write_bytes(b"no picture")
    with pytest.warns(RuntimeWarning, match="depth"):
        results = list(plvo.run(copy))
    assert len(results) == 23 and results[-1].state == "tracking"


def test_numbered_frames_are_a_sequence_too(recording, tmp_path):
    for kind, listed in (("color", "rgb"), ("depth", "depth")):
        (tmp_path / kind).mkdir()
        for number, image in enumerate(sorted((recording / listed).iterdir())[:5]):
            if number != 2:
                shutil.copy(image, tmp_path / kind / f"{number}.png")
    shutil.copy(recording / "calibration.txt", tmp_path)
    with pytest.warns(RuntimeWarning, match="the first is 2"):
        frames = [(f.stamp_ns, f.colour.copy(), f.depth.copy()) for f in plvo.Sequence(tmp_path)]
    assert [frame[0] for frame in frames] == [0, 33_333_333, 100_000_000, 133_333_333]
    listed = frames_of(recording, 5)[1]
    for (_, colour, depth), expected in zip(frames, listed[:2] + listed[3:]):
        assert np.array_equal(colour, expected.colour) and np.array_equal(depth, expected.depth)


def png(array):
    """Of 8-bit RGB or 16-bit grey."""
    grey = array.ndim == 2
    rows = array.astype(">u2" if grey else np.uint8)
    header = struct.pack(">IIBBBBB", array.shape[1], array.shape[0], 16 if grey else 8, 0 if grey else 2, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + row.tobytes() for row in rows), 1)
    chunks = ((b"IHDR", header), (b"IDAT", pixels), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )


def test_images_above_the_limit_are_scaled_down(recording, tmp_path):
    """Each pixel as a block of 8; down by 2 it is one of 4."""
    frame = frames_of(recording, 1)[1][0]
    for name, image in (("rgb", frame.colour), ("depth", frame.depth)):
        (tmp_path / f"{name}.png").write_bytes(png(image.repeat(8, 0).repeat(8, 1)))
        (tmp_path / f"{name}.txt").write_text(f"1.0 {name}.png\n")
    camera = plvo.Camera(2560, 1920, 2100, 2100, 1279.5, 959.5, depth_units_per_metre=5000)
    with pytest.warns(RuntimeWarning, match="2560x1920 are larger than plvo takes: they are scaled down by 2, to 1280x960"):
        sequence = plvo.Sequence(tmp_path, camera)
    assert (sequence.camera.width, sequence.camera.fx, sequence.camera.cx) == (1280, 1050, 639.5)
    small = next(sequence)
    assert np.array_equal(small.colour, frame.colour.repeat(4, 0).repeat(4, 1))
    assert np.array_equal(small.depth, frame.depth.repeat(4, 0).repeat(4, 1))


def test_data_that_look_wrong_are_warned_of(recording, tmp_path):
    copy = tmp_path / "sequence"
    subprocess.run(["cp", "-r", recording, copy], check=True)
    for image in (copy / "depth").iterdir():
        image.write_bytes(png(np.zeros((240, 320), np.uint16)))
    with pytest.warns(RuntimeWarning, match="the depth images are empty: of the first 24 frames"):
        assert len(list(plvo.Sequence(copy))) == 24
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(list(plvo.Sequence(recording))) == 24
    assert plvo.evaluate(recording, plvo.run(recording))["scale"]["best_fit"] == pytest.approx(1, abs=0.05)


def test_what_is_assumed_is_warned_of(recording, tmp_path):
    (tmp_path / "c.txt").write_text("277 277 159.5 119.5\n")
    with pytest.warns(RuntimeWarning, match="depth"):
        plvo.Sequence(recording, tmp_path / "c.txt")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plvo.Sequence(recording, plvo.Sequence(recording).camera)


def test_threads_track_executor(recording):
    """Each its own odometry: the same results as one after the other."""
    expected = [r.T_world_camera for r in plvo.run(recording)]
    found = {}

    def work(name):
        found[name] = [r.T_world_camera for r in plvo.run(recording)]

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3
    assert all(np.array_equal(poses, expected) for poses in found.values())


def test_track_lets_other_threads_run(recording):
    """While one thread tracks, another counts. With the interpreter locked the counter would stand still from the
    beginning of a call to its end; an odometry that is used twice at once says so."""
    camera, frames = frames_of(recording, 12)
    odometry = plvo.Odometry(camera)
    refused, done = [], threading.Event()

    def meddle():
        while not done.is_set():
            try:
                odometry.features()
            except RuntimeError as error:
                refused.append(str(error))

    thread = threading.Thread(target=meddle)
    thread.start()
    results = [odometry.track(*frame) for frame in frames]
    done.set()
    thread.join()
    assert results[-1].state == "tracking"
    assert refused and "another thread" in refused[0], "no call of the other thread fell into a call of track"


def test_the_package_is_typed():
    assert (pathlib.Path(plvo.__file__).parent / "py.typed").exists()

# SPDX-License-Identifier: Apache-2.0
"""Recordings that something other than plvo wrote open with `plvo run FILE` alone, and give the
poses of the folder that they were made of, byte for byte where nothing is lost."""
import io
import json
import os
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from PIL import Image

import ros_containers as containers
import ros_messages as ros

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from simulated_folder import SimulatedFolder

PLVO = os.environ["PLVO_BINARY"]
COLOUR, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
INFO = "/camera/color/camera_info"
UNITS = 5000  # a metre, in the simulated folder


def plvo(*arguments, **environment):
    return subprocess.run([PLVO, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                          env=os.environ | environment)


def png(array):
    out = io.BytesIO()
    Image.fromarray(array).save(out, "PNG")
    return out.getvalue()


def jpeg(array):
    out = io.BytesIO()
    Image.fromarray(array).save(out, "JPEG", quality=95)
    return out.getvalue()


class Recording(SimulatedFolder):
    """A simulated folder, as arrays."""

    def __init__(self, folder):
        super().__init__(folder)
        self.camera = self.numbers[:4]
        self.lens = self.numbers[5:10] if len(self.numbers) >= 10 else [0] * 5
        self.height, self.width = self.frames[0][3].shape


class RosRecordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.base = pathlib.Path(cls.scratch.name)
        made = plvo("simulate", "--scene", "bare", "--size", "160x120", "--seed", "3", "--quiet", "--frames", "6", "--out", cls.base / "sequence")
        assert made.returncode == 0, made.stderr
        cls.recording = Recording(cls.base / "sequence")
        cls.poses = cls.poses_of(cls, cls.base / "sequence")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def setUp(self):
        self.folder = self.base / self.id().rpartition(".")[2]
        self.folder.mkdir()

    def poses_of(self, recording, *options):
        out = self.base / "poses.txt"
        run = plvo("run", recording, "--quiet", "--out", out, *options)
        assert run.returncode == 0, run.stderr
        return out.read_bytes()

    def expect_equal(self, recording, *options, poses=None):
        self.assertEqual(self.poses_of(recording, *options), poses or self.poses, str(recording))

    def info(self, wire, stamp):
        return ros.camera_info(wire, stamp, self.recording.width, self.recording.height, *self.recording.camera, lens=self.recording.lens)

    def messages(self, wire, colour=None, depth=None):
        """colour, depth: (topic, type, function of stamp and array), else raw images."""
        w, h = self.recording.width, self.recording.height
        colour = colour or (COLOUR, "sensor_msgs/Image", lambda t, a: ros.image(wire, t, w, h, "rgb8", 3 * w, a.tobytes()))
        depth = depth or (DEPTH, "sensor_msgs/Image", lambda t, a: ros.image(
            wire, t, w, h, "32FC1", 4 * w, np.where(a > 0, a / UNITS, np.nan).astype("<f4").tobytes()))
        result = []
        for stamp, rgb, depth_stamp, units in self.recording.frames:
            late = stamp + 40_000_000
            result.append((INFO, "sensor_msgs/CameraInfo", late, self.info(wire, stamp)))
            result.append((depth[0], depth[1], late, depth[2](depth_stamp, units)))
            result.append((colour[0], colour[1], late, colour[2](stamp, rgb)))
            result.append(("/tf", "tf2_msgs/TFMessage", late, b"of no interest"))
        return result

    def test_mcap(self):
        file = self.folder / "a.mcap"
        for wire in ("cdr_le", "cdr_be"):
            for compression in ("", "lz4", "zstd"):
                for summary in (True, False):
                    containers.write_mcap(file, self.messages(wire), compression=compression, summary=summary)
                    self.expect_equal(file)
        containers.write_mcap(file, self.messages("cdr_le"), chunked=False)
        self.expect_equal(file)
        containers.write_mcap(file, self.messages("ros1"), wire="ros1", compression="zstd")
        self.expect_equal(file)

    def test_mcap_cut_off(self):
        for compression in ("", "lz4", "zstd"):
            whole = containers.Mcap(self.messages("cdr_le"), compression=compression).out
            cut = self.folder / "cut.mcap"
            cut.write_bytes(whole[:len(whole) * 7 // 10])
            poses = self.poses_of(cut)
            self.assertTrue(self.poses.startswith(poses) and poses.count(b"\n") >= 4)
            self.assertIn("cut.mcap is cut short; what lies before byte", plvo("run", cut).stderr)

    def test_database(self):
        file = self.folder / "a b%1.db3"
        for wire in ("cdr_le", "cdr_be"):
            file.unlink(missing_ok=True)
            containers.write_db3(file, self.messages(wire))
            self.expect_equal(file)
        packed = self.folder / "packed.db3"
        containers.write_db3(packed, [(*m[:3], containers.zstd_with_size(m[3])) for m in self.messages("cdr_le")])
        self.expect_equal(packed)

    def test_database_cut_off(self):
        file, cut = self.folder / "a.db3", self.folder / "cut.db3"
        containers.write_db3(file, self.messages("cdr_le"))
        whole = file.read_bytes()
        cut.write_bytes(whole[:len(whole) * 7 // 10])
        poses = self.poses_of(cut)
        self.assertTrue(self.poses.startswith(poses) and poses.count(b"\n") >= 3, poses)
        self.assertIn("cut.db3 is damaged or cut short", plvo("run", cut).stderr)

    def test_folder(self):
        messages = self.messages("cdr_le")
        # Twelve files: by name alone, 10 would come before 2.
        parts = [messages[i:i + 2] for i in range(0, len(messages), 2)]
        for kind, write in (("db3", containers.write_db3), ("mcap", containers.write_mcap)):
            folder = self.folder / kind
            folder.mkdir()
            names = [f"recording_{i}.{kind}" for i in range(len(parts))]
            for name, part in zip(names, parts):
                write(folder / name, part)
            self.expect_equal(folder)
            containers.write_metadata(folder, names)
            self.expect_equal(f"{folder}/")
            for name in names:
                subprocess.run(["zstd", "-q", "--rm", folder / name, "-o", folder / f"{name}.zstd"], check=True)
            self.expect_equal(folder)
            (folder / f"recording_7.{kind}.zstd").unlink()
            self.assertIn(f"after recording_6.{kind}.zstd comes recording_8.{kind}.zstd: is a file between them missing?", plvo("run", folder).stderr)
            if kind == "mcap":
                (folder / "recording_11.mcap.zstd").write_bytes(b"no zstd")
                self.assertIn("a file is left out", plvo("run", folder).stderr)
                shutil.copy(self.folder / "db3" / "recording_0.db3.zstd", folder)
                self.assertIn("has both .db3 and .mcap files", plvo("run", folder).stderr)

    def test_packed_files_and_files_beside_images(self):
        file = self.folder / "a.mcap"
        containers.write_mcap(file, self.messages("cdr_le"))
        for ending in (".zstd", ".zst"):
            subprocess.run(["zstd", "-q", file, "-o", f"{file}{ending}"], check=True)
            self.expect_equal(f"{file}{ending}")
        temporary = self.folder / "tmp"
        self.assertIn("set TMPDIR to one", plvo("run", f"{file}.zst", TMPDIR=str(temporary)).stderr)
        temporary.mkdir()
        self.assertEqual(plvo("run", f"{file}.zst", TMPDIR=str(temporary)).returncode, 0)
        self.assertEqual(list(temporary.iterdir()), [])
        # A folder of images stays one if a recording lies in it.
        for number, (_, rgb, _, units) in enumerate(self.recording.frames):
            Image.fromarray(rgb).save(self.folder / f"frame-{number:06}.color.png")
            Image.fromarray(units).save(self.folder / f"frame-{number:06}.depth.png")
        self.assertEqual(json.loads(plvo("info", self.folder, "--json", "-").stdout)["format"], "folder of images")

    def test_what_is_not_read_is_named(self):
        file = self.folder / "a.mcap"
        containers.write_mcap(file, self.messages("cdr_le"), wire="protobuf")
        self.assertIn("messages in the encoding 'protobuf' are not read", plvo("run", file).stderr)
        depth = (DEPTH + "/compressedDepth", "sensor_msgs/CompressedImage",
                 lambda t, a: ros.compressed_depth("cdr_le", t, "16UC1; compressedDepth rvl", b"rvl"))
        containers.write_mcap(file, self.messages("cdr_le", None, depth))
        self.assertIn("/compressedDepth (compressedDepth of the format rvl is not read; png is)", plvo("run", file).stderr)

    def test_inputs_are_not_overwritten(self):
        folder = self.folder / "sequence"
        folder.mkdir()
        file = folder / "recording_0.db3"
        containers.write_db3(file, self.messages("cdr_le"))
        for command in (("info", folder, "--json", file), ("info", file, "--json", file), ("run", folder, "--out", file),
                        ("eval", "--gt", folder, "--est", "e", "--json", file), ("convert", folder, "--out", file),
                        ("info", self.recording.folder, "--json", self.recording.folder / "rgb.txt")):
            run = plvo(*command)
            self.assertNotEqual(run.returncode, 0, command)
        self.expect_equal(folder)
        self.expect_equal(self.recording.folder)

    def test_compressed_topics(self):
        for wire in ("cdr_le", "ros1"):
            colour = (COLOUR + "/compressed", "sensor_msgs/CompressedImage",
                      lambda t, a: ros.compressed_image(wire, t, "rgb8; png compressed bgr8", png(a)))
            for form, depth in (
                    ("/compressed", lambda t, a: ros.compressed_image(wire, t, "16UC1; png compressed ", png(a))),
                    ("/compressedDepth", lambda t, a: ros.compressed_depth(wire, t, "16UC1; compressedDepth png", png(a)))):
                messages = self.messages(wire, colour, (DEPTH + form, "sensor_msgs/CompressedImage", depth))
                file = self.folder / "a.mcap"
                containers.write_mcap(file, messages, wire="ros1" if wire == "ros1" else "cdr")
                self.expect_equal(file, "--depth-scale", UNITS)

    def folder_of(self, name, colour, depth):
        """A copy of the recording whose images went through the functions."""
        copy = self.folder / name
        shutil.copytree(self.recording.folder, copy)
        for (_, rgb, _, units), c, d in zip(self.recording.frames, self.recording.rows("rgb.txt"), self.recording.rows("depth.txt")):
            Image.fromarray(colour(rgb)).save(copy / c[1])
            Image.fromarray(depth(units)).save(copy / d[1])
        return copy

    def test_lossy_topics(self):
        # As compressed_depth_image_transport has it: inverse depth, finer the nearer.
        quantum, most = 100.0, 10.0
        a = quantum * (quantum + 1)
        b = 1 - a / most

        def inverse(units):
            with np.errstate(divide="ignore"):
                value = a / (units / UNITS) + b
            return np.where((units > 0) & (units / UNITS <= most), value, 0).astype(np.uint16)

        def restored(units):
            value = inverse(units)
            metres = np.float32(a) / (value.astype(np.float32) - np.float32(b))
            return np.where(value > 0, np.floor(metres.astype(np.float64) * UNITS + 0.5), 0).astype(np.uint16)

        colour = (COLOUR + "/compressed", "sensor_msgs/CompressedImage",
                  lambda t, x: ros.compressed_image("cdr_le", t, "rgb8; jpeg compressed bgr8", jpeg(x)))
        depth = (DEPTH + "/compressedDepth", "sensor_msgs/CompressedImage", lambda t, x: ros.compressed_depth(
            "cdr_le", t, "32FC1; compressedDepth png", png(inverse(x)), a, b))
        file = self.folder / "a.db3"
        containers.write_db3(file, self.messages("cdr_le", colour, depth))
        copy = self.folder_of("copy", lambda x: np.asarray(Image.open(io.BytesIO(jpeg(x)))), restored)
        self.expect_equal(file, poses=self.poses_of(copy))

    def test_the_raw_topic_is_preferred(self):
        messages = self.messages("cdr_le")
        copies = self.messages("cdr_le", (COLOUR + "/compressed", "sensor_msgs/CompressedImage",
                                          lambda t, a: ros.compressed_image("cdr_le", t, "jpeg", jpeg(a))))
        both = [m for pair in zip(messages, copies) for m in pair if m[0] not in (INFO, DEPTH, "/tf") or m is pair[0]]
        file = self.folder / "a.mcap"
        containers.write_mcap(file, both)
        self.expect_equal(file)

    def test_truth(self):
        for kind in ("nav_msgs/Odometry", "geometry_msgs/PoseStamped"):
            messages = self.messages("cdr_le")
            for row in self.recording.rows("groundtruth.txt"):
                stamp = self.recording.ns(row[0])
                messages.append(("/truth", kind, stamp, ros.pose("cdr_le", kind, stamp, [float(x) for x in row[1:]])))
            file = self.folder / "a.mcap"
            containers.write_mcap(file, messages)
            results = []
            for recording in (file, self.recording.folder):
                run = plvo("run", recording, "--json", self.folder / "j", "--quiet")
                self.assertEqual(run.returncode, 0, run.stderr)
                results.append(json.loads((self.folder / "j").read_text())["evaluation"])
                if recording == file:
                    self.assertIn("the poses on /truth are taken as the true poses", run.stderr)
            self.assertEqual(results[0], results[1])

    def test_gyro_and_accelerometer(self):
        messages = self.messages("cdr_be")
        for rate, force in zip(self.recording.rows("gyroscope.txt"), self.recording.rows("accelerometer.txt")):
            stamp = self.recording.ns(rate[0])
            messages.append(("/imu", "sensor_msgs/Imu", stamp, ros.imu("cdr_be", stamp, map(float, rate[1:]), map(float, force[1:]))))
        file = self.folder / "a.db3"
        containers.write_db3(file, messages)
        self.expect_equal(file, "--imu", poses=self.poses_of(self.recording.folder, "--imu"))

    def own_depth_camera(self, x):
        """A folder whose depth has a camera x metres from that of colour."""
        copy = self.folder / "own"
        shutil.copytree(self.recording.folder, copy)
        fx, fy, cx, cy = self.recording.camera
        with open(copy / "calibration.txt", "a", encoding="utf-8") as file:
            file.write(f"depth_fx {fx - 3}\ndepth_fy {fy - 3}\ndepth_cx {cx + 1}\ndepth_cy {cy}\ndepth_tx {x}\n")
        return copy

    def realsense(self, wire, infrared="mono8"):
        """As the RealSense Viewer records, with infrared beside colour."""
        w, h = self.recording.width, self.recording.height
        fx, fy, cx, cy = self.recording.camera
        stream = "/device_0/sensor_0/Depth_0", "/device_0/sensor_1/Color_0", "/device_0/sensor_0/Infrared_1"
        identity = [0, 0, 0, 0, 0, 0, 1]
        begin = self.recording.frames[0][0]
        messages = [
            ("/device_0/sensor_0/option/Depth Units/value", "std_msgs/Float32", begin, ros.float32(wire, 1 / UNITS)),
            (stream[0] + "/info/camera_info", "sensor_msgs/CameraInfo", begin,
             ros.camera_info(wire, 0, w, h, fx - 3, fy - 3, cx + 1, cy, model="Brown Conrady", frame="0")),
            (stream[1] + "/info/camera_info", "sensor_msgs/CameraInfo", begin,
             ros.camera_info(wire, 0, w, h, fx, fy, cx, cy, lens=self.recording.lens, model="Brown Conrady", frame="1")),
            (stream[0] + "/tf/0", "geometry_msgs/Transform", begin, ros.transform(wire, identity)),
            (stream[1] + "/tf/0", "geometry_msgs/Transform", begin, ros.transform(wire, [0.015, 0, 0, 0, 0, 0, 1]))]
        for stamp, rgb, depth_stamp, units in self.recording.frames:
            grey = rgb[:, :, 1].astype(np.uint8 if infrared == "mono8" else "<u2")
            messages += [
                (stream[2] + "/image/data", "sensor_msgs/Image", stamp, ros.image(
                    wire, stamp, w, h, infrared, w * grey.itemsize, grey.tobytes(), "2")),
                (stream[0] + "/image/data", "sensor_msgs/Image", stamp,
                 ros.image(wire, depth_stamp, w, h, "mono16", 2 * w, units.astype("<u2").tobytes(), "0")),
                (stream[1] + "/image/data", "sensor_msgs/Image", stamp, ros.image(wire, stamp, w, h, "rgb8", 3 * w, rgb.tobytes(), "1"))]
        return messages

    def test_realsense_viewer(self):
        poses = self.poses_of(self.own_depth_camera(0.015))
        self.assertNotEqual(poses, self.poses)
        file = self.folder / "viewer.db3"
        containers.write_db3(file, self.realsense("cdr_le"))
        self.expect_equal(file, poses=poses)
        told = plvo("run", file).stderr
        self.assertIn("it is registered to colour with the calibration in the recording", told)
        self.assertIn("and not from the grey images on /device_0/sensor_0/Infrared_1/image/data (mono8)", told)
        bag = self.folder / "viewer.bag"
        for compression in ("none", "lz4"):
            if not containers.write_ros1(bag, self.realsense("ros1"), compression):
                self.skipTest("no python3-rosbag")
            self.expect_equal(bag, poses=poses)

    def test_realsense_viewer_with_infrared_of_16_bits(self):
        """It has the encoding of depth."""
        file = self.folder / "viewer.db3"
        containers.write_db3(file, self.realsense("cdr_le", "mono16"))
        self.expect_equal(file, poses=self.poses_of(self.own_depth_camera(0.015)))
        told = plvo("run", file).stderr
        self.assertIn("depth is taken from /device_0/sensor_0/Depth_0/image/data, and not from the infrared images on "
                      "/device_0/sensor_0/Infrared_1/image/data (mono16)", told)

    def test_two_cameras(self):
        """Depth is that of the camera of colour, whichever comes first."""
        messages = [(topic.replace("/camera/", "/front/"), *rest) for topic, *rest in self.messages("cdr_le")]
        names = {topic for topic, *_ in messages}
        colour, depth, info = (next(name for name in names if name.endswith(of.removeprefix("/camera")))
                               for of in (COLOUR, DEPTH, INFO))
        w, h = self.recording.width, self.recording.height
        blank = ros.image("cdr_le", messages[0][2], w, h, "16UC1", 2 * w, bytes(2 * w * h), "camera")
        back = [("/back/depth/image_raw", "sensor_msgs/Image", messages[0][2], blank)]
        file = self.folder / "a.mcap"
        for content in (back + messages, messages + back):
            containers.write_mcap(file, content)
            self.expect_equal(file)
            self.assertIn(f"depth is taken from {depth}, which is of the camera of colour, and not from /back/depth/image_raw",
                          plvo("run", file).stderr)
        # With two whole cameras, that of the colour which was chosen.
        rgb = ros.image("cdr_le", messages[0][2], w, h, "rgb8", 3 * w, bytes(3 * w * h), "camera")
        back.append(("/back/rgb/image_raw", "sensor_msgs/Image", messages[0][2], rgb))
        containers.write_mcap(file, back + messages)
        self.assertIn("several topics could be colour", plvo("run", file).stderr)
        self.expect_equal(file, "--colour-topic", colour, "--info-topic", info)

    def test_depth_of_another_frame(self):
        w, h = self.recording.width, self.recording.height
        fx, fy, cx, cy = self.recording.camera
        raw = ("/camera/depth/image_rect_raw", "sensor_msgs/Image", lambda t, a: ros.image(
            "cdr_le", t, w, h, "16UC1", 2 * w, a.astype("<u2").tobytes(), "depth_optical"))
        messages = [("/tf_static", "tf2_msgs/TFMessage", 1, ros.transforms("cdr_le", [
            ("link", "depth_optical", [0.1, 0, 0, 0, 0, 0, 1]), ("link", "camera", [0.085, 0, 0, 0, 0, 0, 1])])),
            ("/camera/depth/camera_info", "sensor_msgs/CameraInfo", 1, ros.camera_info("cdr_le", 0, w, h, fx - 3, fy - 3, cx + 1, cy))]
        messages += self.messages("cdr_le", None, raw)
        file = self.folder / "a.mcap"
        containers.write_mcap(file, messages)
        self.expect_equal(file, "--depth-scale", UNITS, poses=self.poses_of(self.own_depth_camera(0.015)))
        # Without the transform it is said that it is missing.
        containers.write_mcap(file, messages[1:])
        self.assertIn("no transform from one to the other was recorded", plvo("run", file).stderr)
        # Beside depth in the view of colour it is passed over.
        containers.write_mcap(file, messages + [m for m in self.messages("cdr_le") if m[0] == DEPTH])
        self.expect_equal(file)
        self.assertIn(f"depth is taken from {DEPTH}", plvo("run", file).stderr)

    def test_info(self):
        file = self.folder / "viewer.db3"
        containers.write_db3(file, self.realsense("cdr_le"))
        told = plvo("info", file, "--json", "-")
        self.assertEqual(told.returncode, 0, told.stderr)
        info = json.loads(told.stdout)
        self.assertEqual((info["opens"], info["frames"], info["depth_units_per_metre"]), (True, 6, UNITS))
        self.assertFalse(info["depth_is_registered"])
        used = {topic["used_as"]: topic for topic in info["topics"]}
        self.assertEqual(used["colour"]["name"], "/device_0/sensor_1/Color_0/image/data")
        self.assertEqual((used["depth"]["encoding"], used["depth"]["width"], used["depth"]["messages"]), ("mono16", 160, 6))
        self.assertAlmostEqual(used["depth"]["rate_hz"], 30, places=1)
        page = plvo("info", file).stdout
        for words in ("database of rosbag2", "plvo run takes 6 frames", "15.0 mm from colour", "missing: no gyro"):
            self.assertIn(words, page)
        # Without depth it is described all the same, and the exit code says that it cannot be run.
        containers.write_mcap(self.folder / "a.mcap", [m for m in self.messages("cdr_le") if m[0] != DEPTH])
        told = plvo("info", self.folder / "a.mcap")
        self.assertEqual(told.returncode, 1)
        self.assertIn("plvo run cannot start: no topic has images of depth", told.stdout)
        told = plvo("info", self.recording.folder, "--json", "-")
        self.assertEqual(json.loads(told.stdout)["frames"], 6, told.stderr)

    def test_convert(self):
        file, folder = self.folder / "a.mcap", self.folder / "converted"
        containers.write_mcap(file, self.messages("cdr_be"), compression="lz4")
        made = plvo("convert", file, "--out", folder, "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.expect_equal(folder)
        self.assertEqual(plvo("convert", folder, "--out", self.folder / "x").returncode, 2)
        self.assertFalse((folder / "groundtruth.txt").exists(), "there are no true poses")

    def test_convert_writes_the_true_poses(self):
        kind = "nav_msgs/Odometry"
        messages = self.messages("cdr_le")
        rows = [[float(x) for x in row] for row in self.recording.rows("groundtruth.txt")]
        for topic in ("/truth", "/wheels"):
            for row, text in zip(rows, self.recording.rows("groundtruth.txt")):
                stamp = self.recording.ns(text[0])
                messages.append((topic, kind, stamp, ros.pose("cdr_le", kind, stamp, row[1:])))
        file, folder = self.folder / "a.mcap", self.folder / "converted"
        containers.write_mcap(file, messages)
        # Which of two is the truth nobody knows: that is said, and nothing is written.
        told = plvo("convert", file, "--out", self.folder / "without")
        self.assertEqual(told.returncode, 0, told.stderr)
        self.assertIn("several topics have poses: choose with --truth-topic", told.stderr)
        self.assertFalse((self.folder / "without" / "groundtruth.txt").exists())
        told = plvo("convert", file, "--out", folder, "--truth-topic", "/truth")
        self.assertEqual(told.returncode, 0, told.stderr)
        self.assertIn(f"{len(rows)} true poses of /truth in groundtruth.txt", told.stdout)
        written = (folder / "groundtruth.txt").read_text().splitlines()
        self.assertIn("from /truth", written[0])
        self.assertEqual(len(written), len(rows) + 1)
        for row, line in zip(rows, written[1:]):
            self.assertTrue(np.allclose([float(x) for x in line.split()], row, atol=2e-9, rtol=0))
        for recording, options in ((file, ["--truth-topic", "/truth"]), (folder, [])):
            run = plvo("run", recording, *options, "--json", self.folder / "j", "--quiet")
            self.assertEqual(run.returncode, 0, run.stderr)
            ate = json.loads((self.folder / "j").read_text())["evaluation"]["ate_m"]["rmse"]
            self.assertLess(ate, 0.05)
        # A truth that is there already is not overwritten.
        (self.folder / "mine").mkdir()
        (self.folder / "mine" / "groundtruth.txt").write_text("1 0 0 0 0 0 0 1\n")
        told = plvo("convert", file, "--out", self.folder / "mine")
        self.assertEqual(told.returncode, 1)
        self.assertIn("has groundtruth.txt already", told.stderr)

    def test_convert_writes_the_wheels(self):
        begin = self.recording.frames[0][0]
        for wire, variances in (("cdr_le", [0.04, 0.01, 0, 0, 0, 0.25]), ("ros1", [0.04, 0, 0, 0, 0, 0.25])):
            messages = self.messages(wire)
            for k in range(5):  # backwards, and the last twice
                stamp = begin + (4 - max(k, 1)) * 20_000_000
                messages.append(("/odom", "nav_msgs/Odometry", stamp, ros.pose(
                    wire, "nav_msgs/Odometry", stamp, [9] * 3 + [0, 0, 0, 1], [0.5, 0.25, 7, 7, 7, -0.125 * max(k, 1)], variances)))
            messages.append(("/odom", "nav_msgs/Odometry", begin, b"\0" * 9))
            file, folder = self.folder / "a.mcap", self.folder / wire
            containers.write_mcap(file, messages, wire=wire if wire == "ros1" else "cdr")
            told = plvo("convert", file, "--out", folder, "--wheels-topic", "/odom", "--quiet")
            self.assertEqual(told.returncode, 0, told.stderr)
            self.assertIn("2 messages on /odom left out", told.stderr)
            self.assertFalse((folder / "groundtruth.txt").exists(), "what wheels measure is no truth")
            header, *rows = (folder / "wheel_odometry.txt").read_text().splitlines()
            self.assertEqual("sigma" in header, wire == "cdr_le")
            numbers = [[float(x) for x in row.split()[1:]] for row in rows]
            sigma = [0.2, 0.1, 0.5] if wire == "cdr_le" else []
            self.assertEqual(numbers, [[0.5, 0.25, -0.125 * k, *sigma] for k in (4, 3, 2, 1)])
            base = "--base-camera 0 0 0 -0.5 0.5 -0.5 0.5".split()
            told = plvo("run", folder, "--quiet", "--wheels", folder / "wheel_odometry.txt", *base)
            self.assertEqual((told.returncode, "no samples" in told.stderr), (0, False), told.stderr)
            told = plvo("convert", file, "--out", self.folder / "x", "--wheels-topic", "/wheels")
            self.assertEqual(told.returncode, 1)
            self.assertIn("there is no odometry of wheels on /wheels; nav_msgs/Odometry is on: /odom", told.stderr)
            self.assertFalse((self.folder / "x").exists())
        # Wheels that are there already are not overwritten.
        (self.folder / "mine").mkdir()
        (self.folder / "mine" / "wheel_odometry.txt").write_text("1 0 0 0\n")
        told = plvo("convert", file, "--out", self.folder / "mine", "--wheels-topic", "/odom")
        self.assertEqual(told.returncode, 1)
        self.assertIn("has wheel_odometry.txt already", told.stderr)

    def test_hostile_databases(self):
        file = self.folder / "a.db3"

        def expect(words, *statements):
            file.unlink(missing_ok=True)
            database = sqlite3.connect(file)
            for statement in statements:
                database.execute(statement)
            database.commit()
            database.close()
            run = plvo("run", file)
            self.assertEqual(run.returncode, 1, run.stderr)
            self.assertIn(words, run.stderr)

        endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x AS id, 1 AS topic_id, x AS timestamp, 'a' AS data FROM n"
        topics = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)"
        expect("has no tables", "CREATE TABLE t(x)")
        expect("has no tables", topics, f"CREATE VIEW messages AS {endless}")
        expect("not rosbag2's", topics, "CREATE TABLE messages(x)")
        expect("no topic has images", topics, "INSERT INTO topics VALUES (1, '/a', 'sensor_msgs/msg/Image', 'cdr')",
               "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)",
               "INSERT INTO messages VALUES (1, 1, 1, zeroblob(80000000)), (2, 1, 2, 7), (3, 1, 3, NULL)")
        file.write_bytes(b"SQLite format 3\0" + bytes(1000))
        self.assertIn("is not a database", plvo("run", file).stderr)

    def test_hostile_mcap(self):
        file = self.folder / "a.mcap"
        huge = struct.pack("<BQ", 6, 1 << 60)
        for content, words in ((b"", "is not an MCAP file"), (b"\x89MCAP9\r\n", "of another version"),
                               (containers.MAGIC + huge, "cut short"),
                               (containers.MAGIC + containers.record(6, struct.pack("<QQQI", 0, 0, 1 << 62, 0) + containers.text("zstd")
                                                                     + struct.pack("<Q", 0)), "are larger than the 72 MiB")):
            file.write_bytes(content)
            run = plvo("run", file)
            self.assertEqual(run.returncode, 1)
            self.assertIn(words, run.stderr)

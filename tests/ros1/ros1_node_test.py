# SPDX-License-Identifier: Apache-2.0
"""The node for ROS 1 runs: a master, rosbag play or publishers of this test, the node, and a subscriber that compares what it publishes
with `plvo run` of the same bag. Frames of the tests without rosbag wait for the answer to the one before, so that a busy machine is
slow and not wrong."""
import contextlib
import io
import os
import pathlib
import struct
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree

import numpy as np
import pytest
from PIL import Image as Picture

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from free_port import free_port
from simulated_folder import SimulatedFolder

PLVO, PACKAGES = os.environ["PLVO_BINARY"], pathlib.Path(os.environ["PLVO_ROS1"])
NODE = PACKAGES / "plvo" / "odometry"
PATIENCE_S = 120  # for an answer; none takes longer than a second where the machine is idle
FRAMES = 10
COLOUR, DEPTH, INFO, IMU = "/camera/color/image_raw", "/camera/depth/image_raw", "/camera/color/camera_info", "/camera/imu"
AHEAD = "0.2 0 0.5 -0.5 0.5 -0.5 0.5"  # the camera looks ahead
CAMERA = "0 0 0 0 0 0 1"  # poses of the camera itself


def wait_until(what, condition):
    end = time.monotonic() + PATIENCE_S
    while not (found := condition()):
        assert time.monotonic() < end, f"waited in vain until {what}"
        time.sleep(0.005)
    return found


@contextlib.contextmanager
def running(*command):
    """A program, which is ended with the block."""
    program = subprocess.Popen([str(word) for word in command])
    try:
        yield program
    finally:
        program.terminate()
        program.wait(PATIENCE_S)


@pytest.fixture(scope="module")
def ros(tmp_path_factory):
    """ROS's modules, with a master of our own."""
    home = tmp_path_factory.mktemp("ros")
    port = free_port()
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1", ROS_HOME=str(home), ROS_LOG_DIR=str(home),
                      ROS_PACKAGE_PATH=str(PACKAGES))
    import rosgraph
    import rospy
    # The master that roscore starts; roscore itself gives up if that takes more than ten seconds.
    with running("rosmaster", "--core", "-p", port):
        wait_until("the master answers", rosgraph.is_master_online)
        rospy.init_node("ros1_node_test", disable_signals=True)
        yield rospy
        rospy.signal_shutdown("the tests are over")


# --- what is published ---------------------------------------------------------------------------------------------------------------

class RecordedSequence(SimulatedFolder):
    """A simulated folder as messages of ROS. frames: (stamp in ns, RGB, depth in mm)."""

    def __init__(self, folder, size, frames):
        made = subprocess.run([PLVO, "simulate", "--size", size, "--frames", str(frames), "--seed", "3", "--quiet", "--out", folder],
                              stderr=subprocess.PIPE, text=True, check=False)
        assert made.returncode == 0, made.stderr
        super().__init__(folder)
        self.frames = [(ns, rgb, np.round(1000 * (units / self.numbers[4])).astype("<u2")) for ns, rgb, _, units in self.frames]


@pytest.fixture(scope="module")
def sequence(tmp_path_factory):
    return RecordedSequence(tmp_path_factory.mktemp("sequence") / "sequence", "320x240", FRAMES)


def stamped(message, ns, frame="camera_color_optical_frame"):
    import rospy
    message.header.stamp = rospy.Time(ns // 10**9, ns % 10**9)
    message.header.frame_id = frame
    return message


def image(ns, pixels, encoding):
    from sensor_msgs.msg import Image
    message = stamped(Image(), ns)
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.step, message.data = encoding, pixels.strides[0], pixels.tobytes()
    return message


def compressed(ns, form, data):
    from sensor_msgs.msg import CompressedImage
    message = stamped(CompressedImage(), ns)
    message.format, message.data = form, data
    return message


def png(pixels):
    out = io.BytesIO()
    Picture.fromarray(pixels).save(out, "PNG", compress_level=1)
    return out.getvalue()


def camera_info(sequence, ns, model="plumb_bob"):
    from sensor_msgs.msg import CameraInfo
    fx, fy, cx, cy = sequence.numbers[:4]
    message = stamped(CameraInfo(), ns)
    message.height, message.width = sequence.frames[0][2].shape
    message.distortion_model, message.D = model, (sequence.numbers[5:10] + [0] * 5)[:5]
    message.K = [fx, 0, cx, 0, fy, cy, 0, 0, 1]
    return message


# How a driver may publish colour and millimetres of depth.
def raw(ns, rgb, depth):
    return image(ns, rgb, "rgb8"), image(ns, depth, "16UC1")


def metres(ns, rgb, depth):
    depth = np.where(depth == 0, np.nan, depth / 1000).astype("<f4")
    return image(ns, np.ascontiguousarray(rgb[:, :, ::-1]), "bgr8"), image(ns, depth, "32FC1")


def packed(ns, rgb, depth):
    form = struct.pack("<iff", 0, 0, 0)
    return (compressed(ns, "rgb8; png compressed bgr8", png(rgb)),
            compressed(ns, "16UC1; compressedDepth", form + png(depth)))


def imu_messages(sequence):
    from sensor_msgs.msg import Imu
    for gyro, acceleration in zip(sequence.rows("gyroscope.txt"), sequence.rows("accelerometer.txt")):
        message = stamped(Imu(), sequence.ns(gyro[0]), "imu")
        rate, force = message.angular_velocity, message.linear_acceleration
        rate.x, rate.y, rate.z = map(float, gyro[1:4])
        force.x, force.y, force.z = map(float, acceleration[1:4])
        message.orientation_covariance[0] = -1
        yield message


# --- what plvo run says --------------------------------------------------------------------------------------------------------------

def rows_of(path):
    lines = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    return {RecordedSequence.ns(line[0]): np.array(line[1:], dtype=float) for line in lines}


def bag_of(sequence, kind, path, imu=False):
    import rosbag
    with rosbag.Bag(str(path), "w") as bag:
        for message in imu_messages(sequence) if imu else ():
            bag.write(IMU, message, message.header.stamp)
        for ns, rgb, depth in sequence.frames:
            info, (colour, depth) = camera_info(sequence, ns), kind(ns, rgb, depth)
            for topic, message in ((INFO, info), (DEPTH, depth), (COLOUR, colour)):
                bag.write(topic, message, message.header.stamp)


def run(folder, bag, base_camera, *options):
    """The poses and covariances of plvo run, by stamp."""
    poses, covariances = folder / "poses.txt", folder / "covariances.txt"
    done = subprocess.run([PLVO, "run", str(bag), "--quiet", "--out", str(poses), "--covariance", str(covariances), "--base-camera",
                           *base_camera.split(), *options], stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return rows_of(poses), rows_of(covariances)


def pose_of(odometry):
    p, q = odometry.pose.pose.position, odometry.pose.pose.orientation
    return np.array([p.x, p.y, p.z, q.x, q.y, q.z, q.w])


def matrix(pose):
    x, y, z, w = pose[3:]
    T = np.eye(4)
    T[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    T[:3, 3] = pose[:3]
    return T


def assert_same(odometries, expected):
    """Poses to 1 µm, covariances to seven digits, and the frames and the order that ROS wants."""
    poses, covariances = expected
    assert sorted(odometries) == sorted(poses)
    for ns, message in odometries.items():
        assert np.abs(pose_of(message) - poses[ns]).max() < 1e-6
        of_pose = np.array(message.pose.covariance)
        assert np.abs(of_pose - covariances[ns]).max() < 1e-12 + 1e-7 * np.abs(covariances[ns]).max()
        assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")
    assert np.array(odometries[max(odometries)].pose.covariance).reshape(6, 6).diagonal().min() > 0


# --- the node ------------------------------------------------------------------------------------------------------------------------

class Session:
    """A node, its publishers and its subscribers. Topics have names of their own, as messages of an earlier test may still be on
    their way."""
    count = 0

    def __init__(self, ros, sequence, kind=raw, **parameters):
        from diagnostic_msgs.msg import DiagnosticArray
        from geometry_msgs.msg import PoseWithCovarianceStamped
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import CameraInfo, Imu
        from tf2_msgs.msg import TFMessage
        Session.count += 1
        self.ros, self.sequence, self.kind, self.name = ros, sequence, kind, f"plvo{Session.count}"
        self.lock, self.odometries, self.transforms, self.reports = threading.Lock(), {}, {}, []
        colour, depth = kind(*sequence.frames[0])
        topic = f"/{self.name}/"
        self.publishers = {name: ros.Publisher(topic + name, type_, queue_size=1000) for name, type_ in (
            ("camera_info", CameraInfo), ("colour", type(colour)), ("depth", type(depth)), ("set_pose", PoseWithCovarianceStamped))}
        if parameters.get("imu"):
            self.publishers["imu"] = ros.Publisher(topic + "imu", Imu, queue_size=1000)
        self.subscribers = [ros.Subscriber(topic + "odom", Odometry, self.take_odometry),
                            ros.Subscriber("/tf", TFMessage, self.take_transforms),
                            ros.Subscriber("/diagnostics", DiagnosticArray, self.take_diagnostics)]
        self.command = [NODE, f"__name:={self.name}", *(f"{name}:={topic}{name}" for name in (
            "camera_info", "colour", "depth", "imu", "odom")), *(f"_{name}:={value}" for name, value in parameters.items())]

    @contextlib.contextmanager
    def runs(self):
        with running(*self.command):
            for name, publisher in self.publishers.items():
                wait_until(f"the node subscribes to {name}", publisher.get_num_connections)
            wait_until("the node publishes", lambda: all(subscriber.get_num_connections() for subscriber in self.subscribers[::2]))
            yield self
        for endpoint in (*self.publishers.values(), *self.subscribers):
            endpoint.unregister()

    def take_odometry(self, message):
        with self.lock:
            self.odometries[message.header.stamp.to_nsec()] = message

    def take_transforms(self, message):
        with self.lock:
            self.transforms.update({t.header.stamp.to_nsec(): t for t in message.transforms if t.header.frame_id == "odom"})

    def take_diagnostics(self, message):
        with self.lock:
            self.reports.extend(s for s in message.status if s.name == f"{self.name}: odometry")

    def report(self, text):
        """The diagnosis that has this text."""
        def find():
            with self.lock:
                return next((s for s in self.reports if text in s.message or text in str(s.values)), None)
        return wait_until(f"the diagnosis says {text!r}", find)

    def send(self, i, rgb=None):
        ns, colour, depth = self.sequence.frames[i]
        colour, depth = self.kind(ns, colour if rgb is None else rgb, depth)
        self.publishers["camera_info"].publish(camera_info(self.sequence, ns))
        self.publishers["depth"].publish(depth)
        self.publishers["colour"].publish(colour)
        return ns

    def track(self, i):
        """Publishes a frame and returns its odometry."""
        ns = self.send(i)

        def answer():
            with self.lock:
                return self.odometries.get(ns)
        return wait_until(f"there is odometry of frame {i}", answer)


# --- tests ---------------------------------------------------------------------------------------------------------------------------

def test_a_bag_that_is_played_gives_the_poses_of_plvo_run(ros, sequence, tmp_path):
    from nav_msgs.msg import Odometry
    from tf2_msgs.msg import TFMessage
    bag_of(sequence, raw, tmp_path / "sequence.bag")
    odometries, transforms = {}, {}
    odometry = ros.Subscriber("/plvo/odom", Odometry, lambda m: odometries.update({m.header.stamp.to_nsec(): m}))
    tf = ros.Subscriber("/tf", TFMessage, lambda m: transforms.update({t.header.stamp.to_nsec(): t for t in m.transforms}))
    launch = ("roslaunch", "plvo", "plvo.launch", f"colour:={COLOUR}", f"depth:={DEPTH}", f"camera_info:={INFO}", "odom:=/plvo/odom",
              f"base_camera:={AHEAD}", "queue_size:=100")
    with running(*launch):
        wait_until("the node publishes", lambda: odometry.get_num_connections() and tf.get_num_connections())
        with running("rosbag", "play", "--quiet", "--wait-for-subscribers", "--keep-alive", tmp_path / "sequence.bag"):
            wait_until("all frames have odometry", lambda: len(odometries) == FRAMES and len(transforms) == FRAMES)
    assert_same(odometries, run(tmp_path, tmp_path / "sequence.bag", AHEAD))
    for ns, message in odometries.items():  # the transform is the pose
        transform = transforms[ns]
        assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
        t = transform.transform.translation
        assert [t.x, t.y, t.z] == list(pose_of(message)[:3])
    odometry.unregister()
    tf.unregister()


@pytest.mark.parametrize("kind", [raw, metres, packed])
def test_every_transport_gives_the_poses_of_plvo_run(ros, sequence, tmp_path, kind):
    bag_of(sequence, kind, tmp_path / "sequence.bag")
    with Session(ros, sequence, kind, base_camera=CAMERA, publish_tf="false", exact_sync="true").runs() as session:
        odometries = {session.sequence.frames[i][0]: session.track(i) for i in range(FRAMES)}
        assert_same(odometries, run(tmp_path, tmp_path / "sequence.bag", CAMERA))
        assert not session.transforms, "tf is switched off"
        assert session.report("tracking").level == 0


def test_the_twist_is_the_velocity_in_the_axes_of_the_base(ros, sequence):
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        messages = [session.track(i) for i in range(FRAMES)]
    unknown = np.array(messages[0].twist.covariance).reshape(6, 6)
    assert np.array_equal(unknown, 1e6 * np.eye(6)), "nothing is known of the first frame's"
    truth = {sequence.ns(row[0]): matrix(np.array(row[1:], dtype=float)) for row in sequence.rows("groundtruth.txt")}
    T_base_camera = matrix(np.array(AHEAD.split(), dtype=float))
    nees = []
    for before, now in zip(messages, messages[1:]):
        stamps = before.header.stamp.to_nsec(), now.header.stamp.to_nsec()
        seconds = (stamps[1] - stamps[0]) * 1e-9
        linear, angular = now.twist.twist.linear, now.twist.twist.angular
        twist = np.array([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])
        covariance = np.array(now.twist.covariance).reshape(6, 6)

        def velocity(before, now):
            T = np.linalg.inv(now) @ before  # where the base was, seen from now
            R = T[:3, :3]
            angle = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2  # small
            return -np.concatenate([T[:3, 3], angle]) / seconds
        assert np.abs(twist - velocity(matrix(pose_of(before)), matrix(pose_of(now)))).max() < 1e-3
        true = velocity(*(truth[ns] @ np.linalg.inv(T_base_camera) for ns in stamps))
        error = twist - true
        nees.append(error @ np.linalg.solve(covariance, error))
    assert 0.1 < np.mean(nees) < 12, f"6 if the covariance were exact: {nees}"


def test_lost_frames_are_not_published_and_the_reason_is_in_the_diagnosis(ros, sequence):
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        session.track(0)
        session.track(1)
        dark = session.send(2, rgb=np.zeros_like(sequence.frames[2][1]))
        report = session.report("lost: hardly anything to see")
        assert report.level == 1 and report.message.startswith("lost: hardly")
        after = session.track(3)
        assert dark not in session.odometries and after.header.stamp.to_nsec() == sequence.frames[3][0]
        assert "1" == next(v.value for v in session.reports[-1].values if v.key == "frames without a pose")


def test_reset_starts_anew(ros, sequence):
    from std_srvs.srv import Trigger
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        first = [pose_of(session.track(i)) for i in range(3)]
        answer = ros.ServiceProxy(f"/{session.name}/reset", Trigger)()
        assert answer.success
        session.odometries.clear()
        again = [pose_of(session.track(i)) for i in range(3)]  # of the same stamps
        assert np.array_equal(first, again)


def test_set_pose_moves_the_base(ros, sequence):
    from geometry_msgs.msg import PoseWithCovarianceStamped
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        before = [matrix(pose_of(session.track(i))) for i in range(FRAMES)]
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        session.track(0)
        session.track(1)
        wanted = stamped(PoseWithCovarianceStamped(), 1, "odom")
        p, q = wanted.pose.pose.position, wanted.pose.pose.orientation
        p.x, p.y, p.z, q.z, q.w = 3, -2, 0.1, 0.6, 0.8
        wanted.pose.covariance = (0.01 * np.eye(6)).ravel()
        wanted.header.frame_id = "map"
        session.publishers["set_pose"].publish(wanted)
        wanted.header.frame_id = "odom"
        session.publishers["set_pose"].publish(wanted)
        session.report("poses set\"\nvalue: \"1\"")
        moved = session.track(2)
        expected = matrix(np.array([3, -2, 0.1, 0, 0, 0.6, 0.8])) @ np.linalg.inv(before[1]) @ before[2]
        assert np.abs(matrix(pose_of(moved)) - expected).max() < 1e-6
        assert moved.pose.covariance[0] > 0.01
        assert abs(moved.twist.twist.linear.x) < 1, "the jump is not a velocity"


def test_set_pose_before_the_first_frame_is_that_frame_s(ros, sequence):
    from geometry_msgs.msg import PoseWithCovarianceStamped
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        wanted = PoseWithCovarianceStamped()
        p, q = wanted.pose.pose.position, wanted.pose.pose.orientation
        p.x, p.y, p.z, q.z, q.w = 3, -2, 0.1, 0.6, 0.8
        session.publishers["set_pose"].publish(wanted)
        session.report("poses set\"\nvalue: \"1\"")
        assert np.abs(pose_of(session.track(0)) - [3, -2, 0.1, 0, 0, 0.6, 0.8]).max() < 1e-9


def test_an_imu_gives_the_poses_of_plvo_run_with_imu(ros, sequence, tmp_path):
    bag_of(sequence, raw, tmp_path / "sequence.bag", imu=True)
    with Session(ros, sequence, base_camera=AHEAD, imu="true", camera_imu="0 0 0 1", imu_wait_s=PATIENCE_S, level="true").runs() as session:
        for message in imu_messages(sequence):
            session.publishers["imu"].publish(message)
        # The last frame may have no reading after it.
        odometries = {sequence.frames[i][0]: session.track(i) for i in range(FRAMES - 1)}
        poses, covariances = run(tmp_path, tmp_path / "sequence.bag", AHEAD, "--imu", "--level")
        last = sequence.frames[-1][0]
        assert_same(odometries, ({ns: row for ns, row in poses.items() if ns != last}, covariances))
        tilt = pose_of(odometries[sequence.frames[0][0]])[3:5]
        assert np.abs(tilt).max() > 1e-4, "odom is level, and the camera is not"


def test_the_place_of_the_camera_comes_from_tf(ros, sequence, tmp_path):
    from geometry_msgs.msg import TransformStamped
    from tf2_msgs.msg import TFMessage
    bag_of(sequence, raw, tmp_path / "sequence.bag")
    with Session(ros, sequence).runs() as session:
        ns = session.send(0)
        report = session.report("images wait for a transform from camera_color_optical_frame to base_link")
        assert report.level == 1 and not session.odometries
        transform = stamped(TransformStamped(), ns, "base_link")
        transform.child_frame_id = "camera_color_optical_frame"
        t, q = transform.transform.translation, transform.transform.rotation
        t.x, t.y, t.z, q.x, q.y, q.z, q.w = map(float, AHEAD.split())
        static = ros.Publisher("/tf_static", TFMessage, latch=True, queue_size=1)
        static.publish(TFMessage([transform]))
        odometries = {sequence.frames[i][0]: session.track(i) for i in range(1, FRAMES)}
        odometries[ns] = session.odometries[ns]  # it waited
        assert_same(odometries, run(tmp_path, tmp_path / "sequence.bag", AHEAD))
        static.unregister()


def test_what_cannot_be_tracked_is_named(ros, sequence):
    with Session(ros, sequence, base_camera=AHEAD).runs() as session:
        ns, rgb, depth = sequence.frames[0]
        session.publishers["camera_info"].publish(camera_info(sequence, ns, "omnidirectional"))
        session.report("'omnidirectional' is not supported")
        session.publishers["depth"].publish(image(ns, rgb, "rgb8"))
        session.publishers["camera_info"].publish(camera_info(sequence, ns))
        session.publishers["colour"].publish(image(ns, rgb, "rgb8"))
        report = session.report("the encoding 'rgb8' is not read there")
        assert report.level == 2 and report.message.startswith("error: ")
        session.track(1)
        other = camera_info(sequence, ns)
        other.K = [2 * k for k in other.K]
        session.publishers["camera_info"].publish(other)
        session.track(2)


def test_the_page_has_every_argument_of_the_launch_file():
    arguments = xml.etree.ElementTree.parse(PACKAGES / "plvo" / "launch" / "plvo.launch").getroot().findall("arg")
    page = pathlib.Path(os.environ["PLVO_PAGE"]).read_text().partition("## Topics and parameters")[2].partition("\n## ")[0]
    assert len(arguments) > 10
    for argument in arguments:
        assert f"`{argument.get('name')}`" in page, argument.get("name")


@pytest.mark.parametrize("parameter, words", [
    ("_base_camera:=0 0 0", "~base_camera must be seven numbers: tx ty tz qx qy qz qw"),
    ("_base_camera:=0 0 0 0 0 0 2", "~base_camera: the quaternion x y z w must have the length 1, not 2"),
    ("_imu:=1", "~imu has a value of another type"),
    ("_level:=true", "~level is by the accelerometer of imu: set that, too")])
def test_a_wrong_parameter_ends_the_node(ros, parameter, words):
    Session.count += 1  # parameters stay with the name
    done = subprocess.run([str(NODE), f"__name:=plvo{Session.count}", parameter], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert done.returncode == 2
    assert words in done.stdout + done.stderr

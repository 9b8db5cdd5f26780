# SPDX-License-Identifier: Apache-2.0
from collections.abc import Iterable, Iterator, Sequence as _ListLike
from os import PathLike
from typing import Any, Literal, NamedTuple

from numpy import bool_, float32, float64, int64, uint8, uint16
from numpy.typing import NDArray

__version__: str

_Array = NDArray[Any] | _ListLike[Any]
_Path = str | bytes | PathLike[str] | PathLike[bytes]
_Topic = Literal["colour", "depth", "camera_info", "gyro", "accelerometer"]

class Error(Exception):
    """What went wrong, and what to do."""

    code: str  # "not_found", "invalid_argument", …

class Camera:
    """A pinhole with a lens, and the unit of depth.

    distortion, by distortion_model as in ROS: "plumb_bob" (k1 k2 p1 p2 [k3]), "rational_polynomial"
    (… k4 k5 k6), "equidistant" (the fisheye's k1 k2 k3 k4). Without a model: as many as OpenCV's means.
    """

    def __init__(
        self,
        width: int,
        height: int,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        distortion: Iterable[float] = (),
        depth_units_per_metre: float = 1000,
        readout_s: float = 0,
        depth_delay_s: float | None = None,
        depth_readout_s: float = 0,
        distortion_model: str = "",
        stamp_sigma_s: float = 0,
    ) -> None: ...
    @staticmethod
    def builtin(name: str) -> Camera: ...
    @staticmethod
    def read(path: _Path) -> Camera: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def fx(self) -> float: ...
    @property
    def fy(self) -> float: ...
    @property
    def cx(self) -> float: ...
    @property
    def cy(self) -> float: ...
    @property
    def K(self) -> NDArray[float64]:
        """The intrinsic matrix, 3x3, in pixels: fx 0 cx, 0 fy cy, 0 0 1. A copy."""
    @property
    def distortion(self) -> tuple[float, ...]: ...
    @property
    def distortion_model(self) -> str: ...
    @property
    def readout_s(self) -> float: ...
    @property
    def stamp_sigma_s(self) -> float: ...
    @property
    def depth_units_per_metre(self) -> float: ...

class Config:
    """How the odometry is set; None leaves an entry to the preset. tiny brings small limits with it, for images of 320x240.
    frame_budget_ns: what a frame may take (see Odometry.frame_took), 0: as long as it takes; fewer features after one that took
    longer, more again after budget_patience_frames in a row that took less than budget_spare_share of it. level_world: the world's y
    axis points down; the first frame waits for one whose prior brings gravity."""

    def __init__(
        self,
        *,
        preset: Literal["default", "paper", "tiny"] = "default",
        features: Literal["points", "lines", "both"] | None = None,
        reference: Literal["previous", "keyframe", "both", "window"] | None = None,
        seed: int | None = None,
        frame_budget_ns: int = 0,
        budget_patience_frames: int = ...,
        budget_spare_share: float = ...,
        level_world: bool = False,
    ) -> None: ...
    @property
    def seed(self) -> int: ...
    @property
    def frame_budget_ns(self) -> int: ...

class Counts:
    @property
    def detected(self) -> int: ...
    @property
    def dropped(self) -> int: ...
    @property
    def with_depth(self) -> int: ...
    @property
    def matched(self) -> int: ...
    @property
    def inliers(self) -> int: ...

class Result:
    """What the odometry says about one frame. Arrays are views and cannot be written."""

    @property
    def state(self) -> Literal["initialising", "tracking", "lost", "predicted"]: ...
    @property
    def has_pose(self) -> bool: ...
    @property
    def code(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def stamp_ns(self) -> int: ...
    @property
    def stamp(self) -> float: ...
    @property
    def reference_stamp_ns(self) -> int: ...
    @property
    def T_world_camera(self) -> NDArray[float64]: ...
    @property
    def T_camera_reference(self) -> NDArray[float64]: ...
    @property
    def position(self) -> NDArray[float64]: ...
    @property
    def quaternion(self) -> NDArray[float64]: ...
    @property
    def covariance(self) -> NDArray[float64]: ...
    @property
    def motion_covariance(self) -> NDArray[float64]: ...
    @property
    def points(self) -> Counts: ...
    @property
    def lines(self) -> Counts: ...
    @property
    def ransac_iterations(self) -> int: ...
    @property
    def lm_iterations(self) -> int: ...
    @property
    def mean_brightness(self) -> float: ...
    @property
    def returned(self) -> bool: ...
    @property
    def repeated(self) -> bool:
        """The colour image is that of the frame before; the pose is predicted."""
    @property
    def feature_step(self) -> int:
        """Of the budget of time: 0, all the features that fit, to 8."""

class Features(NamedTuple):
    """What the last frame was made of, in pixels of the undistorted image."""

    image: NDArray[uint8]
    keypoints: NDArray[float32]  # u v; none where points were not looked for
    segments: NDArray[float32]  # u v u v
    segment_has_3d: NDArray[bool_]
    reference_segments: NDArray[float32]
    point_tracks: NDArray[float32]  # u v in the reference, u v in the frame
    point_inliers: NDArray[bool_]
    line_tracks: NDArray[uint16]  # indices into reference_segments and segments
    line_inliers: NDArray[bool_]

class MotionPrior:
    """What other sensors say of a frame: pairs of a value and its 3x3 covariance, in the camera's axes now."""

    def __init__(
        self,
        *,
        rotation: tuple[_Array, _Array] | None = None,
        translation: tuple[_Array, _Array] | None = None,
        gravity: tuple[_Array, _Array] | None = None,
        gravity_offset_sigma: float = 0.0,
    ) -> None: ...
    @staticmethod
    def of_wheels(
        steps: _ListLike[tuple[float, _Array, _Array]], T_base_camera: _Array, error_s: float = 0.0
    ) -> MotionPrior:
        """What wheels measured since the frame before: steps of (seconds, twist, covariance), oldest first. A twist is vx vy
        vz wx wy wz of the robot's base (m/s, rad/s, x forward, z up), with its 6x6 covariance; wheels measure neither vz nor
        wx nor wy. T_base_camera: 4x4. error_s: for how long an error of a twist lasts (slip); 0: a step."""
    @property
    def R_now_before(self) -> NDArray[float64] | None: ...
    @property
    def rotation_covariance(self) -> NDArray[float64] | None: ...
    @property
    def t_now_before(self) -> NDArray[float64] | None: ...
    @property
    def translation_covariance(self) -> NDArray[float64] | None: ...
    @property
    def down(self) -> NDArray[float64] | None: ...
    @property
    def gravity_covariance(self) -> NDArray[float64] | None: ...

class Imu:
    """A gyro (rad/s) and an accelerometer (m/s^2): samples in, a prior for each frame out."""

    def __init__(
        self,
        *,
        R_camera_imu: _Array | None = None,
        gyro_noise: float = ...,
        gyro_offset_sigma: float = ...,
        gyro_offset_walk: float = ...,
        gyro_scale_sigma: float = ...,
        accelerometer_noise: float = ...,
        accelerometer_offset_sigma: float = ...,
        acceleration: float = ...,
        acceleration_s: float = ...,
        longest_gap_s: float = ...,
    ) -> None: ...
    def add_gyro(self, stamp_ns: int, rate: _Array) -> bool: ...
    def add_acceleration(self, stamp_ns: int, force: _Array) -> bool: ...
    def prior(self, stamp_ns: int) -> MotionPrior: ...
    def learn(self, result: Result) -> None: ...
    @property
    def gyro_offset(self) -> NDArray[float64]:
        """What was learnt of it so far: rad/s, in the sensor's axes."""
    @property
    def gyro_offset_variance(self) -> NDArray[float64]: ...

class RecordedImu:
    """What a gyro and an accelerometer recorded beside the images: Sequence.imu()."""

    def prior(self, stamp_ns: int) -> MotionPrior: ...
    def learn(self, result: Result) -> None: ...

class Odometry:
    """Frames in, poses out. What is None of the limits is the preset's. cores: 2 for a second thread; the same bits.
    mask: (height, width) of the camera's images, before undistortion; False or 0 where a pixel must not be used, because it
    shows what travels with the camera: a part of the robot, burnt-in text. It is copied."""

    def __init__(
        self,
        camera: Camera,
        config: Config | None = None,
        *,
        keypoints: int | None = None,
        segments: int | None = None,
        references: int | None = None,
        line_bands: int | None = None,
        kept_keyframes: int | None = None,
        surfaces: int | None = None,
        cores: int = 1,
        mask: NDArray[uint8] | NDArray[bool_] | None = None,
    ) -> None: ...
    def track(
        self,
        colour: NDArray[uint8],
        depth: NDArray[uint16],
        stamp_ns: int,
        depth_stamp_ns: int | None = None,
        *,
        bgr: bool = False,
        prior: MotionPrior | None = None,
    ) -> Result: ...
    def frame_took(self, ns: int) -> None:
        """What the last track took, by a clock of yours, for Config's budget. The same words give the same bits."""

    def reset(self) -> None: ...
    def set_pose(self, T_world_camera: _Array, covariance: _Array | None = None) -> None: ...
    def features(self) -> Features: ...
    @property
    def memory_bytes(self) -> int: ...

class MapResult:
    """Where the camera is in a map, after a frame."""

    @property
    def located(self) -> bool:
        """False after Map.load(), and in a new world of the odometry, until a place is recognised: T_map_world has no
        meaning until then."""
    @property
    def recognised(self) -> bool:
        """A place was, in this frame."""
    @property
    def keyframe(self) -> int:
        """The latest one; 0: none yet."""
    @property
    def T_map_world(self) -> NDArray[float64]:
        """4x4; T_map_world @ result.T_world_camera is the camera in the map."""
    @property
    def covariance(self) -> NDArray[float64]:
        """6x6, of the camera in the map: position before orientation."""
    @property
    def T_keyframe_camera(self) -> NDArray[float64]:
        """With Map.keyframe_pose(keyframe) of a later time, the pose of this frame with the corrections that came since."""
    @property
    def removed(self) -> int:
        """A keyframe that made room in this frame, or 0."""
    @property
    def removed_into(self) -> int: ...
    @property
    def T_into_removed(self) -> NDArray[float64]:
        """The pose of the removed keyframe relative to removed_into."""

class Map:
    """The places that the camera has seen: corrects the drift where one comes back. camera and config: those of the
    odometry."""

    def __init__(
        self, camera: Camera, config: Config | None = None, *, keyframes: int = 256, keypoints: int = 200, segments: int = 64
    ) -> None: ...
    def update(self, odometry: Odometry, result: Result) -> MapResult:
        """Right after Odometry.track(), with its result, for each frame."""
    def settle(self) -> None:
        """Does all the work that waits; for the end of a run."""
    def save(self, path: _Path) -> None:
        """Settles the map, then writes it. The file that was there stays until the new one is whole."""
    def load(self, path: _Path) -> None:
        """Replaces the map by a saved one, in which the camera then looks for its place."""
    def keyframe_pose(self, keyframe: int) -> NDArray[float64] | None:
        """As it is known now; None if it was removed or its place in the map is not known."""
    @property
    def keyframes(self) -> int: ...
    @property
    def loops(self) -> int:
        """Pairs of keyframes that are joined as the same place."""
    @property
    def memory_bytes(self) -> int: ...

class Frame(NamedTuple):
    colour: NDArray[uint8]
    depth: NDArray[uint16]
    stamp_ns: int
    depth_stamp_ns: int

class Sequence:
    """A recorded folder or recording of ROS, frame by frame, once."""

    def __init__(
        self, recording: _Path, camera: Camera | _Path | None = None, *, topics: dict[_Topic, str] | None = None
    ) -> None: ...
    @property
    def camera(self) -> Camera: ...
    def imu(self, *, R_camera_imu: _Array | None = None) -> RecordedImu:
        """gyroscope.txt and accelerometer.txt of the folder, or sensor_msgs/Imu of the bag."""
    def __len__(self) -> int: ...
    def __enter__(self) -> Sequence: ...
    def __exit__(self, *args: object) -> None:
        """Ends the reading: a further frame is a ValueError. Frames that were handed out stay."""
    def __iter__(self) -> Iterator[Frame]: ...
    def __next__(self) -> Frame: ...

class Trajectory:
    """The poses of results, lost frames left out."""

    def __init__(self, results: Iterable[Result]) -> None: ...
    @property
    def stamps_ns(self) -> NDArray[int64]:
        """Shape (N,), nanoseconds."""
    @property
    def positions(self) -> NDArray[float64]:
        """Shape (N, 3), metres, in the world."""
    @property
    def quaternions(self) -> NDArray[float64]:
        """Shape (N, 4), x y z w: camera to world."""
    def __len__(self) -> int: ...
    def save(self, path: str | PathLike[str]) -> None:
        """Writes the form of TUM: stamp tx ty tz qx qy qz qw, one pose a line. OSError where the file cannot be written."""

def to_dataframe(results: Iterable[Result]) -> Any:
    """A pandas.DataFrame, a row for each result. ImportError without pandas, which plvo itself does not need."""

def run(
    recording: _Path,
    camera: Camera | _Path | None = None,
    config: Config | None = None,
    *,
    imu: bool = False,
    R_camera_imu: _Array | None = None,
    cores: int = 1,
    topics: dict[_Topic, str] | None = None,
    mask: NDArray[uint8] | NDArray[bool_] | None = None,
) -> Iterator[Result]: ...
def evaluate(
    truth: _Path,
    estimate: _Path | Iterable[Result],
    *,
    sampling: Literal["interpolated", "nearest"] = "interpolated",
    max_difference_s: float = 0.02,
    offset_s: float = 0.0,
    rpe_deltas: Iterable[str] = ("1f", "1s"),
    truth_sigma: tuple[float, float] = (0.0, 0.0),
    fit_truth: bool = False,
) -> dict[str, Any]: ...

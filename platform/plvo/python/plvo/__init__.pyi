# SPDX-License-Identifier: Apache-2.0
"""Types and docstrings of the package. The build takes the docstrings of the module from this file (docstrings.py)."""
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
    """What the library refuses or cannot do: its text says what went wrong and what to do.

    Attributes
    ----------
    code : str
        The name of the status: "not_found", "invalid_argument", "damaged", …
    """

    code: str

class Camera:
    """A pinhole with a lens, the unit of depth, and the times of the exposure. A value.

    Pixel (0, 0) is the centre of the top left pixel.

    Parameters
    ----------
    width, height : int
        Size of the images, px. An Odometry takes 64 to 2047.
    fx, fy : float
        Focal lengths, px.
    cx, cy : float
        Principal point, px.
    distortion : iterable of float
        Coefficients of the lens, in the order of `distortion_model`. None: no distortion.
    depth_units_per_metre : float
        What a depth image counts in a metre, 1 to 100000: 1000 for mm.
    readout_s : float
        Rolling shutter: time from the exposure of the first row of colour to that of the last, s; 0 for a global shutter.
    depth_delay_s : float or None
        Time from the stamp of depth to the exposure of its middle row, s. None: depth is exposed as colour is, and its stamp is
        not used.
    depth_readout_s : float
        As `readout_s`, of the depth image; needs `depth_delay_s`.
    distortion_model : str
        As in ROS: "plumb_bob" (k1 k2 p1 p2 [k3]), "rational_polynomial" (k1 k2 p1 p2 k3 k4 k5 k6) or "equidistant" (the k1 k2
        k3 k4 of a fisheye). Empty: the number of coefficients decides, as in OpenCV.
    stamp_sigma_s : float
        Standard deviation of the time between the stamp of colour and the exposure of its middle row, s.

    Raises
    ------
    ValueError
        The lens has another number of coefficients, or its model is unknown.
    plvo.Error
        "invalid_argument": a number is out of range; the message names it.
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
    def builtin(name: str) -> Camera:
        """A camera that plvo knows.

        Parameters
        ----------
        name : str
            "tum-fr1", "tum-fr2", "tum-fr3", "7scenes" or "kinect-v1-default".

        Returns
        -------
        Camera
            That camera.

        Raises
        ------
        plvo.Error
            "not_found": the message lists the names.
        """
    @staticmethod
    def read(path: _Path) -> Camera:
        """Reads a calibration file, in plvo's format or in that of ROS, Kalibr, EuRoC, ORB-SLAM or Open3D.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            The file. Where it does not say the size of the images, a Sequence takes that of its own.

        Returns
        -------
        Camera
            What the file says.

        Raises
        ------
        plvo.Error
            "not_found", "damaged" or "unsupported", with the place in the file.
        """
    @property
    def width(self) -> int:
        """Width of the images, px."""
    @property
    def height(self) -> int:
        """Height of the images, px."""
    @property
    def fx(self) -> float:
        """Focal length along the rows, px."""
    @property
    def fy(self) -> float:
        """Focal length along the columns, px."""
    @property
    def cx(self) -> float:
        """Column of the principal point, px."""
    @property
    def cy(self) -> float:
        """Row of the principal point, px."""
    @property
    def K(self) -> NDArray[float64]:
        """The intrinsic matrix, (3, 3), px: fx 0 cx, 0 fy cy, 0 0 1. A copy."""
    @property
    def distortion(self) -> tuple[float, ...]:
        """Coefficients of the lens: 4, 5 or 8, in the order of `distortion_model`."""
    @property
    def distortion_model(self) -> str:
        """The name of the lens model: "plumb_bob", "rational_polynomial" or "equidistant"."""
    @property
    def readout_s(self) -> float:
        """Time from the exposure of the first row of colour to that of the last, s."""
    @property
    def depth_delay_s(self) -> float | None:
        """Time from the stamp of depth to the exposure of its middle row, s; None if it is not known."""
    @property
    def depth_readout_s(self) -> float:
        """Time from the exposure of the first row of depth to that of the last, s."""
    @property
    def stamp_sigma_s(self) -> float:
        """Standard deviation of the stamps of colour, s."""
    @property
    def depth_units_per_metre(self) -> float:
        """What a depth image counts in a metre."""

class Config:
    """How the odometry is set. A value.

    Parameters
    ----------
    preset : {"default", "paper", "tiny"}
        "paper" follows Lu & Song (2015). "tiny" fits into half a MiB, with limits for images of 320x240.
    features : {"points", "lines", "both"} or None
        What the motion is estimated from. None: as the preset.
    reference : {"previous", "keyframe", "both", "window"} or None
        The frames that the current one is matched with. None: as the preset.
    seed : int or None
        Of the random generators, 0 to 2**64 - 1. None: as the preset.
    frame_budget_ns : int
        What a frame may take, ns (see Odometry.frame_took); 0: as long as it takes. A frame that took longer is followed by frames with
        fewer features.
    budget_patience_frames : int
        The number of features rises after so many frames in a row that took less than `budget_spare_share` of the budget.
    budget_spare_share : float
        That share, 0 to 1.
    level_world : bool
        The y axis of the world points down. Tracking then starts with the first frame whose prior has gravity.

    Raises
    ------
    ValueError
        A name is none of those above; the message lists them.
    plvo.Error
        "invalid_argument": a number is out of range; the message names it.
    """

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
    def preset(self) -> Literal["default", "paper", "tiny"]:
        """The preset that the other settings start from."""
    @property
    def features(self) -> Literal["points", "lines", "both"]:
        """What the motion is estimated from."""
    @property
    def reference(self) -> Literal["previous", "keyframe", "both", "window"]:
        """The frames that the current one is matched with."""
    @property
    def seed(self) -> int:
        """Seed of the random generators."""
    @property
    def frame_budget_ns(self) -> int:
        """What a frame may take, ns; 0: as long as it takes."""
    @property
    def budget_patience_frames(self) -> int:
        """Frames in a row below the spare share, after which there are more features."""
    @property
    def budget_spare_share(self) -> float:
        """Share of the budget below which a frame has time to spare."""
    @property
    def level_world(self) -> bool:
        """Whether the y axis of the world points down."""

class Counts:
    """How many features of a kind a frame has. A value.

    If no points were searched in a frame, the first three numbers of its points are those of the latest frame in which they were.
    """

    @property
    def detected(self) -> int:
        """Features found, before the selection."""
    @property
    def dropped(self) -> int:
        """Features found beyond the capacity."""
    @property
    def with_depth(self) -> int:
        """Features with a 3D position."""
    @property
    def matched(self) -> int:
        """Features matched with a reference, before the estimate."""
    @property
    def inliers(self) -> int:
        """Matches that agree with the estimated motion."""

class Result:
    """The pose of one frame, how certain it is, and what it comes from. A value.

    Camera axes: x right, y down, z forward. The world is the camera of the first frame, unless Config(level_world=True) or
    Odometry.set_pose say otherwise. Arrays cannot be written where they are views.
    """

    @property
    def state(self) -> Literal["initialising", "tracking", "lost", "predicted"]:
        """What became of the frame.

        "initialising": the first usable frame, or none yet. "tracking": the pose is new. "lost": the pose is the last good one.
        "predicted": the frame showed nothing, and the pose is new, from the prior alone.
        """
    @property
    def has_pose(self) -> bool:
        """Whether the pose is of this frame: false while lost and before the first usable frame."""
    @property
    def code(self) -> str:
        """The name of the status: "ok", or why there is no new measurement ("too_few_features", …)."""
    @property
    def message(self) -> str:
        """What happened and what to do, or empty."""
    @property
    def stamp_ns(self) -> int:
        """Stamp of the frame, ns."""
    @property
    def stamp(self) -> float:
        """Stamp of the frame, s, rounded to a float."""
    @property
    def reference_stamp_ns(self) -> int:
        """Stamp of the frame that this one was matched with, ns."""
    @property
    def T_world_camera(self) -> NDArray[float64]:
        """The pose, (4, 4): X_world = T_world_camera X_camera, m. A copy."""
    @property
    def T_camera_reference(self) -> NDArray[float64]:
        """The motion since the reference, (4, 4): X_camera = T_camera_reference X_reference, m. A copy."""
    @property
    def position(self) -> NDArray[float64]:
        """The position of the camera in the world, (3,), m. A view."""
    @property
    def quaternion(self) -> NDArray[float64]:
        """The orientation of the camera in the world, (4,): x y z w. A copy."""
    @property
    def covariance(self) -> NDArray[float64]:
        """Covariance of the pose, (6, 6): position (m), then orientation (rad), in the axes of the world. A view."""
    @property
    def motion_covariance(self) -> NDArray[float64]:
        """Covariance of `T_camera_reference`, (6, 6): translation (m), then rotation (rad), in the axes of the camera. A view."""
    @property
    def points(self) -> Counts:
        """Numbers of points."""
    @property
    def lines(self) -> Counts:
        """Numbers of line segments."""
    @property
    def ransac_iterations(self) -> int:
        """Iterations of RANSAC."""
    @property
    def lm_iterations(self) -> int:
        """Iterations of the Levenberg–Marquardt solver."""
    @property
    def mean_brightness(self) -> float:
        """Mean of the grey image, 0 to 255."""
    @property
    def relocalised(self) -> bool:
        """Whether the view of a keyframe from before a loss was recognised, which corrected the pose."""
    @property
    def repeated(self) -> bool:
        """Whether the colour image is that of the frame before. The pose is then predicted."""
    @property
    def world(self) -> int:
        """Number of the world of the pose, from 0. Poses in different worlds have no known relation. It rises with `reset`, and after a very long loss."""
    @property
    def restarted(self) -> bool:
        """Whether tracking goes on after a loss and the images did not observe the motion meanwhile. The covariance includes it."""
    @property
    def disagreement(self) -> float:
        """By how much points, lines and surfaces disagree about the motion: the factor by which `motion_covariance` is multiplied, 1 to 1000. Above 100 the message says so."""
    @property
    def feature_step(self) -> int:
        """How far the budget has lowered the number of features: 0, all that fit, to 8, a third of them."""

class Features(NamedTuple):
    """What the last frame was made of, in pixels of the undistorted image. Arrays are views until the next track."""

    image: NDArray[uint8]
    """The grey image without distortion, (height, width)."""
    keypoints: NDArray[float32]
    """(N, 2): u v, px. Empty where points were not searched."""
    segments: NDArray[float32]
    """(M, 4): u v of one end, u v of the other, px."""
    segment_has_3d: NDArray[bool_]
    """(M,): whether the segment has a 3D line."""
    reference_segments: NDArray[float32]
    """(R, 4): the segments of the reference, px."""
    point_tracks: NDArray[float32]
    """(P, 4): u v in the reference, u v in the frame, px."""
    point_inliers: NDArray[bool_]
    """(P,): whether the track agrees with the motion."""
    line_tracks: NDArray[uint16]
    """(L, 2): indices into reference_segments and segments."""
    line_inliers: NDArray[bool_]
    """(L,): whether the match agrees with the motion."""

class MotionPrior:
    """What other sensors measured of the motion since the frame before, and of gravity. A value.

    All vectors and covariances are in the axes of the camera now: x right, y down, z forward.

    Parameters
    ----------
    rotation : (array_like, array_like) or None
        R_now_before, (3, 3), and its covariance, (3, 3), rad².
    translation : (array_like, array_like) or None
        t_now_before, (3,), m, and its covariance, (3, 3), m². X_now = R_now_before X_before + t_now_before.
    gravity : (array_like, array_like) or None
        The direction of gravity, (3,), of any length, and the covariance of the unit vector, (3, 3), rad²: of the error that is
        independent from frame to frame.
    gravity_offset_sigma : float
        Standard deviation of the error of gravity that stays the same from frame to frame, rad; needs `gravity`.

    Raises
    ------
    ValueError
        An array has another shape.
    plvo.Error
        "invalid_argument": no rotation, a covariance that is not positive definite, or a number out of range.
    """

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
        """What wheels measured since the frame before.

        Parameters
        ----------
        steps : list of (float, array_like, array_like)
            Seconds, twist and covariance of each step, oldest first. A twist is vx vy vz wx wy wz of the robot's base, (6,), m/s and
            rad/s, with x forward and z up; its covariance is (6, 6). Wheels measure neither vz nor wx nor wy: give 0, with variances
            that say how much the robot bounces and tilts.
        T_base_camera : array_like
            The pose of the camera on the base, (4, 4), m.
        error_s : float
            For how long an error of a twist lasts, as of slip, s; 0: a step.

        Returns
        -------
        MotionPrior
            With a rotation and a translation.

        Raises
        ------
        ValueError
            A step or an array has another shape.
        plvo.Error
            "invalid_argument": no steps, no rotation, or a step of no time or of more than half a turn.
        """
    @property
    def R_now_before(self) -> NDArray[float64] | None:
        """The rotation, (3, 3), or None. A copy."""
    @property
    def rotation_covariance(self) -> NDArray[float64] | None:
        """Covariance of the rotation, (3, 3), rad², or None. A copy."""
    @property
    def t_now_before(self) -> NDArray[float64] | None:
        """The translation, (3,), m, or None. A copy."""
    @property
    def translation_covariance(self) -> NDArray[float64] | None:
        """Covariance of the translation, (3, 3), m², or None. A copy."""
    @property
    def down(self) -> NDArray[float64] | None:
        """The direction of gravity, (3,), or None. A copy."""
    @property
    def gravity_covariance(self) -> NDArray[float64] | None:
        """Covariance of the direction of gravity, (3, 3), rad², or None. A copy."""
    @property
    def gravity_offset_sigma(self) -> float:
        """Standard deviation of the constant error of gravity, rad; 0 without gravity."""

class Imu:
    """A gyro and an accelerometer: samples in, a prior for each frame out.

    Parameters
    ----------
    R_camera_imu : array_like or None
        Turns the axes of the sensor into those of the camera, (3, 3). None: they are the same.
    gyro_noise : float
        White noise of the gyro, rad/s/√Hz.
    gyro_offset_sigma : float
        Standard deviation of the gyro's offset at the start, per axis, rad/s. The offset is learnt.
    gyro_offset_walk : float
        Random walk of that offset, rad/s/√s.
    gyro_scale_sigma : float
        Standard deviation of the gyro's scale, a share of the rate.
    accelerometer_noise : float
        White noise of the accelerometer, m/s²/√Hz.
    accelerometer_offset_sigma : float
        Standard deviation of its offset, per axis, m/s².
    acceleration : float
        Standard deviation of the camera's own acceleration, per axis, m/s².
    acceleration_s : float
        How long such an acceleration lasts, s.
    longest_gap_s : float
        Time between samples beyond which there is no prior, s.

    Raises
    ------
    ValueError
        `R_camera_imu` has another shape.
    plvo.Error
        "invalid_argument": a number is out of range, or `R_camera_imu` is neither a rotation nor a reflection.
    """

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
    def add_gyro(self, stamp_ns: int, rate: _Array) -> bool:
        """Takes a sample of the gyro; samples may be ahead of the frames.

        Parameters
        ----------
        stamp_ns : int
            By the clock of the frames, ns.
        rate : array_like
            Angular rate in the axes of the sensor, (3,), rad/s.

        Returns
        -------
        bool
            False if the sample was refused: it is not later than the one before, or not finite.

        Raises
        ------
        ValueError
            `rate` has another shape.
        """
    def add_acceleration(self, stamp_ns: int, force: _Array) -> bool:
        """Takes a sample of the accelerometer; samples may be ahead of the frames.

        Parameters
        ----------
        stamp_ns : int
            By the clock of the frames, ns.
        force : array_like
            Specific force in the axes of the sensor, (3,), m/s²; 9.8 upwards at rest.

        Returns
        -------
        bool
            False if the sample was refused: it is not later than the one before, or not finite.

        Raises
        ------
        ValueError
            `force` has another shape.
        """
    def prior(self, stamp_ns: int) -> MotionPrior:
        """The prior of a frame, since the frame of the call before.

        Parameters
        ----------
        stamp_ns : int
            Stamp of the frame, ns.

        Returns
        -------
        MotionPrior
            Without rotation at the first call and where samples of the gyro are missing, without gravity where the accelerometer gave
            none.
        """
    def learn(self, result: Result) -> None:
        """Corrects the gyro's offset by what the odometry measured in the frame of the last prior.

        Parameters
        ----------
        result : Result
            Of that frame.
        """
    @property
    def gyro_offset(self) -> NDArray[float64]:
        """The gyro's offset as learnt so far, (3,), rad/s, in the axes of the sensor. A copy."""
    @property
    def gyro_offset_variance(self) -> NDArray[float64]:
        """The variance of the learnt offset, (3,), rad²/s². A copy."""

class RecordedImu:
    """What a gyro and an accelerometer recorded beside the images. Sequence.imu makes it."""

    def prior(self, stamp_ns: int) -> MotionPrior:
        """The prior of a frame, since the frame of the call before.

        Parameters
        ----------
        stamp_ns : int
            Stamp of the frame, ns. Frames come in their order.

        Returns
        -------
        MotionPrior
            As from Imu.prior.
        """
    def learn(self, result: Result) -> None:
        """Corrects the gyro's offset by what the odometry measured in the frame of the last prior.

        Parameters
        ----------
        result : Result
            Of that frame.
        """

class Odometry:
    """Frames in, poses out. One thread at a time may use it.

    Parameters
    ----------
    camera : Camera
        The camera of the images.
    config : Config or None
        None: Config().
    keypoints, segments, references, line_bands, kept_keyframes, surfaces : int or None
        Limits, which determine the memory: keypoints 10 to 60000, segments 1 to 60000, references 1 to 3, line_bands 1 to 8,
        kept_keyframes 0 to 4, surfaces 0 to 1000. None: as the preset.
    cores : int
        2: a second thread does half of the work. The bits are the same.
    mask : ndarray or None
        (height, width) of the camera's images, bool or uint8: 0 where a pixel must not be used, because it shows what travels with
        the camera. It is copied.

    Raises
    ------
    TypeError, ValueError
        `mask` has another type or shape.
    plvo.Error
        "invalid_argument": a limit is out of range or does not fit the config, or the mask has not the size of the camera's images.
    """

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
    ) -> Result:
        """Tracks the next frame. Other Python threads run meanwhile.

        Parameters
        ----------
        colour : ndarray
            (height, width) grey or (height, width, 3) RGB, uint8. The pixels of a row are contiguous. Not copied.
        depth : ndarray
            (height, width), uint16, in units of the camera; 0: none. Registered to colour. Not copied.
        stamp_ns : int
            Of colour, ns; later than that of the frame before.
        depth_stamp_ns : int or None
            Of depth, ns. None: that of colour.
        bgr : bool
            Colour is in OpenCV's order.
        prior : MotionPrior or None
            What other sensors measured.

        Returns
        -------
        Result
            Also of a frame that is lost.

        Raises
        ------
        TypeError
            An array has another type of numbers.
        ValueError
            An array has another number of dimensions, or the pixels of a row are not contiguous.
        plvo.Error
            "invalid_argument": the size is not the camera's, or the stamp is not later; the odometry is as before.
        RuntimeError
            Another thread is using it.
        """
    def frame_took(self, ns: int) -> None:
        """Says how long the last track took, for the budget of Config. The same times give the same bits.

        Parameters
        ----------
        ns : int
            The time by any clock, ns.
        """
    def reset(self) -> None:
        """Forgets everything: the next usable frame starts a new world."""
    def set_pose(self, T_world_camera: _Array, covariance: _Array | None = None) -> None:
        """Sets the pose of the last frame that has one, or, before the first frame, that of the first usable one.

        Parameters
        ----------
        T_world_camera : array_like
            The pose in a world of the caller's, (4, 4), m.
        covariance : array_like or None
            (6, 6): position (m), then orientation (rad), in the axes of that world. None: 0.

        Raises
        ------
        ValueError
            An array has another shape, or the last row of the pose is not 0 0 0 1.
        plvo.Error
            "invalid_argument": no rotation, no covariance, or a position beyond 1e8 m.
        """
    def features(self) -> Features:
        """Shows what the last frame was made of.

        Returns
        -------
        Features
            Views, which show the next frame after the next track.
        """
    @property
    def memory_bytes(self) -> int:
        """Size of the odometry's block of memory, bytes."""

class MapResult:
    """Where the camera is in a map, after a frame. A value."""

    @property
    def located(self) -> bool:
        """Whether the map knows where the camera is.

        False after Map.load, and in a new world of the odometry, until a place is recognised. T_map_world has no meaning until then.
        """
    @property
    def recognised(self) -> bool:
        """Whether a place was recognised in this frame."""
    @property
    def keyframe(self) -> int:
        """Number of the latest keyframe; 0: none yet."""
    @property
    def T_map_world(self) -> NDArray[float64]:
        """The world in the map, (4, 4), m. T_map_world @ result.T_world_camera is the camera in the map. A copy."""
    @property
    def covariance(self) -> NDArray[float64]:
        """Covariance of the camera's pose in the map, (6, 6): position (m), then orientation (rad), in the map's axes. A view."""
    @property
    def T_keyframe_camera(self) -> NDArray[float64]:
        """The camera relative to `keyframe`, (4, 4), m. A copy.

        With Map.keyframe_pose(keyframe) of a later time it gives the pose of this frame with the corrections that came since.
        """
    @property
    def removed(self) -> int:
        """Number of a keyframe that made room in this frame, or 0."""
    @property
    def removed_into(self) -> int:
        """Number of a keyframe that stays, to which the pose of the removed one is known; 0 if none was removed."""
    @property
    def T_into_removed(self) -> NDArray[float64]:
        """The removed keyframe relative to `removed_into`, (4, 4), m. A copy."""

class Map:
    """The places that the camera has seen. Corrects the drift where one comes back. One thread at a time may use it.

    Parameters
    ----------
    camera : Camera
        That of the odometry.
    config : Config or None
        That of the odometry.
    keyframes : int
        Capacity, 8 to 512.
    keypoints : int
        Of a keyframe, 50 to 400.
    segments : int
        Of a keyframe, 1 to 256.

    Raises
    ------
    plvo.Error
        "invalid_argument": a number is out of range; the message names it.
    """

    def __init__(
        self, camera: Camera, config: Config | None = None, *, keyframes: int = 256, keypoints: int = 200, segments: int = 64
    ) -> None: ...
    def update(self, odometry: Odometry, result: Result) -> MapResult:
        """Adds a frame. Call it right after each Odometry.track.

        Parameters
        ----------
        odometry : Odometry
            That tracked the frame.
        result : Result
            Of that frame.

        Returns
        -------
        MapResult
            Where the camera is in the map.
        """
    def settle(self) -> None:
        """Finishes all work that is pending. Call it at the end of a run."""
    def save(self, path: _Path) -> None:
        """Settles the map, then writes it. A file that was there stays until the new one is whole.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            The file.

        Raises
        ------
        plvo.Error
            "not_found": the map has no keyframe. "io": the file cannot be written.
        """
    def load(self, path: _Path) -> None:
        """Replaces the map by a saved one. The camera is not located until it sees a place of it.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            The file.

        Raises
        ------
        plvo.Error
            "not_found", "damaged", or "out_of_memory": the file has more than this map can hold. The map is then empty.
        """
    def keyframe_pose(self, keyframe: int) -> NDArray[float64] | None:
        """The pose of a keyframe as it is known now.

        Parameters
        ----------
        keyframe : int
            Its number.

        Returns
        -------
        ndarray or None
            (4, 4), m, keyframe to map. None if the keyframe was removed, or its place in the map is not known.
        """
    @property
    def keyframes(self) -> int:
        """Number of keyframes in the map."""
    @property
    def loops(self) -> int:
        """Number of pairs of keyframes that are joined as the same place."""
    @property
    def memory_bytes(self) -> int:
        """Size of the map's block of memory, bytes."""

class Frame(NamedTuple):
    """A frame of a Sequence. Its images are views until the next frame."""

    colour: NDArray[uint8]
    """(height, width, 3), RGB."""
    depth: NDArray[uint16]
    """(height, width), in units of the camera; 0: none."""
    stamp_ns: int
    """Stamp of colour, ns."""
    depth_stamp_ns: int
    """Stamp of depth, ns."""

class Sequence:
    """A recorded folder or recording of ROS, frame by frame, once. One thread at a time may use it.

    A calibration that leaves something unsaid, damaged images and data that look wrong are RuntimeWarnings. At the end of a `with`
    block it gives no further frames; those that it gave stay.

    Parameters
    ----------
    recording : str, bytes or os.PathLike
        A folder, or a file of ROS (.bag, .mcap, .db3).
    camera : Camera, str, bytes, os.PathLike or None
        A camera, the name of one, or a calibration file. None: that of the recording.
    topics : dict or None
        For a recording of ROS with several topics that could be meant: the topics of "colour", "depth", "camera_info", "gyro" and
        "accelerometer".

    Raises
    ------
    ValueError
        `topics` has another key, or the recording is a folder of images.
    plvo.Error
        "not_found", "damaged", … : the recording or the calibration cannot be read; the message says why.
    """

    def __init__(
        self, recording: _Path, camera: Camera | _Path | None = None, *, topics: dict[_Topic, str] | None = None
    ) -> None: ...
    @property
    def camera(self) -> Camera:
        """The camera of the images."""
    def imu(self, *, R_camera_imu: _Array | None = None) -> RecordedImu:
        """Reads the gyro and the accelerometer.

        They come from gyroscope.txt and accelerometer.txt of the folder, or from sensor_msgs/Imu of the recording of ROS.

        Parameters
        ----------
        R_camera_imu : array_like or None
            Turns the axes of the sensor into those of the camera, (3, 3). None: they are the same.

        Returns
        -------
        RecordedImu
            The samples.

        Raises
        ------
        plvo.Error
            "not_found": the recording has none.
        """
    def __len__(self) -> int: ...
    def __enter__(self) -> Sequence: ...
    def __exit__(self, *args: object) -> None: ...
    def __iter__(self) -> Iterator[Frame]: ...
    def __next__(self) -> Frame: ...

class Trajectory:
    """The poses of results, lost frames left out. A value; two are equal where all their numbers are.

    Parameters
    ----------
    results : iterable of Result
        In the order of their stamps.

    Raises
    ------
    TypeError
        One is no Result.
    """

    def __init__(self, results: Iterable[Result]) -> None: ...
    @property
    def stamps_ns(self) -> NDArray[int64]:
        """Stamps, (N,), ns."""
    @property
    def positions(self) -> NDArray[float64]:
        """Positions of the camera in the world, (N, 3), m."""
    @property
    def quaternions(self) -> NDArray[float64]:
        """Orientations of the camera in the world, (N, 4): x y z w."""
    def __len__(self) -> int: ...
    def save(self, path: str | PathLike[str]) -> None:
        """Writes the format of the TUM benchmark, as `plvo run --out`: stamp tx ty tz qx qy qz qw, a pose a line.

        Parameters
        ----------
        path : str or os.PathLike
            The file.

        Raises
        ------
        OSError
            The file cannot be written.
        """

def to_dataframe(results: Iterable[Result]) -> Any:
    """A table with a row for each result, lost ones too.

    Parameters
    ----------
    results : iterable of Result
        In any order.

    Returns
    -------
    pandas.DataFrame
        Columns: stamp_ns, state, message; the pose tx ty tz (m) qx qy qz qw and the standard deviations sigma_x sigma_y sigma_z (m)
        sigma_rx sigma_ry sigma_rz (rad), NaN without a pose; points_… and lines_… detected, with_depth, matched and inliers.

    Raises
    ------
    ImportError
        There is no pandas, which plvo itself does not need.
    TypeError
        One is no Result.
    """

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
) -> Iterator[Result]:
    """Tracks a recorded folder or recording of ROS.

    Parameters
    ----------
    recording : str, bytes or os.PathLike
        See Sequence.
    camera : Camera, str, bytes, os.PathLike or None
        See Sequence.
    config : Config or None
        None: Config(). Its budget is held against the processor time of this thread; results then depend on the machine.
    imu : bool
        Uses the gyro and the accelerometer of the recording.
    R_camera_imu : array_like or None
        See Sequence.imu.
    cores : int
        See Odometry.
    topics : dict or None
        See Sequence.
    mask : ndarray or None
        See Odometry.

    Returns
    -------
    iterator of Result
        One for each frame, lost ones too.

    Raises
    ------
    plvo.Error
        Those of Sequence and Odometry, at the call. An error while reading comes from the iterator.
    """

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
) -> dict[str, Any]:
    """Errors of an estimate against the true poses.

    Parameters
    ----------
    truth : str, bytes or os.PathLike
        A file of poses, or a recording that has them: a folder with groundtruth.txt, or a recording of ROS with
        NAME-groundtruth.txt beside it or a topic of poses.
    estimate : str, bytes, os.PathLike or iterable of Result
        A file of poses, or results. Only results have covariances, and so NEES.
    sampling : {"interpolated", "nearest"}
        The true pose at a stamp: interpolated between two, or the nearest one.
    max_difference_s : float
        Largest time between a stamp and the true poses that are used for it, s.
    offset_s : float
        Added to the stamps of the estimate, s.
    rpe_deltas : iterable of str
        The lengths over which relative errors are computed, in frames, seconds or metres: "1f", "0.5s", "2m".
    truth_sigma : (float, float)
        Standard deviation of a true pose along each axis, m and rad. The NEES adds it to the covariances.
    fit_truth : bool
        Rotates the truth and shifts its clock so that it fits the estimate best, before it compares them.

    Returns
    -------
    dict
        What `plvo eval --json` writes.

    Raises
    ------
    TypeError
        The estimate is neither a file nor results.
    ValueError
        An option is out of range, or the stamps of the results do not increase.
    plvo.Error
        A file cannot be read, or too few stamps agree.
    """

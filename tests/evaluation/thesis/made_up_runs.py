"""Made-up drives and maps of a square room, in which every measure can be told by hand."""

import numpy as np
from numpy.typing import NDArray

from envs.floor_plan import Cylinder, FloorPlan, Wall
from evaluation.episode import EpisodeConfig
from evaluation.thesis.drive import Drive
from evaluation.thesis.map_run import MapRun, MapSpec
from evaluation.thesis.timings import BEGIN, END
from mapping.geometry import Pose, compose
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile
from mapping.messages import LaserScan, Odometry, Twist
from mapping.sensor_log import SensorLog
from mapping.trajectory import Trajectory

SIDE = 2.0
"""The room is a square of this side [m], one corner at the origin."""

PLAN = FloorPlan(
    name="square",
    start=(1.0, 1.0, 0.0),
    walls=(
        Wall(
            points=((-0.05, -0.05), (2.05, -0.05), (2.05, 2.05), (-0.05, 2.05)),
            closed=True,
            thickness=0.1,
        ),
    ),
    cylinders=(Cylinder(center=(0.28, 0.26), radius=0.15),),
)


def drive_through(poses: Pose, period: float = 0.2) -> Drive:
    """A drive whose scans see the walls and the can without error."""
    stamps = np.arange(len(poses)) * period
    return Drive(
        config=EpisodeConfig(world="square"),
        plan=PLAN,
        log=SensorLog(
            source="square",
            scans=tuple(
                LaserScan(stamp=stamp, ranges=_ranges(pose), time_increment=0.0)
                for stamp, pose in zip(stamps.tolist(), poses, strict=True)
            ),
            odometry=tuple(
                Odometry(stamp=stamp, pose_odom=pose, twist=Twist())
                for stamp, pose in zip(stamps.tolist(), poses, strict=True)
            ),
        ),
        ground_truth=Trajectory(stamps=stamps, poses=poses),
        stop_reason="complete",
        contacts=0,
    )


def map_of(
    drive: Drive, occupied: NDArray[np.float64], error: tuple[float, float, float] = (0, 0, 0)
) -> MapRun:
    """A map, 1 cm a cell from (-1, -1) to (3, 3), with occupied cells at points ``(n, 2)`` [m].

    All else inside the room is free. The mapper's poses are off by one motion of the whole world.
    """
    states = np.full((400, 400), UNKNOWN, dtype=np.int8)
    states[100:300, 100:300] = FREE
    columns, rows = np.floor((occupied + 1.0) / 0.01 + 1e-9).astype(int).T
    states[rows, columns] = OCCUPIED
    truth = drive.ground_truth
    return MapRun(
        spec=MapSpec(drive="room", until="end", mapper="occgridmapp"),
        map=MapFile(resolution=0.01, origin=(-1.0, -1.0), states=states),
        trajectory=Trajectory(stamps=truth.stamps, poses=compose(np.array(error), truth.poses)),
        update_stamps=truth.stamps,
        update_seconds=np.full(len(truth.stamps), 0.001),
        result={},
    )


def wall_points(first: float = 0.0, last: float = SIDE) -> NDArray[np.float64]:
    """The outermost centimetre of the room's four walls ``(n, 2)``, of each from first to last."""
    along = np.arange(first + 0.005, last, 0.01)
    low, high = np.full_like(along, -0.005), np.full_like(along, SIDE + 0.005)
    walls = ((along, low), (along, high), (low, along), (high, along))
    return np.concatenate([np.column_stack(pair) for pair in walls])


def can_points() -> NDArray[np.float64]:
    """The trash can's side ``(n, 2)``."""
    angles = np.deg2rad(np.arange(0.0, 360.0, 2.0))
    can = PLAN.cylinders[0]
    return np.asarray(can.radius * np.column_stack((np.cos(angles), np.sin(angles))) + can.center)


def room_points() -> NDArray[np.float64]:
    """Everything that stands in the room, drawn whole."""
    return np.concatenate((wall_points(), can_points()))


def _ranges(pose: Pose) -> NDArray[np.float32]:
    """What 360 beams from a pose see of the square and of the can in it."""
    angles = pose[2] + np.deg2rad(np.arange(360.0))
    rays = np.column_stack((np.cos(angles), np.sin(angles)))
    with np.errstate(divide="ignore", invalid="ignore"):
        steps = (np.where(rays > 0.0, SIDE, 0.0) - pose[:2]) / rays
    steps[~np.isfinite(steps)] = np.inf
    can = PLAN.cylinders[0]
    ahead = rays @ (np.asarray(can.center) - pose[:2])
    aside = np.hypot(*(np.asarray(can.center) - pose[:2])) ** 2 - ahead**2
    hits = (aside < can.radius**2) & (ahead > 0.0)
    to_can = np.where(hits, ahead - np.sqrt(np.maximum(can.radius**2 - aside, 0.0)), np.inf)
    nearest = np.minimum(steps.min(axis=1), to_can)
    return np.asarray(np.clip(nearest, 0.13, None), dtype=np.float32)


def without_timings(page: str) -> str:
    """A page without the part that differs between two runs of the same seed."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return before + after

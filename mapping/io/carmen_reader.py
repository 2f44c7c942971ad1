"""Turns CARMEN logs into sensor logs.

Comments, blank lines and kinds of lines that no mapper needs are skipped. So is a last line that
was cut off, as happens when a logger is killed. A broken line anywhere else is an error: a log with
a hole in its middle would bend the map without a word.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import between, wrap_to_pi
from mapping.io.carmen import (
    FLASER,
    IMU,
    MAX_RANGE_PARAM,
    ODOM,
    OTHER_FOV_DEG,
    PARAM,
    PARAMS,
    POSE_PARAMS,
    RANGE_MIN_PARAM,
    ROBOTLASER1,
    SCAN_TIME_PARAM,
    SICK_FOV_DEG,
    SICK_NO_RETURN,
    SICK_TYPES,
    TIME_INCREMENT_PARAM,
)
from mapping.io.carmen_clock import Stamps, clock_of
from mapping.io.laser_codes import smallest_code
from mapping.io.range_limits import without_codes
from mapping.messages import Imu, LaserScan, Odometry, Twist
from mapping.odometry_from_poses import odometry_from_poses
from mapping.sensor_log import SensorLog

IMU_WORDS = 17
"""Words of an IMU line; robots have written others under this name, which are skipped."""

POSE_DECIMALS = 6
"""Decimals of poses in CARMEN logs (CARMEN, writelog.c): differences of two are good to as many."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _LaserLine:
    """What a FLASER or ROBOTLASER1 line says."""

    stamps: Stamps
    ranges: NDArray[np.float32]
    angle_min: float
    angle_increment: float
    range_max: float
    settings: tuple[float, float, float]
    """Time increment, scan time, range_min, as the PARAM lines before it have them."""
    laser_pose: list[float]
    robot_pose: list[float]


def read_carmen(path: str | Path) -> SensorLog:
    """Read a CARMEN log.

    Scans come from ``FLASER`` and ``ROBOTLASER1`` lines. A reading at or beyond the laser's maximum
    means that nothing was there and becomes ``+inf``; a FLASER line does not tell the maximum, so
    it is ``PARAM robot_front_laser_max``, but at most 81 m, above which a SICK sends codes. Lasers
    whose codes begin below (``laser_codes``) are found out by the readings themselves.

    Odometry comes from ``ODOM`` lines, or, when those are fewer than the scans, from the robot
    poses in the scans' own lines, with velocities from their differences. The lidar's pose comes
    from ``PARAM robot_frontlaser_offset`` and its kin, else from the first scan's two poses.

    Stamps are those of the sensors (``ipc_timestamp``), or the logger's where a log has no others
    or the sensors' clock stood still or was set back.

    Raises:
        TestbedError: The file cannot be read, holds no scan and no odometry, or has a broken line
            that is not its last.
    """
    path = Path(path)
    log = _Lines()
    broken = ""
    for number, line in _numbered_lines(path):
        if broken:
            raise TestbedError(broken)
        words = line.split()
        try:
            log.take(words)
        except (ValueError, IndexError):
            broken = f"{path}: line {number}: {_short(line)}; must be a whole {words[0]} line"
    if not (log.lasers or log.odometry):
        raise TestbedError(
            f"{path}: no {FLASER}, {ROBOTLASER1} or {ODOM} line; must be a CARMEN log"
        )
    return log.sensor_log(str(path))


class _Lines:
    """The lines of a log so far."""

    def __init__(self) -> None:
        self.lasers: list[_LaserLine] = []
        self.odometry: list[tuple[Stamps, list[float]]] = []
        self.imu: list[tuple[Stamps, list[float]]] = []
        self.params: dict[str, float] = {}

    def take(self, words: Sequence[str]) -> None:
        """Take a line's words; raises ValueError or IndexError when the line is not whole."""
        if words[0] == FLASER:
            self.lasers.append(self._flaser(words))
        elif words[0] == ROBOTLASER1:
            self.lasers.append(self._robotlaser(words))
        elif words[0] == ODOM:
            self.odometry.append((_stamps(words, 7), _numbers(words, 1, 6)))
        elif words[0] == IMU and len(words) == IMU_WORDS:
            self.imu.append((_stamps(words, 14), _numbers(words, 1, 13)))
        elif words[0] == PARAM and words[1] in PARAMS:
            self.params[words[1]] = float(words[2])

    def sensor_log(self, source: str) -> SensorLog:
        """The messages of all lines."""
        lasers = _with_codes_known(self.lasers)
        clock = clock_of([line.stamps for line in lasers] or [each for each, _ in self.odometry])
        if len(self.odometry) < len(self.lasers):
            odometry = _odometry_of_lasers(lasers, clock)
        else:
            odometry = [_odometry(stamps[clock], row) for stamps, row in self.odometry]
        return SensorLog(
            source=source,
            scans=[_scan(line, line.stamps[clock]) for line in lasers],
            odometry=odometry,
            imu=[_imu(stamps[clock], row) for stamps, row in self.imu],
            lidar_pose_base=self._lidar_pose(),
        )

    def _flaser(self, words: Sequence[str]) -> _LaserLine:
        """``FLASER n ranges... laser x y theta, robot x y theta, times``."""
        ranges, after = _readings(words, 1)
        evenly = OTHER_FOV_DEG, OTHER_FOV_DEG / max(len(ranges) - 1, 1)
        fov_deg, step_deg = SICK_FOV_DEG.get(len(ranges), evenly)
        geometry = -0.5 * math.radians(fov_deg), math.radians(step_deg)
        max_range = min(self.params.get(MAX_RANGE_PARAM, SICK_NO_RETURN), SICK_NO_RETURN)
        return self._laser(words, after, after + 6, ranges, (*geometry, max_range))

    def _robotlaser(self, words: Sequence[str]) -> _LaserLine:
        """``ROBOTLASER1 seven settings, ranges, remissions, two poses, five figures, times``."""
        start, fov, step, max_range = _numbers(words, 2, 4)
        ranges, after = _readings(words, 8)
        _, after = _readings(words, after)
        if not all(map(math.isfinite, (start, fov, step))):
            raise ValueError
        if step == 0.0:
            step = fov / max(len(ranges) - 1, 1)
        if words[1] in SICK_TYPES or not max_range > 0.0:
            max_range = min(max_range, SICK_NO_RETURN) if max_range > 0.0 else SICK_NO_RETURN
        return self._laser(words, after, after + 11, ranges, (start, step, max_range))

    def _laser(
        self,
        words: Sequence[str],
        poses: int,
        stamps: int,
        ranges: NDArray[np.float64],
        geometry: tuple[float, float, float],
    ) -> _LaserLine:
        """A laser line whose poses and stamps begin at these words."""
        angle_min, angle_increment, range_max = geometry
        return _LaserLine(
            stamps=_stamps(words, stamps),
            ranges=without_codes(ranges.astype(np.float32), range_max),
            angle_min=angle_min,
            angle_increment=angle_increment,
            range_max=range_max,
            settings=(
                self.params.get(TIME_INCREMENT_PARAM, 0.0),
                self.params.get(SCAN_TIME_PARAM, 0.0),
                self.params.get(RANGE_MIN_PARAM, 0.0),
            ),
            laser_pose=_numbers(words, poses, 3),
            robot_pose=_numbers(words, poses + 3, 3),
        )

    def _lidar_pose(self) -> tuple[float, float, float]:
        """The lidar's pose on the robot, from PARAM lines or from the first scan's two poses."""
        if POSE_PARAMS[0] in self.params or not self.lasers:
            x, y, yaw = (self.params.get(name, 0.0) for name in POSE_PARAMS)
            return x, y, yaw
        first = self.lasers[0]
        if not np.all(np.isfinite([first.robot_pose, first.laser_pose])):
            return 0.0, 0.0, 0.0
        x, y, yaw = np.round(between(first.robot_pose, first.laser_pose), POSE_DECIMALS).tolist()
        return x, y, yaw


def _numbered_lines(path: Path) -> Iterator[tuple[int, str]]:
    """The lines that are neither blank nor comments, with their numbers from 1."""
    try:
        with path.open(encoding="utf-8-sig", errors="replace") as file:
            for number, line in enumerate(file, start=1):
                if line.strip() and not line.lstrip().startswith("#"):
                    yield number, line
    except OSError as error:
        raise TestbedError(
            f"{path}: cannot be read ({error.strerror}); must be a CARMEN log"
        ) from error


def _short(line: str) -> str:
    """A line, short enough to be told."""
    text = " ".join(line.split())
    return repr(text if len(text) <= 60 else f"{text[:57]}...")


def _numbers(words: Sequence[str], first: int, count: int) -> list[float]:
    """``count`` numbers from word ``first`` on."""
    numbers = [float(word) for word in words[first : first + count]]
    if len(numbers) < count:
        raise IndexError
    return numbers


def _stamps(words: Sequence[str], first: int) -> Stamps:
    """The sensor's and the logger's time, with the host's name between them.

    Without the name the line may have been cut in the middle of the first. A cut in the second
    does no harm: then it is the first.
    """
    sensor, _ = float(words[first]), words[first + 1]
    return sensor, float(words[first + 2]) if len(words) > first + 2 else sensor


def _readings(words: Sequence[str], first: int) -> tuple[NDArray[np.float64], int]:
    """Readings ``(n,)`` whose number stands at word ``first``, and the word after them."""
    count = int(words[first])
    readings = np.array(words[first + 1 : first + 1 + count], dtype=np.float64)
    if count < 0 or len(readings) < count:
        raise IndexError
    return readings, first + 1 + count


def _with_codes_known(lines: Sequence[_LaserLine]) -> list[_LaserLine]:
    """The lines, with codes below the maximum that was taken for a SICK's made ``+inf``."""
    unsure = [line.ranges for line in lines if line.range_max == SICK_NO_RETURN]
    code = smallest_code(unsure)
    return [
        replace(line, ranges=without_codes(line.ranges, code), range_max=code)
        if line.range_max == SICK_NO_RETURN and code < SICK_NO_RETURN
        else line
        for line in lines
    ]


def _scan(line: _LaserLine, stamp: float) -> LaserScan:
    """A laser line as a message."""
    time_increment, scan_time, range_min = line.settings
    return LaserScan(
        stamp=stamp,
        ranges=line.ranges,
        angle_min=line.angle_min,
        angle_increment=line.angle_increment,
        time_increment=time_increment,
        scan_time=scan_time,
        range_min=range_min,
        range_max=line.range_max,
    )


def _odometry(stamp: float, row: list[float]) -> Odometry:
    """An ODOM line as a message."""
    x, y, yaw, linear, angular, _ = row
    twist = Twist(linear_x=linear, angular_z=angular)
    return Odometry(stamp=stamp, pose_odom=np.array([x, y, _wrapped(yaw)]), twist=twist)


def _imu(stamp: float, row: list[float]) -> Imu:
    """An IMU line as a message; the magnetometer is left out."""
    w, x, y, z = row[3:7]
    return Imu(
        stamp=stamp,
        orientation=np.array([x, y, z, w]),
        angular_velocity=np.array(row[10:13]),
        linear_acceleration=np.array(row[0:3]),
    )


def _odometry_of_lasers(lines: Sequence[_LaserLine], clock: int) -> list[Odometry]:
    """The robot poses of laser lines."""
    stamps = np.array([line.stamps[clock] for line in lines])
    return odometry_from_poses(stamps, np.array([line.robot_pose for line in lines]).reshape(-1, 3))


def _wrapped(yaw: float) -> float:
    """The same angle in (-pi, pi], unchanged to the last digit if it lay there."""
    return yaw if -math.pi < yaw <= math.pi else float(wrap_to_pi(yaw))

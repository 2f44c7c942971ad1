"""Sensor logs to write and read back."""

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mapping.geometry import wrap_to_pi
from mapping.messages import Imu, LaserScan, Odometry, Twist
from mapping.sensor_log import SensorLog

STAMPS = st.floats(0.0, 2e9).map(lambda stamp: round(stamp, 9))
NUMBERS = st.floats(-1e3, 1e3)
YAWS = st.floats(-np.pi, np.pi, exclude_min=True)


@st.composite
def scans(draw: st.DrawFn) -> LaserScan:
    """A scan in which hits, beams without return and every kind of failed beam are mixed."""
    beams = draw(st.integers(0, 400))
    range_max = draw(st.sampled_from([3.5, 3.3, 30.0, 81.83]))
    seed = np.random.default_rng(draw(st.integers(0, 2**32)))
    ranges = seed.uniform(0.05, range_max, beams).astype(np.float32)
    special = np.array([np.inf, 0.0, np.nan, -np.inf, -1.0, range_max], dtype=np.float32)
    chosen = seed.random(beams) < 0.3
    ranges[chosen] = seed.choice(special, chosen.sum())
    return LaserScan(
        stamp=draw(STAMPS),
        ranges=ranges,
        angle_min=draw(st.floats(-np.pi, np.pi)),
        angle_increment=draw(st.sampled_from([np.pi / 180.0, np.pi / 360.0, -np.pi / 180.0])),
        time_increment=draw(st.sampled_from([0.0, 1.0 / 1800.0])),
        scan_time=draw(st.sampled_from([0.0, 0.2])),
        range_min=draw(st.sampled_from([0.0, 0.12])),
        range_max=range_max,
    )


@st.composite
def odometry(draw: st.DrawFn) -> Odometry:
    return Odometry(
        stamp=draw(STAMPS),
        pose_odom=np.array([draw(NUMBERS), draw(NUMBERS), draw(YAWS)]),
        twist=Twist(linear_x=draw(NUMBERS), angular_z=draw(NUMBERS)),
    )


@st.composite
def imu(draw: st.DrawFn) -> Imu:
    numbers = draw(arrays(np.float64, 10, elements=NUMBERS))
    return Imu(
        stamp=draw(STAMPS),
        orientation=numbers[:4],
        angular_velocity=numbers[4:7],
        linear_acceleration=numbers[7:],
    )


@st.composite
def logs(draw: st.DrawFn) -> SensorLog:
    """A log with at least as many odometry messages as scans, in any order of time."""
    drawn = draw(st.lists(scans(), min_size=1, max_size=3))
    return SensorLog(
        source="drawn",
        scans=drawn,
        odometry=draw(st.lists(odometry(), min_size=len(drawn), max_size=6)),
        imu=draw(st.lists(imu(), max_size=3)),
        lidar_pose_base=(draw(NUMBERS), draw(NUMBERS), draw(YAWS)),
    )


def meanings(scan: LaserScan) -> tuple[np.ndarray, np.ndarray]:
    """Which beams met nothing, and the hits' ranges with 0 for every other beam."""
    ranges = np.asarray(scan.ranges, dtype=np.float64)
    nothing = ranges == np.inf
    return nothing, np.where(np.isfinite(ranges) & (ranges > 0.0), ranges, 0.0)


def driven_log(seconds: float = 2.0, start: float = 0.0) -> SensorLog:
    """A log as an LDS-01 robot makes it: 5 Hz rolling scans, 30 Hz odometry, 100 Hz IMU."""
    rng = np.random.default_rng(5)
    stamps = [start + i / 30.0 for i in range(round(30 * seconds))]
    drawn = []
    for i in range(round(5 * seconds)):
        ranges = rng.uniform(0.2, 3.4, 360).round(3).astype(np.float32)
        ranges[::7], ranges[::11] = np.inf, 0.0
        drawn.append(LaserScan(stamp=start + 0.2 * i, ranges=ranges))
    return SensorLog(
        source="driven",
        scans=drawn,
        odometry=[
            Odometry(
                stamp=stamp,
                pose_odom=np.array([0.2 * i, 0.01 * i, float(wrap_to_pi(0.1 * i))]),
                twist=Twist(linear_x=0.2, angular_z=0.1),
            )
            for i, stamp in enumerate(stamps)
        ],
        imu=[
            Imu(
                stamp=start + i / 100.0,
                orientation=np.array([0.0, 0.0, 0.6, 0.8]),
                angular_velocity=rng.normal(size=3),
                linear_acceleration=rng.normal(size=3),
            )
            for i in range(round(100 * seconds))
        ],
        lidar_pose_base=(-0.032, 0.0, 0.0),
    )

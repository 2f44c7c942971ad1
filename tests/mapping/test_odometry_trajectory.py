import numpy as np

from mapping.deskew import REACH_S, OdometryTrack
from mapping.messages import LaserScan, Odometry, Twist
from mapping.odometry_trajectory import odometry_at_scans, odometry_trajectory


def odometry(stamp: float, x: float = 0.0, speed: float = 0.0) -> Odometry:
    twist = Twist(linear_x=speed)
    return Odometry(stamp=stamp, pose_odom=np.array([x, 0.0, 0.0]), twist=twist)


def scans(*stamps: float) -> list[LaserScan]:
    return [LaserScan(stamp=stamp, ranges=np.ones(1, dtype=np.float32)) for stamp in stamps]


def test_a_message_that_is_broken_or_late_is_left_out() -> None:
    messages = [odometry(1.0, 1.0), odometry(0.5, 9.0), odometry(1.0, 9.0), odometry(np.nan, 9.0)]
    messages += [odometry(2.0, np.inf), odometry(3.0, 3.0)]
    trajectory = odometry_trajectory(messages)
    assert trajectory.stamps.tolist() == [1.0, 3.0]
    assert trajectory.poses[:, 0].tolist() == [1.0, 3.0]


def test_scans_get_the_poses_that_deskewing_gives_them() -> None:
    rng = np.random.default_rng(0)
    messages = [odometry(k / 30, x, 0.3) for k, x in enumerate(rng.normal(0.0, 1.0, 12))]
    stamps = [-0.1, 0.0, 0.111, 0.3, 11 / 30, 0.5]
    track = OdometryTrack()
    track.add(messages)
    told = odometry_at_scans(scans(*stamps), messages)
    assert told.stamps.tolist() == stamps
    assert np.array_equal(told.poses, track.poses_at(stamps))


def test_a_scan_far_from_odometry_or_back_in_time_is_left_out() -> None:
    messages = [odometry(0.0), odometry(1.0)]
    late = 1.0 + REACH_S + 0.01
    told = odometry_at_scans(scans(-1.0, 0.2, 0.1, 0.2, np.nan, 0.5, late), messages)
    assert told.stamps.tolist() == [0.2, 0.5]


def test_without_odometry_or_scans_there_is_nothing() -> None:
    assert len(odometry_at_scans(scans(0.0), []).stamps) == 0
    assert len(odometry_at_scans([], [odometry(0.0)]).stamps) == 0
    assert len(odometry_trajectory([]).stamps) == 0

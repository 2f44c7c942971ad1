import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.deskew import REACH_S, OdometryTrack
from mapping.geometry import wrap_to_pi
from mapping.messages import Odometry, Twist


def message(
    stamp: float, x: float, y: float, yaw: float, v: float = 0.0, w: float = 0.0
) -> Odometry:
    return Odometry(
        stamp=stamp, pose_odom=np.array([x, y, yaw]), twist=Twist(linear_x=v, angular_z=w)
    )


def arc(stamp: float, v: float, w: float) -> tuple[float, float, float]:
    """The pose after driving a constant twist from the origin, by the closed form."""
    yaw = w * stamp
    if w == 0.0:
        return v * stamp, 0.0, 0.0
    return v / w * np.sin(yaw), v / w * (1.0 - np.cos(yaw)), float(wrap_to_pi(yaw))


@given(
    v=st.floats(-0.22, 0.22),
    w=st.floats(-2.84, 2.84).filter(lambda w: w == 0.0 or abs(w) > 1e-3),
    stamp=st.floats(0.6, 1.2),
)
@settings(max_examples=60, deadline=None)
def test_poses_between_and_after_messages_lie_on_the_arc(v: float, w: float, stamp: float) -> None:
    track = OdometryTrack()
    track.add([message(k / 30.0, *arc(k / 30.0, v, w), v, w) for k in range(31)])
    poses = track.poses_at([stamp])
    assert poses is not None
    # a chord of 1/30 s and a midpoint step of 0.2 s differ from the arc by less than 1 mm
    assert poses[0, :2] == pytest.approx(arc(stamp, v, w)[:2], abs=1e-3)
    assert float(wrap_to_pi(poses[0, 2] - arc(stamp, v, w)[2])) == pytest.approx(0.0, abs=1e-9)


def test_yaw_goes_the_short_way_over_pi() -> None:
    track = OdometryTrack()
    track.add([message(0.0, 0, 0, 3.0), message(0.5, 0, 0, -3.0)])
    poses = track.poses_at([0.25])
    assert poses is not None
    assert abs(poses[0, 2]) == pytest.approx(np.pi)


def test_poses_before_the_first_message_are_driven_backwards() -> None:
    track = OdometryTrack()
    track.add([message(1.0, 0.0, 0.0, 0.0, v=0.2)])
    poses = track.poses_at([0.9])
    assert poses is not None
    assert poses[0] == pytest.approx([-0.02, 0.0, 0.0])


def test_there_is_no_pose_far_from_any_message() -> None:
    track = OdometryTrack()
    assert track.poses_at([0.0]) is None
    track.add([message(1.0, 0.0, 0.0, 0.0)])
    assert track.poses_at([1.0 + 1.1 * REACH_S]) is None
    assert track.poses_at([1.0 - 1.1 * REACH_S]) is None
    assert track.poses_at([np.nan]) is None


def test_messages_that_are_broken_or_late_are_ignored() -> None:
    track = OdometryTrack()
    track.add([message(1.0, 1.0, 0.0, 0.0), message(2.0, np.nan, 0.0, 0.0)])
    track.add([message(0.5, 9.0, 0.0, 0.0), message(1.0, 9.0, 0.0, 0.0)])
    track.add([message(3.0, 9.0, 0.0, 0.0, v=np.inf)])
    assert track.newest is not None
    assert track.newest.tolist() == [1.0, 0.0, 0.0]


def test_a_scan_between_messages_seconds_apart_has_its_pose() -> None:
    track = OdometryTrack()
    for k in range(10):
        track.add([message(3.0 * k, 1.5 * k, 0.0, 0.0)])
    poses = track.poses_at([24.0, 26.0, 27.0])
    assert poses is not None
    assert poses[:, 0] == pytest.approx([12.0, 13.0, 13.5])
    assert track.poses_at([0.0]) is None  # nobody asks for it any more: memory stays bounded

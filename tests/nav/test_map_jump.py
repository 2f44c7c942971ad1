import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.geometry import Pose, compose, inverse, transform_points
from mapping.messages import LaserScan, Twist
from nav.map_jump import MapJump, shift_at
from nav.scan_points import ScanPoints
from tests.nav.grids import grid_from_text

PERIOD = 0.1
frames = st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-0.5, 0.5))


def arc(pose: Pose, twist: Twist, period: float = PERIOD) -> Pose:
    turn = twist.angular_z * period
    way = twist.linear_x * period
    return compose(pose, (way * np.cos(turn / 2), way * np.sin(turn / 2), turn))


@given(frame=frames, v=st.floats(-0.2, 0.2), w=st.floats(-1.5, 1.5))
def test_on_a_steady_drive_the_jump_is_the_frame_s_own(
    frame: tuple[float, float, float], v: float, w: float
) -> None:
    grid, jumps, twist = grid_from_text("."), MapJump(), Twist(linear_x=v, angular_z=w)
    pose = np.array([1.0, 2.0, 0.3])
    for _ in range(3):
        pose = arc(pose, twist)
        assert jumps.update(grid, pose, twist, PERIOD) is None
    grid.redraws += 1
    after = compose(frame, arc(pose, twist))
    jump = jumps.update(grid, after, twist, PERIOD)
    assert jump is not None
    # an arc of 2 cm and its chord, and a place 2 m from the frame's origin: within 3 mm
    assert compose(jump, (1.0, 2.0, 0.0)) == pytest.approx(
        compose(frame, (1.0, 2.0, 0.0)), abs=3e-3
    )
    assert jumps.update(grid, arc(after, twist), twist, PERIOD) is None


def test_the_first_map_is_no_jump_however_often_it_was_drawn() -> None:
    grid = grid_from_text(".")
    grid.redraws = 7
    assert MapJump().update(grid, np.zeros(3), Twist(), PERIOD) is None


def test_a_place_shifts_by_how_far_it_moves() -> None:
    assert shift_at(np.array([0.3, 0.4, 0.0]), np.array([9.0, 9.0, 1.0])) == pytest.approx(0.5)
    quarter = np.array([0.0, 0.0, np.pi / 2])
    assert shift_at(quarter, np.array([1.0, 0.0, 2.0])) == pytest.approx(np.sqrt(2.0))


@given(frame=frames)
def test_returns_follow_the_jump_as_if_the_map_had_always_lain_there(
    frame: tuple[float, float, float],
) -> None:
    """The scan straddles the jump: its first beams were taken before it, its last after."""
    twist = Twist(linear_x=0.2, angular_z=0.5)
    ranges = np.full(360, 1.0, dtype=np.float32)
    jumped, steady = ScanPoints(), ScanPoints()
    pose = np.zeros(3)
    for period in range(5):
        scan = LaserScan(stamp=0.25, ranges=ranges) if period == 4 else None
        if period == 3:
            jumped.follow_jump(np.array(frame))
        seen = compose(frame, pose) if period >= 3 else pose
        jumped.update(scan, seen, PERIOD, 3.0)
        steady.update(scan, compose(frame, pose), PERIOD, 3.0)
        pose = arc(pose, twist)
    assert jumped.points == pytest.approx(steady.points, abs=1e-9)
    back = transform_points(inverse(np.array(frame)), jumped.points)
    assert np.hypot(*(back - pose[:2]).T).max() < 1.3

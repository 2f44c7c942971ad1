"""The driver puts its parts together: here, what they do only together."""

import math

import numpy as np
import pytest

from mapping.geometry import compose, wrap_to_pi
from mapping.grid import OccupancyGrid
from nav.driver import Driver
from nav.driver_config import DriverConfig
from tests.nav.scans import PERIOD, Room, Way, box, scan_of

HALL = box(-4.0, -4.0, 8.0, 8.0)
START = np.zeros(3)
BEHIND = np.array([-1.0, 0.0])
CROSSING: Way = lambda time: np.array([2.0, -3.0 + 0.8 * time])  # noqa: E731
"""A leg that comes past, 2 m ahead of the robot, and is gone after 6 s."""


def turned_while_driving(legs: tuple[Way, ...], seconds: float, config: DriverConfig) -> float:
    """How far the robot turns that stands and looks for a time and then goes to what is behind it.

    Returns:
        The difference of headings between there and the start [rad].
    """
    room, driver, pose = Room(walls=HALL, legs=legs), Driver(config), START
    grid = OccupancyGrid()
    watched = round(seconds / PERIOD)
    for k in range(watched + round(8.0 / PERIOD)):
        scan = None
        if k % 2 == 0 and k > 1:
            scan = scan_of(room, PERIOD * (k - 2), np.tile(pose, (360, 1)))
        driver.see(grid, pose, scan)
        if k == watched:
            driver.set_path(np.array([START[:2], BEHIND]))
        twist = driver.follow(1.0) if k >= watched else driver.stand()
        pose = compose(pose, np.array([twist.linear_x * PERIOD, 0.0, twist.angular_z * PERIOD]))
        if math.dist(pose[:2], BEHIND) < 0.1:
            return abs(float(wrap_to_pi(pose[2] - START[2])))
    pytest.fail("it does not come there")


@pytest.mark.parametrize(
    ("legs", "seconds", "facing_time", "turn"),
    [
        ((), 7.0, 30.0, 0.0),
        ((CROSSING,), 7.0, 30.0, math.pi),
        ((CROSSING,), 12.0, 3.0, 0.0),
    ],
    ids=["nobody", "just now", "long ago"],
)
def test_the_robot_drives_backwards_unless_somebody_was_there_just_now(
    legs: tuple[Way, ...], seconds: float, facing_time: float, turn: float
) -> None:
    config = DriverConfig(facing_time=facing_time)
    assert turned_while_driving(legs, seconds, config) == pytest.approx(turn, abs=0.2)

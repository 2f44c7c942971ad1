"""A person's commands become the velocities that turtlebot3_teleop would send."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.burger import MAX_ANGULAR_SPEED, MAX_LINEAR_SPEED
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import Twist
from nav.navigator import COMPLETE, RUNNING, ChosenGoal, Plan
from nav.teleop import QUIT, Teleop, TeleopCommand

GRID = OccupancyGrid(GridConfig(rows=2, columns=2, grows=False))
SPEED = Twist(linear_x=0.2, angular_z=-1.0)


class Autonomy:
    """Drives a while, then is done."""

    def __init__(self, periods: int = 10**9) -> None:
        self.status = RUNNING
        self.plan = Plan(goal=np.ones(2))
        self.dropped_frontiers = ()
        self.goals = (ChosenGoal(time=0.0, x=1.0, y=2.0),)
        self._left = periods

    def command(self, *_: object) -> Twist:
        self._left -= 1
        if self._left < 0:
            self.status = COMPLETE
            return Twist()
        return SPEED


def twist_of(teleop: Teleop) -> Twist:
    return teleop.command(GRID, np.zeros(3), None)


def test_presses_add_up_in_the_steps_of_turtlebot3_teleop() -> None:
    teleop = Teleop(Autonomy)
    for command in (TeleopCommand.FORWARD, TeleopCommand.FORWARD, TeleopCommand.LEFT):
        teleop.tell(command)
    assert twist_of(teleop) == Twist(linear_x=0.02, angular_z=0.1)
    assert twist_of(teleop) == Twist(linear_x=0.02, angular_z=0.1), "it keeps its speeds"
    teleop.tell(TeleopCommand.STOP)
    assert twist_of(teleop) == Twist()


@given(st.lists(st.sampled_from(list(TeleopCommand)), max_size=80))
def test_speeds_keep_the_limits_and_are_whole_steps(commands: list[TeleopCommand]) -> None:
    teleop = Teleop(Autonomy)
    for command in commands:
        teleop.tell(command)
        linear, angular = teleop.speeds.linear_x, teleop.speeds.angular_z
        assert abs(linear) <= MAX_LINEAR_SPEED
        assert abs(angular) <= MAX_ANGULAR_SPEED
        assert linear == round(linear, 2)
        assert angular == round(angular, 2)


@pytest.mark.parametrize(
    ("command", "limit"),
    [
        (TeleopCommand.FORWARD, Twist(linear_x=0.22)),
        (TeleopCommand.BACKWARD, Twist(linear_x=-0.22)),
        (TeleopCommand.LEFT, Twist(angular_z=2.84)),
        (TeleopCommand.RIGHT, Twist(angular_z=-2.84)),
    ],
)
def test_no_number_of_presses_exceeds_a_limit(command: TeleopCommand, limit: Twist) -> None:
    teleop = Teleop(Autonomy)
    for _ in range(40):
        teleop.tell(command)
    assert twist_of(teleop) == limit


def test_go_hands_over_and_a_drive_key_takes_over_from_rest() -> None:
    teleop = Teleop(Autonomy)
    teleop.tell(TeleopCommand.BACKWARD)
    teleop.tell(TeleopCommand.GO)
    assert teleop.is_autonomous
    assert twist_of(teleop) == SPEED
    assert teleop.plan.goal is not None
    teleop.tell(TeleopCommand.FORWARD)
    assert not teleop.is_autonomous
    assert twist_of(teleop) == Twist(linear_x=0.01)
    assert teleop.plan.goal is None


def test_stop_stops_autonomy_as_well() -> None:
    teleop = Teleop(Autonomy)
    teleop.tell(TeleopCommand.GO)
    twist_of(teleop)
    teleop.tell(TeleopCommand.STOP)
    assert twist_of(teleop) == Twist()
    assert not teleop.is_autonomous
    assert teleop.status == RUNNING


def test_autonomy_that_has_ended_gives_back_to_a_standing_robot_and_may_go_again() -> None:
    teleop = Teleop(lambda: Autonomy(periods=2))
    for drives in (1, 2):
        teleop.tell(TeleopCommand.GO)
        teleop.tell(TeleopCommand.GO)  # a second press changes nothing
        assert [twist_of(teleop) for _ in range(4)] == [SPEED, SPEED, Twist(), Twist()]
        assert teleop.ended == COMPLETE
        assert teleop.status == RUNNING
        assert len(teleop.goals) == drives


def test_who_quits_stands() -> None:
    teleop = Teleop(Autonomy)
    teleop.tell(TeleopCommand.GO)
    twist_of(teleop)
    teleop.quit()
    assert teleop.status == QUIT
    assert twist_of(teleop) == Twist()

"""Turns what a person wants into velocities as turtlebot3_teleop does, or lets autonomy drive."""

from collections.abc import Callable
from enum import Enum, auto

from mapping.burger import MAX_ANGULAR_SPEED, MAX_LINEAR_SPEED
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan, Twist
from nav.navigator import RUNNING, ChosenGoal, DroppedFrontier, Navigator, Plan

LINEAR_STEP, ANGULAR_STEP = 0.01, 0.1
"""What one press changes [m/s, rad/s] (turtlebot3_teleop teleop_keyboard.py@da785b7)."""

DECIMALS = 2
"""Speeds are kept to these, so that many presses add up to what they say."""

QUIT = "quit"
"""Status of one who drives no more."""


class TeleopCommand(Enum):
    """What a person may want of the robot."""

    FORWARD = auto()
    BACKWARD = auto()
    LEFT = auto()
    RIGHT = auto()
    STOP = auto()
    """Stand still, whoever drove."""
    GO = auto()
    """Let the autonomous navigator drive."""


STEPS = {
    TeleopCommand.FORWARD: (LINEAR_STEP, 0.0),
    TeleopCommand.BACKWARD: (-LINEAR_STEP, 0.0),
    TeleopCommand.LEFT: (0.0, ANGULAR_STEP),
    TeleopCommand.RIGHT: (0.0, -ANGULAR_STEP),
}
"""What the commands to drive add to the speeds [m/s, rad/s]."""


class Teleop:
    """A navigator that does what it is told; it keeps its speeds until told otherwise.

    No safety layer stands between the person and the wheels: the robot can be driven into things.
    Each time autonomy takes over it begins anew, as if it had started there, on the map so far.

    Args:
        make_autonomy: Makes the navigator that GO hands over to.
    """

    def __init__(self, make_autonomy: Callable[[], Navigator]) -> None:
        self.status = RUNNING
        self.speeds = Twist()
        """The velocity that holds now: what was set by hand, or what autonomy last said."""
        self.ended = ""
        """How autonomy ended when it last did so of itself: ``complete``, ``stuck``, ..."""
        self._make_autonomy = make_autonomy
        self._autonomy: Navigator | None = None
        self._dropped: tuple[DroppedFrontier, ...] = ()
        self._goals: tuple[ChosenGoal, ...] = ()

    @property
    def is_autonomous(self) -> bool:
        """Whether the autonomous navigator drives."""
        return self._autonomy is not None

    @property
    def plan(self) -> Plan:
        """What autonomy has in mind; a person's plans are not known."""
        return Plan() if self._autonomy is None else self._autonomy.plan

    @property
    def dropped_frontiers(self) -> tuple[DroppedFrontier, ...]:
        """What the newest autonomous drive gave up."""
        return self._dropped if self._autonomy is None else self._autonomy.dropped_frontiers

    @property
    def goals(self) -> tuple[ChosenGoal, ...]:
        """What autonomy set out for, each time it drove; a person's goals are not known."""
        return self._goals if self._autonomy is None else self._goals + self._autonomy.goals

    @property
    def decisions(self) -> int:
        """Those of autonomy, while it drives."""
        return 0 if self._autonomy is None else self._autonomy.decisions

    def tell(self, command: TeleopCommand) -> None:
        """Take a command; one to drive takes over from autonomy, beginning at rest."""
        if command is TeleopCommand.GO:
            if self._autonomy is None:
                self._autonomy, self.ended = self._make_autonomy(), ""
            return
        if self._autonomy is not None or command is TeleopCommand.STOP:
            self._take_over()
        if command in STEPS:
            linear, angular = STEPS[command]
            self.speeds = Twist(
                linear_x=_stepped(self.speeds.linear_x, linear, MAX_LINEAR_SPEED),
                angular_z=_stepped(self.speeds.angular_z, angular, MAX_ANGULAR_SPEED),
            )

    def quit(self) -> None:
        """Stop, and drive no more."""
        self._take_over()
        self.status = QUIT

    def command(self, grid: OccupancyGrid, pose_map: Pose, scan: LaserScan | None) -> Twist:
        """The velocity for the next control period."""
        if self._autonomy is not None:
            self.speeds = self._autonomy.command(grid, pose_map, scan)
            if self._autonomy.status != RUNNING:
                self.ended = self._autonomy.status
                self._take_over()
        return self.speeds

    def _take_over(self) -> None:
        """Stand still under the person's command."""
        self._dropped, self._goals = self.dropped_frontiers, self.goals
        self._autonomy, self.speeds = None, Twist()


def _stepped(speed: float, step: float, limit: float) -> float:
    return round(min(max(speed + step, -limit), limit), DECIMALS)

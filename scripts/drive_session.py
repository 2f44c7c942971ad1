"""A person at a terminal as a navigator: keys in, velocities out, in time with the clock."""

import math
from collections.abc import Callable

from evaluation.episode import CONTROL_PERIOD
from evaluation.map_snapshots import MapSnapshots
from evaluation.pace import Pace
from evaluation.progress import Progress
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.mapper import Mapper
from mapping.messages import LaserScan, Twist
from nav.navigator import ChosenGoal, DroppedFrontier, Plan
from nav.teleop import Teleop, TeleopCommand
from scripts.keyboard import KEYS_TOLD, KeyDecoder, Request, command_of
from scripts.live_map import LiveMap


class DriveSession:
    """Waits for the next control period, reading keys meanwhile, then passes the command on.

    Args:
        teleop: What the keys act on.
        mapper: Whose map is shown and plotted.
        pace: When periods are due.
        read: Waits so long for bytes from the keyboard [s]; None when it is gone.
        live_map: Where the map is shown.
        snapshots: What saves plots of it.
    """

    def __init__(
        self,
        teleop: Teleop,
        mapper: Mapper,
        pace: Pace,
        read: Callable[[float], bytes | None],
        live_map: LiveMap,
        snapshots: MapSnapshots,
    ) -> None:
        self._teleop, self._mapper, self._pace = teleop, mapper, pace
        self._read, self._live_map, self._snapshots = read, live_map, snapshots
        self._decoder = KeyDecoder()
        self._periods, self._late_periods = 0, 0
        self._coverage = 0.0
        self._news = ""

    @property
    def status(self) -> str:
        """``running`` until the person quits."""
        return self._teleop.status

    @property
    def plan(self) -> Plan:
        """What autonomy has in mind while it drives."""
        return self._teleop.plan

    @property
    def dropped_frontiers(self) -> tuple[DroppedFrontier, ...]:
        """What autonomy gave up."""
        return self._teleop.dropped_frontiers

    @property
    def goals(self) -> tuple[ChosenGoal, ...]:
        """What autonomy set out for."""
        return self._teleop.goals

    @property
    def decisions(self) -> int:
        """How often autonomy has weighed where to go."""
        return self._teleop.decisions

    @property
    def late_share(self) -> float:
        """Share of the control periods in which the machine was too slow."""
        return self._late_periods / max(self._periods, 1)

    def note_progress(self, progress: Progress) -> None:
        """Take the coverage, which is measured once a simulated second."""
        self._coverage = progress.coverage

    def command(self, grid: OccupancyGrid, pose_map: Pose, scan: LaserScan | None) -> Twist:
        """What the person wants, when the next control period is due."""
        if self._live_map.is_due:
            self.draw()
        self._obey_keys_until_due()
        self._pace.begin()
        self._periods += 1
        self._late_periods += self._pace.is_too_slow
        return self._teleop.command(grid, pose_map, scan)

    def draw(self) -> None:
        """Show the map, and how things stand."""
        pose = self._mapper.pose_map
        progress = Progress(
            time=self._time, coverage=self._coverage, grid=self._mapper.grid, pose_map=pose
        )
        self._live_map.draw(progress, (self._state(pose), self._told(), KEYS_TOLD))

    @property
    def _time(self) -> float:
        """Simulated time that has been driven [s]."""
        return self._periods * CONTROL_PERIOD

    def _obey_keys_until_due(self) -> None:
        """Do what keys say; they are looked at once at least, however late it is."""
        while True:
            piece = self._read(self._pace.left())
            if piece is None:
                self._teleop.quit()
            for key in self._decoder.feed(piece or b""):
                self._obey(key)
            if self._pace.left() == 0.0 or piece is None:
                return

    def _obey(self, key: str) -> None:
        wanted = command_of(key)
        if isinstance(wanted, TeleopCommand):
            self._teleop.tell(wanted)
            self._news = ""
        elif wanted is Request.PLOT:
            title = f"after {self._time:.0f} s, coverage {self._coverage:.3f}"
            self._news = f"plot in {self._snapshots.save(self._mapper, title)}"
        elif wanted is Request.QUIT:
            self._teleop.quit()

    def _state(self, pose: Pose) -> str:
        """Who drives, how fast, and where the mapper takes the robot to be."""
        driver = "autonomous" if self._teleop.is_autonomous else "by hand"
        speeds = self._teleop.speeds
        return (
            f"{driver:<10}  {speeds.linear_x:+.2f} m/s {speeds.angular_z:+.2f} rad/s   "
            f"x {pose[0]:.2f} y {pose[1]:.2f} m, {math.degrees(pose[2]):.0f} deg   "
            f"coverage {self._coverage:.1%}   {self._time:.0f} s"
        )

    def _told(self) -> str:
        """What there is to tell: trouble first."""
        if self._pace.is_too_slow:
            return f"this machine is too slow: {self._pace.speed:.2f}x real time"
        if self._teleop.ended:
            return f"autonomy has ended: {self._teleop.ended}"
        return self._news

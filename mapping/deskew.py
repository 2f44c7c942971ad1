"""Turns odometry messages into the pose that the robot had at any moment, as when a beam was shot.

The LDS-01 takes 0.2 s for a turn; at full spin the robot turns 30 degrees meanwhile, so a scan
drawn from one pose is badly bent.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from mapping.deskew_kernels import interpolate
from mapping.geometry import Pose
from mapping.messages import Odometry

KEEP_S = 0.6
"""Odometry older than this before the newest [s] is forgotten: three turns of the LDS-01, so that
a scan may come a turn late."""

KEEP_ROWS = 4
"""So many of the newest rows are kept whatever their age: a log may hold one a scan, seconds apart,
and a scan may come a few messages late."""

REACH_S = 0.25
"""How far [s] poses are extrapolated: a scan's 0.2 s and one and a half odometry periods."""


class OdometryTrack:
    """The odometry of the last moments."""

    def __init__(self) -> None:
        self._rows: deque[tuple[float, ...]] = deque()

    @property
    def newest(self) -> Pose | None:
        """The newest pose ``(3,)``, or None before the first message."""
        return np.array(self._rows[-1][1:4]) if self._rows else None

    @property
    def newest_turn_rate(self) -> float:
        """The newest turn rate [rad/s], 0 before the first message."""
        return self._rows[-1][5] if self._rows else 0.0

    def add(self, odometry: Sequence[Odometry]) -> None:
        """Take new messages; one not usable, or no newer than the newest, is ignored."""
        for message in odometry:
            if message.is_usable and (not self._rows or message.stamp > self._rows[-1][0]):
                self._rows.append(message.row)
        forget_old(self._rows)

    def poses_at(self, stamps: ArrayLike) -> Pose | None:
        """The poses ``(n, 3)`` at moments ``(n,)`` [s], in the odometry's frame.

        Between messages poses are interpolated, yaw the short way round; outside of them the robot
        goes on, or came, along the arc of the nearest message's twist.

        Returns:
            None when there is no odometry within REACH_S of every moment.
        """
        return poses_on(self._rows, stamps)


def forget_old(rows: deque[tuple[float, ...]]) -> None:
    """Drop rows, stamp first, that no scan will ask for any more."""
    while len(rows) > KEEP_ROWS and rows[0][0] < rows[-1][0] - KEEP_S:
        rows.popleft()


def poses_on(rows: deque[tuple[float, ...]], stamps: ArrayLike) -> Pose | None:
    """Poses ``(n, 3)`` at moments ``(n,)`` [s] on rows of stamp, x, y, yaw, speed and turn rate.

    Returns:
        None when a moment is not finite or lies farther than REACH_S outside of the rows.
    """
    stamps = np.asarray(stamps, dtype=np.float64)
    if not rows or not np.isfinite(stamps).all():
        return None
    first, last = rows[0][0], rows[-1][0]
    if stamps.size and (stamps.min() < first - REACH_S or stamps.max() > last + REACH_S):
        return None
    poses: Pose = interpolate(np.array(rows), stamps)
    return poses

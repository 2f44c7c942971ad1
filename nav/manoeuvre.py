"""Plans a way out of a place where the robot cannot turn, or through a gap: small moves and turns.

The Burger's axle lies well ahead of its middle: on the spot its rear corners sweep a circle far
wider than the gap it can drive into. What came in forwards comes out by turning a little wherever
there is room for it. The search is one over poses (see ``manoeuvre_kernels.search_way``).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MIN
from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi
from mapping.grid import OccupancyGrid
from nav.gap_kernels import bucket_points, occupied_near, worth_minding
from nav.manoeuvre_kernels import BACKWARD, FORWARD, LEFT, NO_MOVE, RIGHT, search_way
from nav.outline import Rectangle
from nav.safety import SafetyConfig

NO_PLACES: NDArray[np.float64] = np.zeros((0, 2))
"""Nothing to avoid."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ManoeuvreConfig:
    """How fine the search is, what moves cost, and how much is kept clear."""

    step: float = 0.02
    """Length of a straight move [m]."""
    headings: int = 48
    """Turns that make a full circle: 7.5 degrees each."""
    reach: float = 1.3
    """A way out leads no farther than this from the start, along x or y [m]: out of a gap a metre
    deep, and on to where there is room to turn."""
    turn_price: float = 0.02
    """What a turn costs, as a way driven [m]: as much as a straight move, it takes as long."""
    switch_price: float = 0.08
    """What a move of another kind than the one before costs, as a way driven [m]."""
    reserves: tuple[float, ...] = (0.008, 0.003, -0.004, -0.008, -0.012)
    """Distance kept beyond the safety layer's margin [m]: the first with which there is a way.
    Below 0 because the nearest of many points lies up to three standard deviations of the lidar's
    noise (3.3 mm) before its wall: the safety layer, which has the last word, lets the robot come
    so near with the next scan."""
    room_reserve: float = 0.006
    """Room to turn on the spot is the outline's reach, the safety layer's margin and this [m]."""
    elsewhere: float = 0.3
    """Room that is to be another than before lies so far from it [m]: beyond the robot's length."""
    onward: float = 0.2
    """Room on the way that the robot was to go lies so near that way [m]."""
    same_wall: float = 0.05
    """A cell of the map this close to a point of the scan is the same wall [m], and the scan knows
    better where it is."""
    most_poses: int = 120_000
    """The search gives up after so many poses: some 0.3 s."""

    def __post_init__(self) -> None:
        """Refuse figures with which nothing is found."""
        for name in ("step", "reach", "turn_price", "switch_price"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise TestbedError(f"manoeuvre {name}: {getattr(self, name)}; must be above 0")
        for name in ("headings", "most_poses"):
            if getattr(self, name) < 4:
                raise TestbedError(f"manoeuvre {name}: {getattr(self, name)}; must be 4 or more")
        if not self.reserves:
            raise TestbedError("manoeuvre reserves: (); must not be empty")


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """Moves of one kind in a row."""

    turns: bool
    """Whether it is a turn on the spot; else a straight line."""
    x: float
    """Where it ends, in the map frame [m]."""
    y: float
    yaw: float
    """Heading at its end [rad]."""
    way: float
    """+1 forward or counter-clockwise, -1 backward or clockwise."""

    @property
    def kind(self) -> int:
        """The kind of its moves."""
        if self.turns:
            return LEFT if self.way > 0.0 else RIGHT
        return FORWARD if self.way > 0.0 else BACKWARD


def plan_manoeuvre(
    pose: Pose,
    scan_points: NDArray[np.float64],
    grid: OccupancyGrid,
    config: ManoeuvreConfig,
    safety: SafetyConfig,
    *,
    avoided: NDArray[np.float64] = NO_PLACES,
    wanted: NDArray[np.float64] = NO_PLACES,
    barred: int = NO_MOVE,
) -> tuple[Leg, ...]:
    """The legs to the cheapest pose from which the robot can turn on the spot; () if none is found.

    A robot that has room to turn where it stands needs none either.

    Args:
        pose: Pose of base_footprint in the map frame ``(3,)``.
        scan_points: End points of the newest scan in the map frame ``(n, 2)`` [m].
        grid: The map, for what the scan does not show.
        config: How to search.
        safety: What the safety layer will allow.
        avoided: Places ``(k, 2)`` [m] at which room was found before, and did not help.
        wanted: Places ``(k, 2)`` [m] near one of which the way is to end, if there are any.
        barred: The kind of move that the way must not begin with: it was tried in vain.
    """
    room = turning_radius(safety.outline) + safety.margin + config.room_reserve
    obstacles = _obstacles(pose, scan_points, grid, config.reach + room, config.same_wall)
    obstacles = obstacles[~_inside(obstacles, pose, safety.outline)]
    half = config.reach + 2.0 * room
    left, bottom = float(pose[0]) - half, float(pose[1]) - half
    count = math.ceil(2.0 * half / room)
    ordered, begins = bucket_points(obstacles, left, bottom, room, count)
    for reserve in config.reserves:
        moves = search_way(
            ordered,
            begins,
            (left, bottom, room, count),
            pose,
            safety.outline,
            safety.margin + reserve,
            room,
            avoided,
            config.elsewhere,
            wanted,
            config.onward,
            barred,
            config.reach,
            (config.step, config.headings),
            (config.step, config.turn_price, config.switch_price),
            config.most_poses,
        )
        if len(moves):
            return _legs(moves, pose, config)
    return ()


def turning_radius(outline: tuple[Rectangle, Rectangle]) -> float:
    """How far the outline reaches from the axle's middle [m]."""
    return max(math.hypot(max(front, back), side) for front, back, side in outline)


def _obstacles(
    pose: Pose, points: NDArray[np.float64], grid: OccupancyGrid, reach: float, same_wall: float
) -> NDArray[np.float64]:
    """What the scan shows within reach and, where it shows nothing, what the map has ``(n, 2)``.

    Around the robot the lidar is blind: there the map counts in any case, as in the safety layer.
    """
    points = points[np.abs(points - pose[:2]).max(axis=1) < reach]
    cells = occupied_near(
        grid.log_odds,
        (float(grid.origin[0]), float(grid.origin[1]), grid.resolution),
        grid.config.occupied_above,
        float(pose[0]),
        float(pose[1]),
        reach,
    )
    eye = pose[:2] + LIDAR_POSE_BASE[0] * np.array([np.cos(pose[2]), np.sin(pose[2])])
    unseen = np.hypot(*(cells - eye).T) < LIDAR_RANGE_MIN + grid.resolution
    hidden = worth_minding(cells, points, same_wall)
    return np.concatenate((points, cells[unseen | hidden]))


def _inside(
    points: NDArray[np.float64], pose: Pose, outline: tuple[Rectangle, Rectangle]
) -> NDArray[np.bool_]:
    """Which points lie inside the robot as it stands: errors of the map or the pose."""
    offset = points - pose[:2]
    ahead = np.cos(pose[2]) * offset[:, 0] + np.sin(pose[2]) * offset[:, 1]
    aside = np.abs(np.cos(pose[2]) * offset[:, 1] - np.sin(pose[2]) * offset[:, 0])
    inside = np.zeros(len(points), dtype=np.bool_)
    for front, back, side in outline:
        inside |= (ahead <= front) & (ahead >= -back) & (aside <= side)
    return inside


def _legs(moves: NDArray[np.int64], pose: Pose, config: ManoeuvreConfig) -> tuple[Leg, ...]:
    """The moves from a pose, those of one kind in a row put together."""
    x, y, yaw = pose.tolist()
    angle = 2.0 * math.pi / config.headings
    legs: list[Leg] = []
    kinds = moves.tolist()
    for kind, following in zip(kinds, [*kinds[1:], -1], strict=True):
        turns = kind not in (FORWARD, BACKWARD)
        way = 1.0 if kind in (FORWARD, LEFT) else -1.0
        if turns:
            yaw += way * angle
        else:
            x += way * config.step * math.cos(yaw)
            y += way * config.step * math.sin(yaw)
        if following != kind:
            legs.append(Leg(turns=turns, x=x, y=y, yaw=float(wrap_to_pi(yaw)), way=way))
    return tuple(legs)

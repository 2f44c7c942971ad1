"""The scans that a map is made of, where they were taken, and the matches that say so."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from mapping.geometry import Pose, between, compose
from mapping.slam.scan_cloud import ScanCloud

FIRST_ROOM = 256
"""Keyframes and edges held at the start; tables double when they are full."""

TURN_LENGTH = 0.5
"""A radian of turning counts as this many metres of way: views change with it as much."""

STEP_LENGTH = 0.02
"""What an edge counts at least [m], so that matches on the spot are not free."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Edge:
    """A match: where one keyframe was taken, seen from another."""

    a: int
    """The keyframe seen from."""
    b: int
    """The keyframe seen."""
    pose: Pose
    """Pose of ``b`` in the frame of ``a`` ``(3,)``."""
    covariance: NDArray[np.float64]
    """Its covariance ``(3, 3)`` in the frame of ``b``."""
    is_loop: bool
    """Whether it closes a loop: such an edge may be wrong and is weighed robustly."""


class KeyframeGraph:
    """Keyframes in the order in which they were taken, and the edges between them."""

    def __init__(self) -> None:
        self.clouds: list[ScanCloud] = []
        self.sights: list[float] = []
        """How far each keyframe typically saw [m]."""
        self.edges: list[Edge] = []
        self._poses = np.empty((FIRST_ROOM, 3))
        self._looks = np.empty((FIRST_ROOM, 2))
        self._ends = np.empty((FIRST_ROOM, 2), dtype=np.int64)
        self._lengths = np.empty(FIRST_ROOM)
        self._views, self._views_state = np.zeros((0, 2)), (0, 0)
        self._ways: dict[int, tuple[NDArray[np.float64], NDArray[np.int32]]] = {}
        self._pairs: dict[tuple[int, int], int] = {}
        self._information = np.empty((FIRST_ROOM, 2))
        self.corrections = 0
        """How often the poses were changed after the fact."""

    def __len__(self) -> int:
        return len(self.clouds)

    @property
    def poses(self) -> Pose:
        """Where each keyframe was taken ``(n, 3)``, in the map frame, as far as is known now."""
        return self._poses[: len(self.clouds)]

    @property
    def views(self) -> NDArray[np.float64]:
        """The middle of what each keyframe saw ``(n, 2)``, in the map frame."""
        state = (len(self.clouds), self.corrections)
        if state != self._views_state:
            x, y, yaw = self.poses.T
            look_x, look_y = self._looks[: len(self.clouds)].T
            cos, sin = np.cos(yaw), np.sin(yaw)
            view_x, view_y = x + cos * look_x - sin * look_y, y + sin * look_x + cos * look_y
            self._views, self._views_state = np.column_stack((view_x, view_y)), state
        return self._views

    def add(self, pose: Pose, cloud: ScanCloud) -> int:
        """Add a keyframe without edges; returns its number."""
        number = len(self.clouds)
        self._ways.clear()
        self._poses, self._looks = _grown(self._poses, number), _grown(self._looks, number)
        self._poses[number] = pose
        self._looks[number] = look_of(cloud)
        self.sights.append(sight_of(cloud))
        self.clouds.append(cloud)
        return number

    def connect(self, edge: Edge) -> None:
        """Add an edge between keyframes that there are; several may join the same two."""
        self._ways.clear()
        self.edges.append(edge)
        dx, dy, turn = edge.pose
        length = STEP_LENGTH + np.hypot(dx, dy) + TURN_LENGTH * abs(turn)
        a, b, c = edge.covariance[0, 0], edge.covariance[0, 1], edge.covariance[1, 1]
        widest = 0.5 * (a + c) + np.hypot(0.5 * (a - c), b)
        information = 1.0 / np.array([widest, edge.covariance[2, 2]])
        pair = (min(edge.a, edge.b), max(edge.a, edge.b))
        if pair in self._pairs:
            row = self._pairs[pair]
            self._lengths[row] = min(self._lengths[row], length)
            self._information[row] += information
            return
        row = self._pairs[pair] = len(self._pairs)
        self._ends, self._lengths = _grown(self._ends, row), _grown(self._lengths, row)
        self._information = _grown(self._information, row)
        self._ends[row], self._lengths[row], self._information[row] = pair, length, information

    def correct(self, poses: Pose) -> None:
        """Take better poses ``(n, 3)`` of all keyframes."""
        self._poses[: len(poses)] = poses
        self.corrections += 1

    def ways(
        self, keyframe: int, limit: float = np.inf
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Length of the shortest way along edges from a keyframe to each ``(n,)`` [m].

        Keyframes farther than ``limit`` are infinitely far. The second array ``(n,)`` holds the
        keyframe before each on its way, negative where there is none.
        """
        if keyframe not in self._ways:
            self._ways[keyframe] = self._measured_ways(keyframe)
        distances, before = self._ways[keyframe]
        return np.where(distances <= limit, distances, np.inf), before

    def _measured_ways(self, keyframe: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        count, pairs = len(self.clouds), len(self._pairs)
        a, b = self._ends[:pairs].T
        ends = np.concatenate((a, b)), np.concatenate((b, a))
        lengths = np.tile(self._lengths[:pairs], 2)
        graph = csr_matrix((lengths, ends), shape=(count, count))
        distances, before = dijkstra(graph, indices=[keyframe], return_predecessors=True)
        return distances[0], before[0]

    def uncertainty(
        self, keyframe: int, other: int, before: NDArray[np.int32]
    ) -> tuple[float, float]:
        """Variance of one keyframe's place [m^2] and yaw [rad^2] seen from another.

        Summed along the shortest way between them (Olson 2009, "Recognizing Places Using
        Spectrally Clustered Local Matches"): an upper bound, as other ways can only help.

        Args:
            keyframe: The keyframe that ``ways`` was asked from.
            other: The other one.
            before: The second array that ``ways`` gave.
        """
        chain = [other]
        while chain[-1] != keyframe and before[chain[-1]] >= 0:
            chain.append(int(before[chain[-1]]))
        rows = [self._pairs[min(a, b), max(a, b)] for a, b in pairwise(chain)]
        variances = 1.0 / self._information[rows].reshape(-1, 2)
        arms = self.poses[chain[1:], :2] - self.poses[keyframe, :2]
        place = variances[:, 0].sum() + (variances[:, 1] * (arms**2).sum(axis=1)).sum()
        return float(place), float(variances[:, 1].sum())


def look_of(cloud: ScanCloud) -> NDArray[np.float64]:
    """The middle of what a scan saw ``(2,)`` in its own frame: near 0 if it looked all around."""
    return cloud.points.mean(axis=0) if len(cloud) else np.zeros(2)


def view_of(pose: Pose, cloud: ScanCloud) -> NDArray[np.float64]:
    """The middle of what a scan saw from a pose ``(2,)``, in the frame of the pose."""
    return compose(pose, np.append(look_of(cloud), 0.0))[:2]


def sight_of(cloud: ScanCloud) -> float:
    """How far a scan typically saw [m]: half of its points lie farther from the robot."""
    return float(np.median(np.hypot(*cloud.points.T))) if len(cloud) else 0.0


def edge_between(
    a: int,
    b: int,
    pose_a: Pose,
    pose_b: Pose,
    covariance_map: NDArray[np.float64],
    *,
    is_loop: bool = False,
) -> Edge:
    """The edge that a match makes, given the covariance of ``pose_b`` in the map frame."""
    cos, sin = np.cos(pose_b[2]), np.sin(pose_b[2])
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return Edge(
        a=a,
        b=b,
        pose=between(pose_a, pose_b),
        covariance=turn @ covariance_map @ turn.T,
        is_loop=is_loop,
    )


def _grown(table: NDArray[Any], row: int) -> NDArray[Any]:
    """The table, twice as long if it does not have the row yet."""
    return table if row < len(table) else np.concatenate((table, np.empty_like(table)))

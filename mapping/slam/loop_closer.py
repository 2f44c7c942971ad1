"""Finds places seen before: candidates by place and covariance, each verified before it is trusted.

A keyframe and its nearest fellows, laid together into one cloud, are searched for in the map made
of keyframes that are far away along the edges but may be near in space. A place found within a
narrow window is believed; one found far from where it was thought to be must be found again from
another keyframe, and both must agree. What the walls leave open, as where along one of them it
lies, stays as it was thought to be; far away such a place is none, for any wall would do.
"""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose, inverse, transform_points, wrap_to_pi
from mapping.slam.correlative_search import search_window
from mapping.slam.keyframe_graph import Edge, KeyframeGraph, edge_between
from mapping.slam.local_map import LocalMap, LocalMapConfig
from mapping.slam.scan_cloud import ScanCloud
from mapping.slam.scan_matcher import MatcherConfig, match_scan, weighed_anew

OVERLAP = 2.0
"""Views whose middles are within this share of how far a scan typically sees show enough of the
same."""

DETOUR = 3.0
"""A place is come back to when the way to it along the edges is this many times its distance."""

LEAST_TURN = 0.02
"""Yaws are searched at least so far to both sides [rad]."""

PASS = 10
"""Keyframes so near in time belong to one pass of the robot."""

SEARCHED_SIGMAS = np.array([0.1, 0.1, 0.05])
"""How sure [m, m, rad] the best pose of a search over whole cells is."""

LOOP_SIGMAS = np.array([0.01, 0.01, 0.003])
"""What the far keyframes may lie wrong among themselves [m, m, rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopConfig:
    """When a place counts as seen before."""

    sigmas: float = 3.0
    """How many standard deviations around the estimate are searched."""
    widest_shift: float = 4.0
    """The search goes no farther than this [m]."""
    widest_turn: float = 0.6
    """Nor farther than this [rad]."""
    sure_shift: float = 0.5
    """A place found by a search no wider than this [m] is believed at once."""
    sure_turn: float = 0.3
    """The same for the yaw [rad]."""
    least_score: float = 0.6
    """Share of the cloud that must lie on walls of the other map."""
    far_score: float = 0.7
    """The same for a place that is not believed at once."""
    apart: float = 1.5
    """A place found twice is believed if so much way lies between [m]; else it was one view."""
    together: int = 2
    """Or if so many agree with the newest one, however near."""
    fellows: int = 8
    """Keyframes laid together into the cloud."""
    points: int = 500
    """The cloud is thinned to so many points."""
    agree_shift: float = 0.2
    """Two places found agree when they differ by less than this [m]; one less sure than this of
    where it lies is none, unless it is believed at once."""
    agree_turn: float = 0.06
    """And by less than this [rad]."""
    memory: int = 15
    """A place found waits for so many keyframes to be found again."""

    def __post_init__(self) -> None:
        """Refuse figures that make no search."""
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise TestbedError(f"loop {name}: {value}; must be a finite number above 0")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Found:
    """A place that was found: where a keyframe must be, by one of the far keyframes."""

    keyframe: int
    far: int
    score: float
    pose: Pose
    covariance: NDArray[np.float64]


class LoopCloser:
    """Looks for one place with each keyframe; remembers what it cannot be sure of yet."""

    def __init__(
        self,
        graph: KeyframeGraph,
        local: LocalMapConfig,
        matcher: MatcherConfig,
        config: LoopConfig,
    ) -> None:
        self._graph = graph
        self._map = LocalMap(graph, local)
        self._matcher = matcher
        self.config = config
        self._waiting: list[_Found] = []
        self._tried: deque[int] = deque(maxlen=3)

    def edges(self, keyframe: int, local: list[int]) -> list[Edge]:
        """The edges to add, now that there is a new keyframe; mostly none.

        Args:
            keyframe: The newest keyframe.
            local: Keyframes of the local map that it was matched with.
        """
        window = self._candidate(keyframe)
        if window is None:
            return []
        far, shift, turn = window
        found = self._find(keyframe, far, shift, turn, set(local) | {keyframe})
        if found is None:
            return []
        if shift <= self.config.sure_shift and turn <= self.config.sure_turn:
            return [self._edge(found)]
        if found.score < self.config.far_score or self._is_open(found):
            return []
        oldest = keyframe - self.config.memory
        self._waiting = [other for other in self._waiting if other.keyframe >= oldest]
        fellows = [other for other in self._waiting if self._agree(other, found)]
        ways, _ = self._graph.ways(keyframe)
        apart = any(ways[other.keyframe] >= self.config.apart for other in fellows)
        if not (apart or len(fellows) >= self.config.together):
            self._waiting.append(found)
            return []
        self._waiting = [other for other in self._waiting if other not in fellows]
        return [self._edge(each) for each in (*fellows, found)]

    def _candidate(self, keyframe: int) -> tuple[int, float, float] | None:
        """The likeliest far keyframe, and how far around to search [m, rad].

        Of the passes that came near, each a run of keyframes, the nearest is tried that was not
        tried just before.
        """
        graph, config = self._graph, self.config
        ways, before = graph.ways(keyframe)
        near = OVERLAP * graph.sights[keyframe]
        distances = np.hypot(*(graph.views - graph.views[keyframe]).T)
        far = (ways > self._map.config.way) & (ways > DETOUR * distances)
        far &= distances < config.widest_shift + near
        order = np.flatnonzero(far)
        order = order[np.argsort(distances[order], kind="stable")]
        rest = order
        while len(rest):
            nearest = int(rest[0])
            if all(abs(nearest - other) > PASS for other in self._tried):
                break
            rest = rest[np.abs(rest - nearest) > PASS]
        else:
            self._tried.clear()
            if len(order) == 0:
                return None
            nearest = int(order[0])
        self._tried.append(nearest)
        place, yaw = graph.uncertainty(keyframe, nearest, before)
        shift = min(config.sigmas * math.sqrt(place), config.widest_shift)
        if distances[nearest] > shift + near:
            return None
        turn = min(config.sigmas * math.sqrt(yaw), config.widest_turn)
        least = 2.0 * self._map.config.resolution
        return nearest, shift + least, turn + LEAST_TURN

    def _find(
        self, keyframe: int, far: int, shift: float, turn: float, apart_from: set[int]
    ) -> _Found | None:
        """Search for a keyframe's cloud in the map around a far keyframe."""
        graph = self._graph
        pose = graph.poses[keyframe].copy()
        self._map.gather(far, graph.views[keyframe], apart_from)
        field = self._map.field
        cloud = self._cloud(keyframe)
        best = search_window(
            field, cloud, field.to_cells(pose), shift, turn, self.config.least_score
        )
        if best.score <= 0.0:
            return None
        match = match_scan(
            field, cloud, field.to_metres(best.pose), np.diag(SEARCHED_SIGMAS**2), self._matcher
        )
        if match.refused or match.score < self.config.least_score:
            return None
        sigmas = np.array([shift, shift, turn]) / self.config.sigmas
        there, covariance = weighed_anew(match, pose, np.diag(sigmas**2))
        views = graph.views[self._map.keyframes]
        view = transform_points(compose(there, inverse(pose)), graph.views[keyframe][None])
        nearest = self._map.keyframes[int(np.argmin(np.hypot(*(views - view).T)))]
        return _Found(
            keyframe=keyframe,
            far=nearest,
            score=match.score,
            pose=between(graph.poses[nearest], there),
            covariance=covariance + np.diag(LOOP_SIGMAS**2),
        )

    def _cloud(self, keyframe: int) -> ScanCloud:
        """The clouds of a keyframe and its nearest fellows, in its frame, thinned."""
        graph, config = self._graph, self.config
        ways, _ = graph.ways(keyframe, self._map.config.reach)
        fellows = np.argsort(ways, kind="stable")[: config.fellows]
        fellows = fellows[np.isfinite(ways[fellows])]
        origin = graph.poses[keyframe]
        clouds = [graph.clouds[k] for k in fellows]
        places = between(origin, graph.poses[fellows])
        points = np.concatenate(
            [transform_points(p, c.points) for p, c in zip(places, clouds, strict=True)]
        )
        turns = places * (0.0, 0.0, 1.0)
        normals = np.concatenate(
            [transform_points(t, c.normals) for t, c in zip(turns, clouds, strict=True)]
        )
        weights = np.concatenate([cloud.weights for cloud in clouds])
        step = max(len(points) // config.points, 1)
        return ScanCloud(
            points=points[::step].copy(),
            normals=normals[::step].copy(),
            weights=weights[::step].copy(),
            surface=np.zeros((0, 5), np.float32),
        )

    def _is_open(self, found: _Found) -> bool:
        """Whether it may lie anywhere along a wall: then any wall would have done."""
        widest = np.linalg.eigvalsh(found.covariance[:2, :2])[-1]
        return bool(math.sqrt(widest) > self.config.agree_shift)

    def _agree(self, earlier: _Found, later: _Found) -> bool:
        """Whether two places found move the robot's past by the same."""
        poses = self._graph.poses
        moved = compose(self._where(earlier), inverse(poses[earlier.keyframe]))
        expected = compose(moved, poses[later.keyframe])
        off = between(expected, self._where(later))
        config = self.config
        return bool(
            math.hypot(off[0], off[1]) < config.agree_shift
            and abs(wrap_to_pi(off[2])) < config.agree_turn
        )

    def _where(self, found: _Found) -> Pose:
        """Where a found place puts its keyframe in the map as it is now."""
        return compose(self._graph.poses[found.far], found.pose)

    def _edge(self, found: _Found) -> Edge:
        pose = self._where(found)
        return edge_between(
            found.far,
            found.keyframe,
            self._graph.poses[found.far],
            pose,
            found.covariance,
            is_loop=True,
        )

"""The keyframes around the robot, smeared into the field that the next scan is matched with."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.slam.hit_field import HitField
from mapping.slam.keyframe_graph import KeyframeGraph

OFF_CENTER = 0.25
"""Share of its reach by which the robot may leave the field's middle before it is laid anew."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalMapConfig:
    """How large the neighbourhood is, and how fine its field."""

    resolution: float
    """Edge of a field's cell and standard deviation of its bells [m]."""
    reach: float
    """Points farther than this from the robot are not matched [m]."""
    outlier: float = 1.0
    """Density that stands for unknown things; a wall seen by one scan has 1."""
    keyframes: int
    """A local map has at most so many keyframes."""
    way: float
    """Keyframes farther away along edges than this [m] are not trusted to be in place."""


class LocalMap:
    """A field of the keyframes near a place, made anew when it has to be."""

    def __init__(self, graph: KeyframeGraph, config: LocalMapConfig) -> None:
        self._graph = graph
        self.config = config
        self.field = HitField(config.resolution, (1.0 + OFF_CENTER) * config.reach, config.outlier)
        self.keyframes: list[int] = []
        self._corrections = -1
        self._followed = (-1, -1, -1)

    def follow(self, near: int, view: NDArray[np.float64]) -> None:
        """Gather the keyframes around a view, unless nothing has changed since the last time."""
        graph = self._graph
        state = (near, len(graph), graph.corrections)
        if state != self._followed:
            self._followed = state
            self.gather(near, view)

    def gather(
        self, near: int, view: NDArray[np.float64], apart_from: set[int] | None = None
    ) -> None:
        """Make it the keyframes with the views nearest to one, of those close to a keyframe.

        Args:
            near: The keyframe that the others must be close to along edges.
            view: Middle of what is seen now ``(2,)``, in the map frame.
            apart_from: Keyframes that must not be in it.
        """
        graph = self._graph
        ways, _ = graph.ways(near, self.config.way)
        close = np.flatnonzero(np.isfinite(ways))
        if apart_from:
            close = np.array([k for k in close if k not in apart_from], dtype=np.int64)
        order = np.argsort(np.hypot(*(graph.views[close] - view).T), kind="stable")
        wanted = close[order[: self.config.keyframes]].tolist()
        self._fill(wanted, graph.poses[near, :2])

    def _fill(self, wanted: list[int], center: NDArray[np.float64]) -> None:
        """Smear what is missing; start anew when something is there that should not be."""
        graph = self._graph
        moved = np.max(np.abs(self.field.center - center)) > OFF_CENTER * self.config.reach
        too_many = len(set(self.keyframes) - set(wanted)) > self.config.keyframes // 2
        if moved or too_many or self._corrections != graph.corrections:
            self.field.clear(center)
            self.keyframes = []
            self._corrections = graph.corrections
        for keyframe in wanted:
            if keyframe not in self.keyframes:
                self.field.add(graph.poses[keyframe], graph.clouds[keyframe].surface)
                self.keyframes.append(keyframe)

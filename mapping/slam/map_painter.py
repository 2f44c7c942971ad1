"""Draws scans into the map at once, and draws the whole map anew when its past was corrected.

Drawing anew is spread over many updates on a second grid, so that no update takes long. Until it is
done the robot and its scans stay in the old map's frame, so that map and pose always fit.
"""

import numpy as np

from mapping.geometry import Pose, between, compose
from mapping.grid import OccupancyGrid
from mapping.ogm import OgmConfig
from mapping.slam.keyframe_graph import KeyframeGraph
from mapping.slam.sweep import Sweep

ARM = 3.0
"""A turn of a keyframe moves what it saw, typically so far away [m], sideways."""


class MapPainter:
    """The map, the scans that it can be drawn from, and where its keyframes are drawn."""

    def __init__(self, grid: OccupancyGrid, config: OgmConfig, graph: KeyframeGraph) -> None:
        self.grid = grid
        self._config = config
        self._graph = graph
        self._kept: list[tuple[int, Pose, Sweep]] = []
        self._drawn = np.zeros((0, 3))
        self._next_drawn = np.zeros((0, 3))
        self._next_grid: OccupancyGrid | None = None
        self._next = 0
        self._error, self._error_state = 0.0, (0, 0)

    def __len__(self) -> int:
        return len(self._kept)

    def to_map(self, keyframe: int, pose: Pose) -> Pose:
        """Where a pose of the corrected graph, near a keyframe, lies in the map as it is drawn."""
        self._drawn = self._extended(self._drawn)
        return compose(self._drawn[keyframe], between(self._graph.poses[keyframe], pose))

    def paint(self, sweep: Sweep, pose_map: Pose) -> None:
        """Draw a scan into the map as it is."""
        sweep.draw(self.grid, self._config, pose_map)

    def keep(self, keyframe: int, pose: Pose, sweep: Sweep) -> None:
        """Keep a scan, taken at a pose of the corrected graph, for drawing the map anew."""
        self._kept.append((keyframe, between(self._graph.poses[keyframe], pose), sweep))

    @property
    def error(self) -> float:
        """How far from its corrected place anything is drawn [m], about."""
        state = (self.grid.redraws, self._graph.corrections)
        if state != self._error_state:
            self._drawn = self._extended(self._drawn)
            off = between(self._drawn, self._graph.poses)
            errors = np.hypot(off[:, 0], off[:, 1]) + ARM * np.abs(off[:, 2])
            self._error, self._error_state = float(np.max(errors, initial=0.0)), state
        return self._error

    @property
    def is_redrawing(self) -> bool:
        """Whether a new map is being drawn."""
        return self._next_grid is not None

    def redraw(self) -> None:
        """Begin to draw the map anew from the corrected poses."""
        self._next_grid = OccupancyGrid(self.grid.config)
        self._next_drawn = self._graph.poses.copy()
        self._next = 0

    def work(self, sweeps: int) -> None:
        """Draw so many kept scans into the new map, if there is one; put it in place when done."""
        if self._next_grid is None:
            return
        self._next_drawn = self._extended(self._next_drawn)
        for keyframe, place, sweep in self._kept[self._next : self._next + sweeps]:
            sweep.draw(self._next_grid, self._config, compose(self._next_drawn[keyframe], place))
        self._next += sweeps
        if self._next < len(self._kept):
            return
        self.grid.log_odds, self.grid.origin = self._next_grid.log_odds, self._next_grid.origin
        self.grid.redraws += 1
        self._drawn = self._next_drawn
        self._next_grid = None

    def _extended(self, drawn: Pose) -> Pose:
        """Drawn poses with those of newer keyframes, each where it lies from the one before it."""
        poses = self._graph.poses
        if len(drawn) == len(poses):
            return drawn
        if len(drawn) == 0:
            return poses.copy()
        rows = [drawn[-1]]
        for keyframe in range(len(drawn), len(poses)):
            rows.append(compose(rows[-1], between(poses[keyframe - 1], poses[keyframe])))
        return np.concatenate((drawn, rows[1:]))

"""Draws scans into the map at once, and draws the whole map anew when its past was corrected.

Drawing anew is spread over many updates on a second grid, so that no update takes long. Until it is
done the robot and its scans stay in the old map's frame, so that map and pose always fit.
"""

from collections.abc import Iterator

import numpy as np

from mapping.aimed_beams import AimedBeams
from mapping.geometry import Pose, between, compose
from mapping.grazed_walls import GrazedWalls
from mapping.grid import OccupancyGrid
from mapping.ogm import OgmConfig
from mapping.poles import PoleFinder
from mapping.slam.keyframe_graph import KeyframeGraph
from mapping.slam.metric_scale import grown, scaled
from mapping.slam.sweep import Sweep
from mapping.surface_refinement import SurfaceRefinement

ARM = 3.0
"""A turn of a keyframe moves what it saw, typically so far away [m], sideways."""


class MapPainter:
    """The map, the scans that it can be drawn from, and where its keyframes are drawn."""

    def __init__(self, grid: OccupancyGrid, config: OgmConfig, graph: KeyframeGraph) -> None:
        self.grid = grid
        self._config = config
        self._graph = graph
        self._kept: list[tuple[int, Pose, Sweep]] = []
        self.scale = 1.0
        """Metres of the map to a metre of the lidar, when it is drawn anew: grown or shrunk about
        the first keyframe."""
        self._drawn, self._drawn_scale = np.zeros((0, 3)), 1.0
        self._next_drawn, self._next_scale = np.zeros((0, 3)), 1.0
        self._next_grid: OccupancyGrid | None = None
        self._next = 0
        self._error, self._error_state = 0.0, (0, 0, 1.0)

    def __len__(self) -> int:
        return len(self._kept)

    def to_map(self, keyframe: int, pose: Pose) -> Pose:
        """Where a pose of the corrected graph, near a keyframe, lies in the map as it is drawn."""
        self._drawn = self._extended(self._drawn, self._drawn_scale)
        place = between(self._graph.poses[keyframe], pose)
        return compose(self._drawn[keyframe], scaled(place, self._drawn_scale))

    def corrected(self, poses: Pose) -> Pose:
        """Where poses of the corrected graph ``(n, 3)`` lie in a map that were drawn anew now."""
        return grown(poses, self._graph.poses[:1], self.scale)

    def paint(self, sweep: Sweep, pose_map: Pose) -> None:
        """Draw a scan into the map as it is."""
        sweep.draw(self.grid, self._config, pose_map, self._drawn_scale)

    def keep(self, keyframe: int, pose: Pose, sweep: Sweep) -> None:
        """Keep a scan, taken at a pose of the corrected graph, for drawing the map anew."""
        self._kept.append((keyframe, between(self._graph.poses[keyframe], pose), sweep))

    @property
    def error(self) -> float:
        """How far from its corrected place anything is drawn [m], about."""
        state = (self.grid.redraws, self._graph.corrections, self.scale)
        if state != self._error_state:
            self._drawn = self._extended(self._drawn, self._drawn_scale)
            off = between(self._drawn, self.corrected(self._graph.poses))
            errors = np.hypot(off[:, 0], off[:, 1]) + ARM * np.abs(off[:, 2])
            self._error, self._error_state = float(errors.max(initial=0.0)), state
        return self._error

    @property
    def is_redrawing(self) -> bool:
        """Whether a new map is being drawn."""
        return self._next_grid is not None

    def redraw(self) -> None:
        """Begin to draw the map anew from the corrected poses."""
        self._next_grid = OccupancyGrid(self.grid.config)
        self._next_drawn = self.corrected(self._graph.poses)
        self._next_scale = self.scale
        self._next = 0

    def work(self, sweeps: int) -> None:
        """Draw so many kept scans into the new map, if there is one; put it in place when done."""
        if self._next_grid is None:
            return
        scale = self._next_scale
        self._next_drawn = self._extended(self._next_drawn, scale)
        for keyframe, place, sweep in self._kept[self._next : self._next + sweeps]:
            pose_map = compose(self._next_drawn[keyframe], scaled(place, scale))
            sweep.draw(self._next_grid, self._config, pose_map, scale)
        self._next += sweeps
        if self._next < len(self._kept):
            return
        self.grid.log_odds, self.grid.origin = self._next_grid.log_odds, self._next_grid.origin
        self.grid.redraws += 1
        self._drawn, self._drawn_scale = self._next_drawn, scale
        self._next_grid = None

    def refine(self) -> None:
        """Move surfaces to where all kept scans say, close walls, and draw the poles they saw."""
        self._drawn, self._drawn_scale = self.corrected(self._graph.poses), self.scale
        refinement, finder = SurfaceRefinement(self.grid, self._config), PoleFinder()
        grazed = GrazedWalls(self.grid)
        for beams in self._aimed():
            refinement.add(beams)
            grazed.add(beams)
            finder.spot(beams)
        refinement.write()
        grazed.write(self._config)
        if finder.gather():
            for beams in self._aimed():
                finder.look(beams)
            finder.write(self.grid, self._config)

    def _aimed(self) -> Iterator[AimedBeams]:
        """The kept scans' beams in the map as it is drawn, oldest first."""
        scale = self._drawn_scale
        for keyframe, place, sweep in self._kept:
            pose_map = compose(self._drawn[keyframe], scaled(place, scale))
            beams = sweep.aimed(self._config, pose_map, scale)
            if beams is not None:
                yield beams

    def _extended(self, drawn: Pose, scale: float) -> Pose:
        """Drawn poses with those of newer keyframes, each where it lies from the one before it."""
        poses = self._graph.poses
        if len(drawn) == len(poses):
            return drawn
        if len(drawn) == 0:
            return grown(poses, poses[:1], scale)
        rows = [drawn[-1]]
        for keyframe in range(len(drawn), len(poses)):
            step = scaled(between(poses[keyframe - 1], poses[keyframe]), scale)
            rows.append(compose(rows[-1], step))
        return np.concatenate((drawn, rows[1:]))

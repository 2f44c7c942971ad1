"""Keeps the maps of many particles in tiles that they share until one of them is written."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.slam.tile_map_kernels import (
    TILE_CELLS,
    beam_cells,
    draw_tiles,
    mark_tiles,
    own_tiles,
    write_beams,
)

FIRST_TILES = 64
"""Tiles in the pool at the start."""

POOL_GROWTH = 1.25
"""The pool grows by this factor, small because old and new stand side by side for a moment."""

MARGIN_TILES = 1
"""Empty tiles kept around everything seen: a particle's guess may lie a little outside."""


class TileMaps:
    """One map per particle: a table of tile numbers each, and one pool of tiles for all.

    Tile 0 is empty and stands wherever nothing was seen. A tile in several tables is copied when
    it is written, so a particle that is born of another costs one table until their maps part.
    """

    def __init__(
        self, particles: int, resolution: float, anchor: ArrayLike, full_share: float
    ) -> None:
        """Make empty maps.

        Args:
            particles: How many.
            resolution: Edge of a cell [m].
            anchor: A corner of cells in the map frame, x and y [m] ``(2,)``.
            full_share: A cell is full when hits make up more than this share of its visits.
        """
        self.resolution = resolution
        self.anchor = np.array(anchor, dtype=np.float64)
        self.full_share = full_share
        self.corner = np.zeros(2, dtype=np.int64)
        """Column and row, counted from the anchor, of the tables' first cell."""
        self.tables: NDArray[np.int32] = np.zeros((particles, 0, 0), dtype=np.int32)
        """Tile numbers ``[particle, tile row, tile column]``."""
        shape = (FIRST_TILES, TILE_CELLS, TILE_CELLS)
        self.hits: NDArray[np.uint16] = np.zeros(shape, dtype=np.uint16)
        self.visits: NDArray[np.uint16] = np.zeros(shape, dtype=np.uint16)
        self.means: NDArray[np.float32] = np.zeros((*shape, 2), dtype=np.float32)
        self.full: NDArray[np.uint32] = np.zeros(shape[:2], dtype=np.uint32)
        self.references: NDArray[np.int32] = np.zeros(FIRST_TILES, dtype=np.int32)
        """In how many tables each tile stands; of tile 0 nobody counts."""
        self._free_tiles = np.arange(1, FIRST_TILES, dtype=np.int32)
        self._free_count = FIRST_TILES - 1

    @property
    def tiles_used(self) -> int:
        """How many tiles of the pool hold something."""
        return len(self.references) - 1 - self._free_count

    def in_cells(self, pose_map: Pose) -> Pose:
        """A pose ``(3,)`` or poses ``(n, 3)`` with x and y in cells from the tables' corner."""
        cells = np.array(pose_map, dtype=np.float64)
        cells[..., :2] = (cells[..., :2] - self.anchor) / self.resolution - self.corner
        return cells

    def in_map(self, pose_cells: Pose) -> Pose:
        """The inverse of ``in_cells``."""
        poses = np.array(pose_cells, dtype=np.float64)
        poses[..., :2] = (poses[..., :2] + self.corner) * self.resolution + self.anchor
        return poses

    def cover(self, left: float, right: float, bottom: float, top: float) -> None:
        """Grow the tables until a box [m] of the map frame and a margin lie inside."""
        low = (np.array([left, bottom]) - self.anchor) / self.resolution
        high = (np.array([right, top]) - self.anchor) / self.resolution
        first = np.floor(low / TILE_CELLS).astype(np.int64) - MARGIN_TILES
        end = np.floor(high / TILE_CELLS).astype(np.int64) + MARGIN_TILES + 1
        rows, columns = self.tables.shape[1:]
        if rows == 0:
            self.corner = first * TILE_CELLS
        here = self.corner // TILE_CELLS
        before = np.maximum(here - first, 0)
        after = np.maximum(end - here - np.array([columns, rows]), 0)
        if before.any() or after.any():
            widths = ((0, 0), (before[1], after[1]), (before[0], after[0]))
            self.tables = np.pad(self.tables, widths)
            self.corner = self.corner - before * TILE_CELLS

    def write(
        self,
        particle: int,
        pose_map: Pose,
        origins: NDArray[np.float64],
        ends: NDArray[np.float64],
        is_hit: NDArray[np.bool_],
    ) -> NDArray[np.bool_]:
        """Count a scan in one particle's map; the table must cover it.

        Args:
            particle: Whose map.
            pose_map: Pose of base_footprint ``(3,)``.
            origins: Where the beams start in base_footprint [m] ``(n, 2)``.
            ends: Where they end [m] ``(n, 2)``.
            is_hit: Whether they met something there ``(n,)``.

        Returns:
            The tiles that changed ``(tile rows, tile columns)``.
        """
        pose = self.in_cells(pose_map)
        ends_cells = ends / self.resolution
        cells = beam_cells(pose, origins / self.resolution, ends_cells)
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        in_last = ends_cells @ np.array([[cos, sin], [-sin, cos]]) + pose[:2] - cells[:, 2:]
        table = self.tables[particle]
        crossed = np.zeros(table.shape, dtype=np.bool_)
        mark_tiles(cells, crossed)
        self._reserve(int(np.count_nonzero(crossed)))
        pool = (self.hits, self.visits, self.means, self.full)
        self._free_count = own_tiles(
            table, crossed, self.references, self._free_tiles, self._free_count, *pool
        )
        write_beams(table, cells, in_last, is_hit, self.full_share, *pool)
        return crossed

    def resample(self, parents: NDArray[np.intp]) -> None:
        """Replace the particles' maps by those of ``parents`` ``(particles,)``; nothing is copied.

        Tiles that nobody has any more are free again.
        """
        self.tables = self.tables[parents]
        self.references = np.bincount(self.tables.ravel(), minlength=len(self.references)).astype(
            np.int32
        )
        unused = np.flatnonzero(self.references[1:] == 0) + 1
        self._free_count = len(unused)
        self._free_tiles[: len(unused)] = unused[::-1]

    def draw(
        self,
        particle: int,
        wanted: NDArray[np.bool_],
        grid: OccupancyGrid,
        occupied_share: float,
        occupied: float,
        free: float,
    ) -> None:
        """Write tiles of a particle's map into a grid whose cells lie on the maps' cells.

        Args:
            particle: Whose map.
            wanted: Which tiles ``(tile rows, tile columns)``.
            grid: Changed in place; what lies outside of it is left out.
            occupied_share: A cell is occupied when hits make up more than this share of its visits.
            occupied: The log odds of an occupied cell.
            free: The log odds of a free cell.
        """
        from_anchor = np.round((grid.origin - self.anchor) / self.resolution).astype(np.int64)
        draw_tiles(
            grid.log_odds,
            (self.corner - from_anchor)[::-1].copy(),
            self.tables[particle],
            wanted,
            self.hits,
            self.visits,
            occupied_share,
            np.float32(occupied),
            np.float32(free),
        )

    def _reserve(self, tiles: int) -> None:
        """See to it that so many tiles are unused, and empty before they are taken."""
        if self._free_count >= tiles:
            return
        old = len(self.references)
        new = max(int(old * POOL_GROWTH), old + tiles)
        for name in ("hits", "visits", "means", "full", "references"):
            array = getattr(self, name)
            grown = np.zeros((new, *array.shape[1:]), dtype=array.dtype)
            grown[:old] = array
            setattr(self, name, grown)
        stack = np.zeros(new, dtype=np.int32)
        stack[: new - old] = np.arange(new - 1, old - 1, -1)
        stack[new - old : new - old + self._free_count] = self._free_tiles[: self._free_count]
        self._free_tiles = stack
        self._free_count += new - old

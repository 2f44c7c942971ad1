"""Finds poles: legs of chairs and tables, posts, all that a beam or two of a scan meet.

Cells cannot tell of them. A leg of 3 cm is met by one or two beams of an LDS-01 from 1.5 m, and by
half of the scans from 3 m, whose readings scatter over more cells than it covers: each of these is
seen free far more often than occupied. Readings taken together can. Those that stand alone in their
scan, with free space to both sides, gather around a pole; then every scan that looked at such a
place is asked whether any beam met something there, as a filter of a place that is taken or free
(Probabilistic Robotics 4.2) in which the scans come in turn, so that who has left is gone. How many
of the beams did tells how thick the pole is.

The settings were chosen on runs in cluttered_office, a hall with walking people and the Intel
Research Lab log.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import KDTree

from mapping.aimed_beams import AimedBeams
from mapping.grid import OCCUPIED, OccupancyGrid
from mapping.ogm import OgmConfig
from mapping.pole_kernels import belief, lone_hits, looks_at

THICKEST = 0.1
"""What is wider is no pole [m]: cells tell of it well."""

GAP, GAP_SIGMAS = 0.06, 3.0
"""Beams beside a pole go this much farther [m] and so many standard deviations of the difference:
sharp corners of boxes stand alone in few scans."""

NEAR = 0.06
"""Readings this near to a pole's middle [m] are of it: twice the scatter of an LDS-01 at 2 m."""

SIGHTINGS = 3
"""So many readings that stand alone make a place worth a look."""

HALF_WIDTH = 0.08
"""A beam that passes this near to a place's middle [m] tells of it: more than half the thickest
pole, so that what is thicker shows."""

DENSE = 0.06
"""Scans are asked about places so near that their beams are this close to one another there [m]."""

TOLERANCE, TOLERANCE_SIGMAS = 0.05, 3.0
"""A beam met what stands there if it ends this near [m] and so many standard deviations."""

MISTAKEN = 0.05
"""A scan sees what is not there, or not what is there, this often, however near it is."""

THINNEST = 0.02
"""A pole is taken for as thick as this [m] at least where scans are asked whether it is there."""

LOWEST, HIGHEST = -4.0, 6.0
"""Clamps of the log odds that somewhere is a pole: four near scans through it, and it is gone."""

SURE = 2.5
"""Log odds from which on it is drawn: one scan that saw it is not enough."""

STAYED = 0.6
"""After the first scan that met it, a pole was believed to be there after this share of them. Where
people walk by again and again it is a third at most, of legs that stand nine tenths."""

WALL = 0.15
"""What the map shows that is longer than this [m] is no pole."""


class PoleFinder:
    """Takes all scans of a finished map twice, then draws the poles that they saw."""

    def __init__(self) -> None:
        self._sightings: list[NDArray[np.float64]] = []
        self._places: NDArray[np.float64] = np.zeros((0, 2))
        self._directions: NDArray[np.float64] = np.zeros((0, 2))
        self._looks: list[NDArray[np.float64]] = []
        self._tree = KDTree(self._places)

    def spot(self, beams: AimedBeams) -> None:
        """Take one scan the first time: note what stands alone in it."""
        found = lone_hits(
            beams.origins,
            beams.directions,
            beams.lengths,
            beams.sigmas,
            beams.hits,
            beams.pairs,
            THICKEST,
            GAP,
            GAP_SIGMAS,
        )
        if len(found) > 0:
            self._sightings.append(found)

    def gather(self) -> int:
        """Tell how many places are worth a look, after all scans were spotted."""
        sightings = np.concatenate((np.zeros((0, 5)), *self._sightings))
        tree = KDTree(sightings[:, :2])
        counts = np.asarray(tree.query_ball_point(sightings[:, :2], NEAR, return_length=True))
        is_taken = counts < SIGHTINGS
        places: list[NDArray[np.float64]] = []
        directions: list[NDArray[np.float64]] = []
        for index in np.argsort(-counts, kind="stable"):
            if is_taken[index]:
                continue
            place = sightings[index, :2]
            for _ in range(2):
                own = tree.query_ball_point(place, NEAR)
                weights = sightings[own, 4] ** -2.0
                place = np.average(sightings[own, :2], axis=0, weights=weights)
            is_taken[tree.query_ball_point(place, THICKEST)] = True
            if any(math.dist(place, other) < THICKEST for other in places):
                continue
            places.append(place)
            directions.append(np.average(sightings[own, 2:4], axis=0, weights=weights))
        self._places = np.array(places).reshape(-1, 2)
        self._directions = np.array(directions).reshape(-1, 2)
        self._tree = KDTree(self._places)
        return len(places)

    def look(self, beams: AimedBeams) -> None:
        """Take one scan the second time, oldest first: note what it says of each place."""
        near = self._tree.query_ball_point(beams.origins.mean(axis=0), DENSE / beams.increment)
        if near:
            looks = looks_at(
                self._places,
                np.array(near, dtype=np.int64),
                beams.origins,
                beams.directions,
                beams.lengths,
                beams.sigmas,
                beams.hits,
                HALF_WIDTH,
                TOLERANCE,
                TOLERANCE_SIGMAS,
            )
            self._looks.append(looks)

    def write(self, grid: OccupancyGrid, config: OgmConfig) -> None:
        """Draw the poles as discs, in place of what the map shows there but walls.

        Args:
            grid: Its surfaces must have been moved already.
            config: How it was drawn.
        """
        walls = _walls(grid)
        looks = np.concatenate((np.zeros((0, 3)), *self._looks))
        for number, place in enumerate(self._places):
            told, met = looks[looks[:, 0] == number, 1:].T
            if told.sum() == 0.0:
                continue
            thickness = 2.0 * HALF_WIDTH * met.sum() / told.sum()
            chances = told * max(thickness, THINNEST) / (2.0 * HALF_WIDTH)
            odds, stayed = belief(met > 0.0, chances, MISTAKEN, LOWEST, HIGHEST)
            if odds > SURE and stayed > STAYED and thickness < THICKEST:
                # where beams meet a cylinder lies pi / 8 of its thickness before its middle
                middle = place + math.pi / 8.0 * thickness * self._directions[number]
                _draw(grid, config, walls, middle, thickness)


def _walls(grid: OccupancyGrid) -> NDArray[np.bool_]:
    """The occupied cells of what is too long to be a pole."""
    occupied = grid.states() == OCCUPIED
    labels, count = ndimage.label(occupied, np.ones((3, 3)))
    is_long = np.zeros(count + 1, dtype=np.bool_)
    for label, (rows, columns) in enumerate(ndimage.find_objects(labels), 1):
        size = max(rows.stop - rows.start, columns.stop - columns.start)
        is_long[label] = size * grid.resolution > WALL
    walls: NDArray[np.bool_] = is_long[labels]
    return walls


def _draw(
    grid: OccupancyGrid,
    config: OgmConfig,
    walls: NDArray[np.bool_],
    middle: NDArray[np.float64],
    thickness: float,
) -> None:
    """Draw one pole, unless a wall is so near that it may be of that."""
    around = grid.world_to_cell(middle)
    reach = math.ceil((NEAR + 0.5 * thickness) / grid.resolution)
    offsets = np.arange(-reach, reach + 1)
    rows, columns = np.meshgrid(around[0] + offsets, around[1] + offsets, indexing="ij")
    cells = np.stack((rows.ravel(), columns.ravel()), axis=1)
    cells = cells[grid.contains(cells)]
    gaps = np.linalg.norm(grid.cell_to_world(cells) - middle, axis=1)
    cells, gaps = cells[gaps <= reach * grid.resolution], gaps[gaps <= reach * grid.resolution]
    rows, columns = cells.T
    if np.any(walls[rows, columns]):
        return
    values = grid.log_odds[rows, columns]
    values[values > grid.config.occupied_above] = config.lowest
    is_pole = (gaps <= 0.5 * thickness) | np.all(cells == around, axis=1)
    values[is_pole] = config.highest
    grid.log_odds[rows, columns] = values

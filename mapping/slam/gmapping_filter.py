"""GMapping's particle filter: turns scans and steps into paths, each with the map it implies."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.filters.resampling import effective_number, low_variance_sample, normalised
from mapping.geometry import Pose, transform_points
from mapping.slam.gmapping_config import GmappingConfig
from mapping.slam.gmapping_kernels import gather_full, match_particles, sample_fits
from mapping.slam.gmapping_motion import sample_motion
from mapping.slam.gmapping_scan import BaseBeams
from mapping.slam.particle_paths import ParticlePaths
from mapping.slam.tile_map import TileMaps
from mapping.slam.tile_map_kernels import TILE_CELLS

FULL_SHARE = 0.1
"""A cell is matched with when more than this share of its beams ended in it (GMapping's
fullnessThreshold)."""

LOST_SQUARED = 0.5
"""A beam that finds no cell weighs as one whose squared distance is this [m2] under a variance of
CLASSIC_VARIANCE [m2] (GMapping's nullLikelihood, lsigma)."""

CLASSIC_VARIANCE = 0.075

TINY_VARIANCE = 1e-12
"""Added to sampled variances, which are 0 where one sample has all the likelihood."""


class GmappingFilter:
    """The particles; ``update`` is the paper's algorithm 1 in the order of its lines."""

    def __init__(self, config: GmappingConfig, pose_map: Pose, anchor: ArrayLike) -> None:
        """Start every particle at a pose ``(3,)``; cells are counted from a corner [m] ``(2,)``."""
        self.config = config
        self.maps = TileMaps(config.particles, config.delta, anchor, FULL_SHARE)
        self.poses_map: Pose = np.tile(pose_map, (config.particles, 1))
        self.paths = ParticlePaths(self.poses_map)
        self.best = 0
        """The particle whose path explains all scans best."""
        self.resamplings = 0
        self._rng = np.random.default_rng(config.seed)
        self._log_weights = np.zeros(config.particles)
        self._log_likelihoods = np.zeros(config.particles)

    def predict(self, step: Pose) -> None:
        """Move the particles by the robot's step ``(3,)`` and a guess of its error each."""
        config = self.config
        self.poses_map = sample_motion(
            self.poses_map,
            step,
            srr=config.srr,
            srt=config.srt,
            str_=config.str,
            stt=config.stt,
            normals=self._rng.standard_normal((config.particles, 3)),
        )

    def start(self, pose_map: Pose, beams: BaseBeams) -> None:
        """Put every particle at a pose ``(3,)`` and the first scan into the map of all."""
        self.poses_map = np.tile(pose_map, (self.config.particles, 1))
        self.paths.extend(self.poses_map)
        self._cover(beams)
        self.maps.write(0, pose_map, beams.origins, beams.ends, beams.is_hit)
        self.maps.resample(np.zeros(self.config.particles, dtype=np.intp))

    def update(self, beams: BaseBeams) -> tuple[bool, NDArray[np.bool_]]:
        """Match a scan, weigh, resample and draw it.

        Returns:
            Whether the best particle's map is another's than before, and which of its tiles the
            scan changed ``(tile rows, tile columns)``.
        """
        self._match(beams)
        parents = self._survivors()
        best = int(np.argmax(self._log_likelihoods))
        is_other = bool(parents[best] != self.best)
        self.best = best
        self.paths.extend(self.poses_map)
        self._cover(beams)
        for particle, pose in enumerate(self.poses_map):
            written = self.maps.write(particle, pose, beams.origins, beams.ends, beams.is_hit)
            if particle == best:
                changed = written
        return is_other, changed

    def _match(self, beams: BaseBeams) -> None:
        """Put every particle where the scan fits its map, and weigh how well it does."""
        config, maps = self.config, self.maps
        points = beams.points(config.delta, config.lskip)
        poses, fits = match_particles(
            maps.in_cells(self.poses_map),
            points,
            (config.lstep / config.delta, config.astep),
            config.iterations,
            config.kernelSize,
            0.5 * (config.delta / config.sigma) ** 2,
            config.minimumScore,
            maps.tables,
            maps.means,
            maps.full,
        )
        logs = self._log_likelihood(fits[:, 1:])
        if config.sample_proposal:
            for particle in np.flatnonzero(fits[:, 0] > config.minimumScore):
                poses[particle], logs[particle] = self._propose(
                    int(particle), poses[particle], points
                )
        self.poses_map = maps.in_map(poses)
        self._log_weights += logs
        self._log_likelihoods += logs

    def _log_likelihood(self, found: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of scans, from their squared distances [cells2] and lost beams ``(n, 2)``."""
        per_square = 0.5 * (self.config.delta / self.config.lsigma) ** 2
        logs = -per_square * found[:, 0] - LOST_SQUARED / CLASSIC_VARIANCE * found[:, 1]
        return np.asarray(logs)

    def _propose(
        self, particle: int, pose: Pose, points: NDArray[np.float64]
    ) -> tuple[Pose, float]:
        """Draw from the Gaussian around a match, and tell its log weight (paper, eq. 13 to 18).

        The motion model is taken as constant there, the paper's second simplification.
        """
        config, maps = self.config, self.maps
        linear = _steps(config.llsamplerange, config.llsamplestep) / config.delta
        angular = _steps(config.lasamplerange, config.lasamplestep)
        offsets = np.stack(np.meshgrid(linear, linear, angular), axis=-1).reshape(-1, 3)
        table = maps.tables[particle]
        bits = np.empty((table.shape[0] * TILE_CELLS, table.shape[1] + 1), dtype=np.uint32)
        gather_full(table, maps.full, bits)
        found = sample_fits(pose, offsets, points, config.kernelSize, bits, table, maps.means)
        logs = self._log_likelihood(found)
        weights = normalised(logs)
        mean = weights @ offsets
        apart = offsets - mean
        covariance = (weights * apart.T) @ apart + TINY_VARIANCE * np.eye(3)
        drawn = np.linalg.cholesky(covariance) @ self._rng.standard_normal(3)
        return np.asarray(pose + mean + drawn), float(logs.max() - np.log(weights.max()))

    def _survivors(self) -> NDArray[np.intp]:
        """Resample when few particles carry the weight; tell whose child each particle is now."""
        config = self.config
        weights = normalised(self._log_weights / (config.ogain * config.particles))
        if effective_number(weights) >= config.resampleThreshold * config.particles:
            return np.arange(config.particles)
        parents = low_variance_sample(weights, config.particles, self._rng.random())
        self.resamplings += 1
        self.maps.resample(parents)
        self.paths.resample(parents)
        self.poses_map = self.poses_map[parents]
        self._log_likelihoods = self._log_likelihoods[parents]
        self._log_weights = np.zeros(config.particles)
        return parents

    def _cover(self, beams: BaseBeams) -> None:
        """Make room in the maps for the scan as every particle sees it."""
        self.bounds = self._bounds(beams)
        self.maps.cover(*self.bounds)

    def _bounds(self, beams: BaseBeams) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the scan as every particle sees it [m]."""
        points = np.vstack((beams.origins, beams.ends))
        seen = np.array([transform_points(pose, points) for pose in self.poses_map])
        left, bottom = seen.min(axis=(0, 1))
        right, top = seen.max(axis=(0, 1))
        return float(left), float(right), float(bottom), float(top)


def _steps(reach: float, step: float) -> NDArray[np.float64]:
    """From -reach to reach in steps, 0 among them."""
    count = int(reach / step + 0.5)
    return step * np.arange(-count, count + 1, dtype=np.float64)

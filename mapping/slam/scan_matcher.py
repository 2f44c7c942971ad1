"""Finds the pose from which a scan was taken: correlative search, then Newton's method to sub-cell.

The search (Olson 2009) looks at every pose within the prediction's uncertainty, so that no bad
start leads astray; Newton's method on the log likelihood, with the prediction as prior, then finds
the top between the cells. What a scan cannot tell, as where along a bare corridor it was taken, is
left to the prediction, and the covariance says so.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi
from mapping.slam.climb_kernels import climb
from mapping.slam.correlative_search import search_window
from mapping.slam.fuse_kernel import fuse, scan_information
from mapping.slam.hit_field import HitField
from mapping.slam.matrix_kernels import inverse3
from mapping.slam.scan_cloud import ScanCloud

LEEWAY, LEEWAY_SIGMAS = np.diag(np.square([0.03, 0.03, 0.01])), 3.0
"""What the prediction may err more than it says [m^2, m^2, rad^2] while a scan is heard, and how
many times as much as it says: else one that is too sure of itself would never be found out."""

SHARPEST = np.diag(np.square([0.002, 0.002, 0.001]))
"""No scan says better than this where it was taken [m^2, m^2, rad^2]."""

SURPRISING = 11.3
"""A scan this far from the prediction, in squared standard deviations, was predicted wrongly: one
in a hundred lies farther out (chi-square, three degrees of freedom)."""

SLIP = np.diag(np.square([0.1, 0.1, 0.1]))
"""Covariance of what odometry may do at any time, however sure it is [m^2, m^2, rad^2]: wheels spin
on a sill, a cart is pushed, messages are lost."""

NOTHING_TOLD = 1.0
"""Information along each axis [1/m^2, 1/m^2, 1/rad^2] of a scan that tells nothing."""

ANYWHERE = np.eye(3)
"""The covariance that goes with it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MatcherConfig:
    """How scans are matched.

    Chosen on logs simulated in lim_room, turtlebot3_world, lim_hallway and corridor_loop, and on
    the Intel Research Lab log with its readings jittered by millimetres.
    """

    togetherness: float = 3.0
    """So many readings count as one: those of one wall err together."""
    least_curvature: float = 0.007
    """Least information per reading [1/cells^2] for a direction to be believed at all; a wall that
    stands across gives about 0.5 for each reading on it."""
    least_score: float = 0.35
    """A match that explains a smaller share of the scan is refused."""
    least_points: int = 20
    """A scan with fewer points is refused: a wall or two could lie anywhere."""
    sure_score: float = 0.6
    """A scan that contradicts the prediction is believed if it explains this share of itself."""
    sure_points: int = 60
    """And has so many points."""
    sharp_start: float = 1.0
    """A prediction this sure [cells, one standard deviation at the end of a typical beam] needs no
    search."""
    search_sigmas: float = 3.0
    """How many standard deviations of the prediction are searched."""
    widest_shift: float = 0.6
    """The search goes no farther than this [m]."""
    widest_turn: float = 0.5
    """Nor farther than this [rad]."""
    second_look: float = 5.0
    """How many times as far ``match_twice`` searches for a scan that was not found, or poorly:
    odometry that slipped once errs by far more than it says."""
    better: float = 0.15
    """What is found there must explain so much more of the scan."""

    def __post_init__(self) -> None:
        """Refuse figures that make no matcher."""
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise TestbedError(f"matcher {name}: {value}; must be a finite number above 0")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Match:
    """What matching a scan gave."""

    pose: Pose
    """The pose ``(3,)``; the prediction when the match was refused."""
    covariance: NDArray[np.float64]
    """Its covariance ``(3, 3)`` over x [m], y [m], yaw [rad]; the prediction's when refused, and
    along a direction that the scan tells nothing about."""
    score: float
    """Share of the scan that lies on known walls, 0..1."""
    refused: bool
    """Whether the scan told nothing that could be believed."""
    seen: Pose
    """The pose that the scan alone asks for ``(3,)``, the yaw not wrapped."""
    seen_covariance: NDArray[np.float64]
    """How far that is to be trusted ``(3, 3)``."""


def match_scan(
    field: HitField,
    cloud: ScanCloud,
    predicted: ArrayLike,
    covariance: NDArray[np.float64],
    config: MatcherConfig,
) -> Match:
    """Match a scan with a field.

    Args:
        field: The field.
        cloud: The scan.
        predicted: Where it is thought to have been taken ``(3,)``, in the frame of the field.
        covariance: How sure that is ``(3, 3)``.
        config: How to match.
    """
    predicted = np.asarray(predicted, dtype=np.float64)
    refused = Match(
        pose=predicted,
        covariance=covariance,
        score=0.0,
        refused=True,
        seen=predicted,
        seen_covariance=ANYWHERE,
    )
    if len(cloud) < config.least_points:
        return refused
    points = cloud.points / field.resolution
    prior = field.to_cells(predicted)
    start = prior
    if _uncertainty(covariance, points, field.resolution) > config.sharp_start:
        start = _searched(field, cloud, prior, covariance, config)
    scale = np.array([field.resolution, field.resolution, 1.0])
    pose, curvature, scatter, score = climb(
        field.density,
        start,
        prior,
        inverse3(LEEWAY_SIGMAS**2 * covariance + LEEWAY) * np.outer(scale, scale),
        points,
        cloud.normals,
        cloud.weights,
        field.outlier,
        config.least_curvature,
    )
    if score < config.least_score or not curvature.any():
        return replace(refused, score=score)
    seen = field.to_metres(pose)
    per_metre = np.outer(1.0 / scale, 1.0 / scale)
    told = scan_information(
        curvature * per_metre, scatter * per_metre * config.togetherness, SHARPEST
    )
    offset = seen - predicted
    offset[2] = wrap_to_pi(offset[2])
    found, fused, seen_covariance, surprise = fuse(
        predicted, covariance, offset, told, NOTHING_TOLD, SURPRISING
    )
    is_sure = score >= config.sure_score and len(cloud) >= config.sure_points
    if surprise > 1.0 and not is_sure:
        return replace(refused, score=score)
    found[2] = wrap_to_pi(found[2])
    return Match(
        pose=found,
        covariance=fused,
        score=score,
        refused=False,
        seen=predicted + offset,
        seen_covariance=seen_covariance,
    )


def match_twice(
    field: HitField,
    cloud: ScanCloud,
    predicted: ArrayLike,
    covariance: NDArray[np.float64],
    config: MatcherConfig,
) -> Match:
    """Match a scan as ``match_scan`` does; look farther away if little of it was found.

    Of eight copies of the Intel Research Lab log whose odometry errs by a quarter of each turn and
    a tenth of each way, single scans refused spoilt seven maps, by up to 29 m; so two. What the
    second look finds is believed only if it is sure and explains much more: of a place that has
    changed no pose explains much.
    """
    first = match_scan(field, cloud, predicted, covariance, config)
    is_good = not first.refused and first.score >= config.sure_score
    if is_good or len(cloud) < config.sure_points:
        return first
    wide = config.second_look**2 * covariance + SLIP
    second = match_scan(field, cloud, predicted, wide, config)
    least = max(config.sure_score, first.score + config.better)
    return first if second.refused or second.score < least else second


def weighed_anew(
    match: Match, predicted: ArrayLike, covariance: NDArray[np.float64]
) -> tuple[Pose, NDArray[np.float64]]:
    """What a match says against another prediction: the pose ``(3,)`` and its covariance.

    A match found by a wide search was told to stay near what was found. Where the scan says
    nothing, as along a wall, not that but what is known otherwise counts.

    Args:
        match: A match that was not refused.
        predicted: What is known otherwise ``(3,)``.
        covariance: How sure that is ``(3, 3)``.
    """
    predicted = np.asarray(predicted, dtype=np.float64)
    told = inverse3(match.seen_covariance) - NOTHING_TOLD * np.eye(3)
    offset = match.seen - predicted
    offset[2] = wrap_to_pi(offset[2])
    pose, fused, _, _ = fuse(predicted, covariance, offset, told, NOTHING_TOLD, SURPRISING)
    pose[2] = wrap_to_pi(pose[2])
    return pose, fused


def _uncertainty(
    covariance: NDArray[np.float64], points: NDArray[np.float64], resolution: float
) -> float:
    """Standard deviation [cells] of where a typical beam ends."""
    arm = float(np.hypot(points[:, 0], points[:, 1]).mean())
    along = 0.5 * (covariance[0, 0] + covariance[1, 1]) / resolution**2
    return math.sqrt(along + arm**2 * covariance[2, 2])


def _searched(
    field: HitField,
    cloud: ScanCloud,
    prior: NDArray[np.float64],
    covariance: NDArray[np.float64],
    config: MatcherConfig,
) -> NDArray[np.float64]:
    """The best pose of the search, in cells; the prior itself when nothing matches."""
    sigma_shift = math.sqrt(max(covariance[0, 0], covariance[1, 1]))
    sigma_turn = math.sqrt(covariance[2, 2])
    shift = min(config.search_sigmas * sigma_shift, config.widest_shift)
    turn = min(config.search_sigmas * sigma_turn, config.widest_turn)
    return search_window(field, cloud, prior, shift, turn).pose

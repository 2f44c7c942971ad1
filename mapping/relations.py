"""Scores a trajectory without a true map: by relative poses that were checked by hand.

The metric of Kümmerle et al. 2009, "On measuring the accuracy of SLAM algorithms". Each relation
tells how the robot at one moment stood to where it was at another, mostly when it came back to a
place, so that a map bent in between shows, wherever it lies as a whole.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, between
from mapping.trajectory import Trajectory

STAMP_TOLERANCE = 0.002
"""A pose belongs to a relation's stamp when the two are this near [s]; files round stamps."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relations:
    """True relative poses between pairs of moments."""

    stamps: NDArray[np.float64]
    """The two moments of each relation ``(n, 2)`` [s]."""
    poses: Pose
    """The pose at the second moment seen from the one at the first ``(n, 3)``."""

    def __post_init__(self) -> None:
        """Refuse what makes no relations."""
        if self.stamps.shape != (len(self.stamps), 2) or self.poses.shape != (len(self.stamps), 3):
            raise TestbedError(
                f"relations: {self.stamps.shape} stamps and {self.poses.shape} poses; "
                "must be (n, 2) and (n, 3)"
            )
        if not (np.all(np.isfinite(self.stamps)) and np.all(np.isfinite(self.poses))):
            raise TestbedError("relations: a stamp or pose is not finite; all must be")


@dataclass(frozen=True, slots=True, kw_only=True)
class RelationScores:
    """How far a trajectory disagrees with the relations; None when none could be used."""

    used: int
    """Relations whose two moments are both in the trajectory."""
    trans_mean_m: float | None
    """Mean error of the translation between the two poses [m]."""
    trans_std_m: float | None
    """Standard deviation of the same [m]."""
    trans_max_m: float | None
    """The largest of them [m]."""
    rot_mean_deg: float | None
    """Mean error of the rotation between the two poses [deg]."""
    rot_std_deg: float | None
    """Standard deviation of the same [deg]."""
    rot_max_deg: float | None
    """The largest of them [deg]."""


def score_relations(trajectory: Trajectory, relations: Relations) -> RelationScores:
    """Compare the relative poses of a trajectory with the true ones."""
    first, second, usable = match_relations(trajectory.stamps, relations)
    if not usable.any():
        return RelationScores(
            used=0,
            trans_mean_m=None,
            trans_std_m=None,
            trans_max_m=None,
            rot_mean_deg=None,
            rot_std_deg=None,
            rot_max_deg=None,
        )
    estimated = between(trajectory.poses[first[usable]], trajectory.poses[second[usable]])
    errors = between(relations.poses[usable], estimated)
    distances = np.hypot(errors[:, 0], errors[:, 1])
    turns = np.degrees(np.abs(errors[:, 2]))
    return RelationScores(
        used=int(usable.sum()),
        trans_mean_m=float(distances.mean()),
        trans_std_m=float(distances.std()),
        trans_max_m=float(distances.max()),
        rot_mean_deg=float(turns.mean()),
        rot_std_deg=float(turns.std()),
        rot_max_deg=float(turns.max()),
    )


def match_relations(
    stamps: NDArray[np.float64], relations: Relations
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """Which poses belong to each relation's two moments, and whether both do.

    Args:
        stamps: Stamps of the poses ``(n,)`` [s], ascending.
        relations: The relations ``(m,)``.

    Returns:
        Place of the pose nearest to the first moment and to the second, and whether both are
        within STAMP_TOLERANCE, each ``(m,)``.
    """
    if len(stamps) == 0:
        nowhere = np.zeros(len(relations.stamps), dtype=np.int64)
        return nowhere, nowhere, np.zeros(len(nowhere), dtype=np.bool_)
    above = np.clip(np.searchsorted(stamps, relations.stamps), 1, max(len(stamps) - 1, 1))
    below = above - 1
    above = np.minimum(above, len(stamps) - 1)
    to_below = np.abs(relations.stamps - stamps[below])
    to_above = np.abs(stamps[above] - relations.stamps)
    nearest = np.where(to_below <= to_above, below, above)
    usable = np.all(np.minimum(to_below, to_above) <= STAMP_TOLERANCE, axis=1)
    return nearest[:, 0], nearest[:, 1], usable

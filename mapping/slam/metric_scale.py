"""Tells how far the lidar's metre is off, from how its map and the wheels' odometry disagree.

A lidar whose ranges are all too long sees a perfectly consistent building that is too large. Only
the wheels know another metre. Neither is exact: what they disagree by is shared between them as
their errors are likely.
"""

import math
from dataclasses import dataclass

import numpy as np

from mapping.errors import TestbedError
from mapping.geometry import Pose


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricScaleConfig:
    """How far each metre may be off; standard deviations of relative errors."""

    wheel_sigmas: tuple[float, ...] = (0.005, 0.015, 0.1)
    """Of the way: of wheels whose radius was measured (the tyre of a Burger gives by 0.16 mm of
    33 mm under load), of worn or soft ones, of ones of which nothing is known [assumptions]."""
    wheel_shares: tuple[float, ...] = (0.5, 0.45, 0.05)
    """How likely each of these is [assumption]."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors or no shares."""
        sigmas, shares = self.wheel_sigmas, self.wheel_shares
        if not (sigmas and all(math.isfinite(sigma) and sigma > 0.0 for sigma in sigmas)):
            raise TestbedError(f"metric scale wheel_sigmas: {sigmas}; must be finite and above 0")
        if len(shares) != len(sigmas) or not all(0.0 <= share <= 1.0 for share in shares):
            raise TestbedError(
                f"metric scale wheel_shares: {shares}; must be a number from 0 to 1 for each sigma"
            )


def lidar_scale_error(
    disagreement: float, uncertainty: float, lidar_sigma: float, config: MetricScaleConfig
) -> float:
    """The relative error of the lidar's ranges to expect, positive for ranges that are too long.

    All errors are taken as Gaussian, those of the wheels as a mixture of such; the answer is
    the posterior mean (Bishop 2006, 2.3.3 and 2.3.9).

    Args:
        disagreement: How much longer a way is by matched scans than by the odometry, relative.
        uncertainty: Variance of the disagreement.
        lidar_sigma: Standard deviation of the lidar's own relative error; 0 trusts it.
        config: What is known of the wheels.
    """
    lidar = lidar_sigma**2
    mean, evidence = 0.0, 0.0
    for share, wheels in zip(config.wheel_shares, config.wheel_sigmas, strict=True):
        variance = lidar + wheels**2 + uncertainty
        likelihood = share * math.exp(-0.5 * disagreement**2 / variance) / math.sqrt(variance)
        mean += likelihood * disagreement * lidar / variance
        evidence += likelihood
    return mean / evidence if evidence > 0.0 else 0.0


def scaled(poses: Pose, scale: float) -> Pose:
    """Relative poses ``(..., 3)`` with their ways made longer or shorter."""
    return np.asarray(poses * (scale, scale, 1.0))


def grown(poses: Pose, fixed: Pose, scale: float) -> Pose:
    """Poses ``(n, 3)`` as they lie when everything grows about a pose ``(1, 3)``; or ``(0, 3)``."""
    if len(fixed) == 0:
        return poses.copy()
    return np.column_stack((fixed[:, :2] + scale * (poses[:, :2] - fixed[:, :2]), poses[:, 2]))

"""Turns viewpoints into the one to drive to next: newly seen area per second of the way."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mapping.geometry import Pose, wrap_to_pi
from nav.frontier import Viewpoint


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionConfig:
    """What a viewpoint's worth is weighed by."""

    speed: float = 0.2
    """Speed that costs are turned into time with [m/s]."""
    turn_speed: float = 1.2
    """Turn rate that the first turn is turned into time with [rad/s]."""
    settling_time: float = 3.0
    """Time every viewpoint costs, however near [s]; else crumbs at hand beat rooms ahead."""
    gain_cap: float = 4.0
    """Area beyond which more does not count [m2]: guesses about far space are mostly wrong."""
    loyalty: float = 1.4
    """How many times better another frontier must be to be turned to: no oscillation."""
    same_frontier: float = 0.6
    """Frontiers this close to each other count as the same one [m]."""


def choose(
    viewpoints: Sequence[Viewpoint],
    pose: Pose,
    current: Viewpoint | None,
    config: DecisionConfig,
) -> Viewpoint | None:
    """The viewpoint with the most gain per second, the current frontier favoured; None of none."""
    if not viewpoints:
        return None
    return max(viewpoints, key=lambda viewpoint: _worth(viewpoint, pose, current, config))


def _worth(
    viewpoint: Viewpoint, pose: Pose, current: Viewpoint | None, config: DecisionConfig
) -> float:
    offset = viewpoint.place - pose[:2]
    turn = abs(float(wrap_to_pi(np.arctan2(offset[1], offset[0]) - pose[2])))
    time = config.settling_time + viewpoint.cost / config.speed + turn / config.turn_speed
    worth = min(viewpoint.gain, config.gain_cap) / time
    if current is not None:
        apart = np.hypot(*(viewpoint.frontier.middle - current.frontier.middle))
        worth *= config.loyalty if apart < config.same_frontier else 1.0
    return worth

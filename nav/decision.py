"""Turns viewpoints into the one to drive to next: the first of the tour that sees most soonest."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi
from nav.greedy_rules import GREEDY_RULES
from nav.planner import CostField
from nav.tour import best_order
from nav.viewpoint import Viewpoint

TOUR = "tour"
RULES = (TOUR, *GREEDY_RULES)

LEAST_TIME = 1.5
"""However loyal, no first leg counts for less [s]: half a settling time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionConfig:
    """What a viewpoint's worth is weighed by."""

    rule: str = TOUR
    """``tour``, or one of GREEDY_RULES, to compare with; the rest is for ``tour`` alone."""
    speed: float = 0.2
    """Speed that costs are turned into time with [m/s]."""
    turn_speed: float = 1.2
    """Turn rate that the first turn is turned into time with [rad/s]."""
    settling_time: float = 3.0
    """Time every viewpoint costs, however near: turning, braking, looking [s]."""
    gain_cap: float = 4.0
    """Area beyond which more does not count [m2]: guesses about far space are mostly wrong."""
    base_worth: float = 0.5
    """Worth of settling a frontier at all [m2]: what is left behind costs a way of its own."""
    loyalty: float = 4.0
    """Time by which another first leg must be better to be turned to [s]: no oscillation."""
    end_share: float = 1.0
    """What the end of the tour counts, as a share of all that is seen on it, beside when each part
    is seen: what would be left behind is taken along where that shortens the whole."""
    toured: int = 24
    """At most so many viewpoints are put in order, the best by worth per time."""

    def __post_init__(self) -> None:
        """Refuse figures that decide nothing."""
        if not (self.speed > 0.0 and self.turn_speed > 0.0 and self.settling_time > 0.0):
            raise TestbedError("decision: speed, turn_speed and settling_time must be above 0")
        if self.rule not in RULES:
            raise TestbedError(f"decision rule: {self.rule!r}; must be one of {', '.join(RULES)}")
        if not self.end_share >= 0.0:
            raise TestbedError(f"decision end_share: {self.end_share}; must be 0 or more")
        if self.toured < 1:
            raise TestbedError(f"decision toured: {self.toured}; must be at least 1")


def choose(
    viewpoints: Sequence[Viewpoint],
    field: CostField,
    pose: Pose,
    current: Viewpoint | None,
    config: DecisionConfig,
    loyalty: float = 1.0,
) -> Viewpoint | None:
    """The viewpoint that the rule chooses; None of none.

    The rule ``tour`` takes the first of the best tour over one viewpoint of each frontier.

    Args:
        viewpoints: Candidates, any number of a frontier.
        field: The cost field that their costs are from.
        pose: Where the robot is ``(3,)``.
        current: Where it is going, if anywhere; favoured.
        config: What is weighed how.
        loyalty: How many times the loyal one ``config`` asks to be to the current viewpoint.
    """
    if config.rule != TOUR:
        return GREEDY_RULES[config.rule](viewpoints, field, pose)
    best: dict[int, tuple[float, Viewpoint, float]] = {}
    for viewpoint in viewpoints:
        time = _first_leg(viewpoint, pose, current, config, loyalty)
        ratio = _worth(viewpoint, config) / time
        key = id(viewpoint.frontier)
        if key not in best or ratio > best[key][0]:
            best[key] = (ratio, viewpoint, time)
    if not best:
        return None
    leading = sorted(best.values(), key=lambda entry: -entry[0])[: config.toured]
    chosen = [viewpoint for _, viewpoint, _ in leading]
    first_legs = np.array([time for _, _, time in leading])
    weights = np.array([_worth(viewpoint, config) for viewpoint in chosen])
    legs = _legs(chosen, field) / config.speed + config.settling_time
    return chosen[int(best_order(first_legs, legs, weights, config.end_share)[0])]


def _worth(viewpoint: Viewpoint, config: DecisionConfig) -> float:
    return config.base_worth + min(viewpoint.gain, config.gain_cap)


def _first_leg(
    viewpoint: Viewpoint,
    pose: Pose,
    current: Viewpoint | None,
    config: DecisionConfig,
    loyalty: float,
) -> float:
    """Time to a viewpoint from here [s], less what loyalty to the current frontier is worth."""
    offset = viewpoint.place - pose[:2]
    turn = abs(float(wrap_to_pi(np.arctan2(offset[1], offset[0]) - pose[2])))
    time = config.settling_time + viewpoint.cost / config.speed + turn / config.turn_speed
    if current is not None and viewpoint.is_near(current):
        time = max(time - loyalty * config.loyalty, LEAST_TIME)
    return time


def _legs(viewpoints: Sequence[Viewpoint], field: CostField) -> NDArray[np.float64]:
    return field.costs_between(np.array([viewpoint.place for viewpoint in viewpoints]))

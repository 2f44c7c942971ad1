"""Turns viewpoints into the one to drive to next: the one that shows most for what it takes.

While there are rooms to find, a plan over what is known now is worth little: the next view changes
it. The rule ``tour`` makes such a plan all the same, to compare with. Taking what is close first is
what counts: what is left behind costs a way of its own.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi
from nav.greedy_rules import GREEDY_RULES, SHORTEST_WAY
from nav.loyalty import MOST
from nav.planner import CostField
from nav.tour import best_order
from nav.viewpoint import Viewpoint

GAIN_RATE, TOUR = "gain_rate", "tour"
RULES = (GAIN_RATE, TOUR, *GREEDY_RULES)


@dataclass(frozen=True, slots=True, kw_only=True)
class TourConfig:
    """What the viewpoints of a tour are weighed by."""

    speed: float = 0.2
    """Speed that costs are turned into time with [m/s]."""
    settling_time: float = 3.0
    """Time every viewpoint costs, however near [s]."""
    turn_speed: float = 1.2
    """Turn rate that the first turn is turned into time with [rad/s]."""
    loyalty: float = 4.0
    """Time by which another first leg must be better to be turned to [s]."""
    least_time: float = 1.5
    """However loyal, no first leg counts for less [s]: half a settling time."""
    most_gain: float = 4.0
    """Area beyond which more does not count [m2]: guesses about far space are mostly wrong."""
    base_worth: float = 0.5
    """Worth of settling a frontier at all [m2]: what is left behind costs a way of its own."""
    end_share: float = 1.0
    """What the end of the tour counts, as a share of all that is seen on it, beside when each part
    is seen: what would be left behind is taken along where that shortens the whole."""
    toured: int = 24
    """At most so many viewpoints are put in order, the best by worth per time."""

    def __post_init__(self) -> None:
        """Refuse figures that make no tour."""
        for name in ("speed", "settling_time", "turn_speed", "least_time"):
            if not getattr(self, name) > 0.0:
                raise TestbedError(f"tour {name}: {getattr(self, name)}; must be above 0")
        if not self.end_share >= 0.0:
            raise TestbedError(f"tour end_share: {self.end_share}; must be 0 or more")
        if self.toured < 1:
            raise TestbedError(f"tour toured: {self.toured}; must be at least 1")


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionConfig:
    """What a viewpoint's worth is weighed by."""

    rule: str = GAIN_RATE
    """``gain_rate``; or, to compare with, ``tour`` or one of GREEDY_RULES, which change their minds
    as they were made to, but stay with a goal once ``Loyalty`` is at its most: none goes to and fro
    until the battery is empty."""
    settling_way: float = 0.2
    """Way that every view counts for, however near [m, as costs]: a second of braking, looking."""
    turning_way: float = 0.17
    """Way that a radian of the first turn counts for [m, as costs]: at 0.2 m/s
    and 1.2 rad/s, braking and setting off again included."""
    most_gain: float = 6.0
    """Area beyond which more does not count [m2]: guesses about far space are mostly wrong."""
    loyalty: float = 0.3
    """How much less the way to where the robot is going counts [m, as costs], times what
    ``Loyalty`` tells: no oscillation."""
    tour: TourConfig = TourConfig()

    def __post_init__(self) -> None:
        """Refuse figures that decide nothing."""
        for name in ("settling_way", "most_gain"):
            if not getattr(self, name) > 0.0:
                raise TestbedError(f"decision {name}: {getattr(self, name)}; must be above 0")
        for name in ("turning_way", "loyalty"):
            if not getattr(self, name) >= 0.0:
                raise TestbedError(f"decision {name}: {getattr(self, name)}; must be 0 or more")
        if self.rule not in RULES:
            raise TestbedError(f"decision rule: {self.rule!r}; must be one of {', '.join(RULES)}")


def choose(
    viewpoints: Sequence[Viewpoint],
    field: CostField,
    pose: Pose,
    current: Viewpoint | None,
    config: DecisionConfig,
    loyalty: float = 1.0,
) -> Viewpoint | None:
    """The viewpoint that the rule chooses; None of none.

    Args:
        viewpoints: Candidates, any number of a frontier.
        field: The cost field that their costs are from.
        pose: Where the robot is and which way it drives ``(3,)``.
        current: Where it is going, if anywhere; favoured.
        config: What is weighed how.
        loyalty: How many times as loyal to the current viewpoint as usual; ``Loyalty`` tells.
    """
    if config.rule in GREEDY_RULES:
        kept = _kept(viewpoints, current) if loyalty >= MOST else None
        return kept or GREEDY_RULES[config.rule](viewpoints, field, pose)
    if config.rule == TOUR:
        times = _tour_times(viewpoints, pose, current, config.tour, loyalty)
        return _first_of_tour(viewpoints, times, field, config.tour)

    def rate(viewpoint: Viewpoint) -> float:
        turn = _first_turn(viewpoint, pose)
        way = config.settling_way + viewpoint.cost + config.turning_way * turn
        if current is not None and viewpoint.is_near(current):
            way -= loyalty * config.loyalty
        return min(viewpoint.gain, config.most_gain) / max(way, SHORTEST_WAY)

    return max(viewpoints, key=rate, default=None)


def _kept(viewpoints: Sequence[Viewpoint], current: Viewpoint | None) -> Viewpoint | None:
    """The best view of where the robot is going, if it is still worth going to."""
    near = (each for each in viewpoints if current is not None and each.is_near(current))
    return max(near, key=lambda each: each.gain, default=None)


def _first_turn(viewpoint: Viewpoint, pose: Pose) -> float:
    """How far the robot would turn to face a viewpoint [rad]."""
    x, y = viewpoint.place - pose[:2]
    return abs(float(wrap_to_pi(math.atan2(y, x) - pose[2])))


def _tour_times(
    viewpoints: Sequence[Viewpoint],
    pose: Pose,
    current: Viewpoint | None,
    tour: TourConfig,
    loyalty: float,
) -> list[float]:
    """Time to each viewpoint [s], less what loyalty to the current frontier is worth."""
    times = []
    for viewpoint in viewpoints:
        turn = _first_turn(viewpoint, pose)
        time = tour.settling_time + viewpoint.cost / tour.speed + turn / tour.turn_speed
        if current is not None and viewpoint.is_near(current):
            time = max(time - loyalty * tour.loyalty, tour.least_time)
        times.append(time)
    return times


def _first_of_tour(
    viewpoints: Sequence[Viewpoint], times: list[float], field: CostField, tour: TourConfig
) -> Viewpoint | None:
    """The first of the best tour over one viewpoint of each frontier."""
    best: dict[int, tuple[float, Viewpoint, float]] = {}
    for viewpoint, time in zip(viewpoints, times, strict=True):
        ratio = _worth(viewpoint, tour) / time
        key = id(viewpoint.frontier)
        if key not in best or ratio > best[key][0]:
            best[key] = (ratio, viewpoint, time)
    if not best:
        return None
    leading = sorted(best.values(), key=lambda entry: -entry[0])[: tour.toured]
    chosen = [viewpoint for _, viewpoint, _ in leading]
    first_legs = np.array([time for _, _, time in leading])
    weights = np.array([_worth(viewpoint, tour) for viewpoint in chosen])
    legs = _legs(chosen, field) / tour.speed + tour.settling_time
    return chosen[int(best_order(first_legs, legs, weights, tour.end_share)[0])]


def _worth(viewpoint: Viewpoint, tour: TourConfig) -> float:
    return tour.base_worth + min(viewpoint.gain, tour.most_gain)


def _legs(viewpoints: Sequence[Viewpoint], field: CostField) -> NDArray[np.float64]:
    return field.costs_between(np.array([viewpoint.place for viewpoint in viewpoints]))

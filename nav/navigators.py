"""The navigators by name."""

from collections.abc import Callable
from functools import partial

from numpy.typing import ArrayLike

from mapping.errors import TestbedError
from nav.decision import GAIN_RATE, RULES, DecisionConfig
from nav.explorer import FrontierExplorer
from nav.explorer_config import ExplorerConfig
from nav.navigator import Navigator
from nav.reactive import Reactive
from nav.waypoints import Waypoints

WAYPOINTS = "waypoints"
"""The navigator that needs to be told where to go."""


def _explorer_by(rule: str) -> FrontierExplorer:
    """The explorer with a decision rule that it is compared with."""
    return FrontierExplorer(ExplorerConfig(decision=DecisionConfig(rule=rule)))


NAVIGATORS: dict[str, Callable[..., Navigator]] = {
    "frontier": FrontierExplorer,
    **{rule: partial(_explorer_by, rule) for rule in RULES if rule != GAIN_RATE},
    "reactive": Reactive,
    WAYPOINTS: Waypoints,
}


def make_navigator(name: str, waypoints: ArrayLike | None = None) -> Navigator:
    """A fresh navigator.

    Args:
        name: One of NAVIGATORS.
        waypoints: Places ``(n, 2)`` in the map frame [m]: for ``waypoints``, and for no other.

    Raises:
        TestbedError: There is none of that name, or waypoints are missing, wrong or not wanted.
    """
    if name not in NAVIGATORS:
        raise TestbedError(f"navigator: {name!r}; must be one of {', '.join(NAVIGATORS)}")
    if name == WAYPOINTS:
        if waypoints is None:
            raise TestbedError(f"waypoints: none; navigator {name!r} needs one at least")
        return NAVIGATORS[name](waypoints)
    if waypoints is not None:
        raise TestbedError(f"waypoints: given; must not be with navigator {name!r}")
    return NAVIGATORS[name]()

"""The navigators by name."""

from collections.abc import Callable

from mapping.errors import TestbedError
from nav.explorer import FrontierExplorer
from nav.navigator import Navigator
from nav.reactive import Reactive

NAVIGATORS: dict[str, Callable[[], Navigator]] = {
    "frontier": FrontierExplorer,
    "reactive": Reactive,
}


def make_navigator(name: str) -> Navigator:
    """A fresh navigator.

    Raises:
        TestbedError: If there is none of that name.
    """
    if name not in NAVIGATORS:
        raise TestbedError(f"navigator: {name!r}; must be one of {', '.join(NAVIGATORS)}")
    return NAVIGATORS[name]()

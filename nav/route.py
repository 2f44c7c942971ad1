"""Turns the text of a route, ``x,y x,y ...``, into points."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError

FARTHEST = 1e4
"""The farthest a waypoint may lie from the origin [m], as floor plans have it."""


def parse_route(text: str) -> NDArray[np.float64]:
    """The points ``(n, 2)`` [m] of ``x,y x,y ...``.

    Raises:
        TestbedError: The text is no such list.
    """
    points = []
    for pair in text.split():
        try:
            x, y = pair.split(",")
            points.append((float(x), float(y)))
        except ValueError:
            raise TestbedError(
                f"waypoints: {pair!r}; must be x,y in metres, as in '1.5,0 3,-0.5'"
            ) from None
    return checked_route(points)


def checked_route(points: ArrayLike) -> NDArray[np.float64]:
    """Points as an array ``(n, 2)``, n >= 1, or one clear error."""
    route = np.array(points, dtype=np.float64).reshape(-1, 2)
    if len(route) == 0:
        raise TestbedError("waypoints: none; there must be one at least")
    if not np.all(np.abs(route) <= FARTHEST):  # NaN compares false
        raise TestbedError(f"waypoints: must be finite and {FARTHEST:g} m from the origin at most")
    return route

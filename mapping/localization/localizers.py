"""The localisers by name."""

from typing import Literal, get_args

from numpy.typing import ArrayLike

from mapping.errors import TestbedError
from mapping.localization.ekf_localizer import EkfLocalizer
from mapping.localization.histogram_localizer import HistogramLocalizer
from mapping.localization.known_map import KnownMap
from mapping.localization.localizer import Localizer
from mapping.localization.particle_localizer import ParticleLocalizer
from mapping.odometry_mapper import checked_pose

FilterName = Literal["particle", "histogram", "ekf"]


def check_localizer(name: str, *, knows_start: bool) -> None:
    """Refuse what ``make_localizer`` would, before a map is prepared.

    Raises:
        TestbedError: There is none of that name, or it needs a start and has none.
    """
    if name not in get_args(FilterName):
        raise TestbedError(f"filter: {name!r}; must be one of {', '.join(get_args(FilterName))}")
    if name == "ekf" and not knows_start:
        raise TestbedError(
            "start: uniform; must be known for filter ekf: one Gaussian cannot stand for all poses"
        )


def make_localizer(
    name: str, known: KnownMap, *, start: ArrayLike | None = None, seed: int = 0
) -> Localizer:
    """A fresh localiser.

    Args:
        name: One of FilterName.
        known: The map.
        start: The start pose ``(3,)`` if it is known; else all poses are equally likely.
        seed: Of the random numbers of ``particle``; the others draw none.

    Raises:
        TestbedError: As ``check_localizer``; or the start is no pose on the map, or the robot fits
            nowhere near it.
    """
    check_localizer(name, knows_start=start is not None)
    if start is not None:
        x, y, _ = checked_pose("start", start).tolist()
        if not known.holds(x, y):
            raise TestbedError(f"start: ({x:g}, {y:g}); must lie on the map, in its frame")
    if name == "particle":
        return ParticleLocalizer(known, start=start, seed=seed)
    if name == "histogram":
        return HistogramLocalizer(known, start=start)
    return EkfLocalizer(known, start=start)

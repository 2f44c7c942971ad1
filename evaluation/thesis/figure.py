"""What the page shows of one of the thesis's figures: pictures, caption, numbers, criteria."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evaluation.thesis.map_run import MapRun
from evaluation.thesis.verdict import Check, Verdict, verdict_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapView:
    """One picture of a map."""

    title: str
    run: MapRun
    start: tuple[float, float, float]
    """Where the robot started: the picture has its heading up."""
    scale: float
    """Size on the page [pixels per metre]."""
    path: NDArray[np.float64]
    """Where the mapper takes the robot to have been ``(n, 2)`` [m]."""
    obstacles_only: bool = True
    """Only occupied cells are shown, as in most of the thesis's figures."""
    filled: NDArray[np.bool_] | None = None
    """Cells drawn by gap filling, of the map's shape."""
    window: tuple[float, float, float, float] | None = None
    """Left, right, bottom, top [m] in the map frame of the detail to show; None shows it all."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThesisFigure:
    """One figure or table of the thesis, regenerated."""

    number: str
    """As the thesis numbers it: ``Fig. 5.1``."""
    title: str
    saw: str
    """What the thesis says that it shows."""
    caption: str
    """What is shown here."""
    checks: tuple[Check, ...]
    views: tuple[MapView, ...] = ()
    table: tuple[tuple[str, ...], ...] = ()
    """Rows of numbers, the first of headings."""

    @property
    def verdict(self) -> Verdict:
        """Whether what the thesis saw was seen again."""
        return verdict_of(self.checks)

    @property
    def anchor(self) -> str:
        """Name of its place on the page."""
        return self.number.lower().replace(".", "").replace(" ", "-")

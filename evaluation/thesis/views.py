"""Turns a map of a run into what figures show of it: a picture with the path, and the scans."""

from evaluation.thesis.figure import MapView
from evaluation.thesis.holes import Mask
from evaluation.thesis.map_run import MapRun
from evaluation.thesis.regenerate import Runs

HALLWAY_SCALE, ROOM_SCALE = 30.0, 62.0
"""Pixels per metre: 25 m then fit on a screen, and two pictures side by side in half a page."""

DRAWN = "scans drawn / dropped"
"""Heading of the row of ``drawn``."""


def view(
    runs: Runs,
    name: str,
    title: str,
    *,
    scale: float | None = None,
    obstacles_only: bool = True,
    filled: Mask | None = None,
    window: tuple[float, float, float, float] | None = None,
) -> MapView:
    """A picture of a run's map with the path that its mapper believes."""
    drive, run = runs.of(name)
    usual = ROOM_SCALE if run.spec.drive == "room" else HALLWAY_SCALE
    return MapView(
        title=title,
        run=run,
        start=drive.plan.start,
        scale=usual if scale is None else scale,
        path=run.trajectory.poses[:, :2],
        obstacles_only=obstacles_only,
        filled=filled,
        window=window,
    )


def drawn(run: MapRun) -> str:
    """How many scans of the log are in a run's map, and how many were left out."""
    return f"{run.result['map_updates']} / {run.result['scans_dropped']}"

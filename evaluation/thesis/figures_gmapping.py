"""Figures 5.6 to 5.8 and Table 5.3: GMapping at two update rates, beside the thesis's mapper."""

import numpy as np

from evaluation.result import update_rates
from evaluation.thesis.drift import bend_deg, end_error_m, false_wall_share
from evaluation.thesis.figure import ThesisFigure
from evaluation.thesis.holes import fill, hole_share, pieces_per_metre
from evaluation.thesis.map_run import MapRun
from evaluation.thesis.picture import picture_kb
from evaluation.thesis.regenerate import Runs
from evaluation.thesis.verdict import Check, shown
from evaluation.thesis.views import view

BENT = 1.0
"""A map is bent when its end is turned by this much [deg]: over the last 5 m that is 9 cm, as much
as a wall is thick."""

CLEARLY_LIGHTER = 2.0
"""The thesis tells of about four times; half of that is still clearly lighter."""

SCAN_RATE = 5.0
"""Scans that the LDS-01 takes in a second [Hz] (thesis 5.2: about 5 Hz)."""

RATE_TOLERANCE = 0.05
"""Scans are 0.2 s apart to within a control period's rounding; so much less is still every scan
[Hz]."""

RATE_WHY = (
    "Simulated time waits for the mapper. The thesis's laptop did not: a scan that GMapping was "
    "late for may have been matched from an odometry that had moved on. Here each scan has the "
    "odometry of its own time, and at 2 Hz three times as many correct the encoders."
)

ENCODERS_WHY = (
    "OccGridMapp believes the encoders, whose heading is off a little with every turn; GMapping "
    "corrects them by each scan that it takes. The encoders here err more than that filter does."
)

MAPPERS = ("OccGridMapp", "GMapping, 2 Hz")


def figures_of_gmapping(runs: Runs) -> tuple[ThesisFigure, ...]:
    """Fig. 5.6 to 5.8 and Table 5.3."""
    return (_two_rates(runs), _hallway(runs), _room(runs), _table(runs))


def _two_rates(runs: Runs) -> ThesisFigure:
    slow, fast = (
        bend_deg(*runs.of(name)) for name in ("hallway_gmapping_slow", "hallway_gmapping")
    )
    return ThesisFigure(
        number="Fig. 5.6",
        title="Hallway by GMapping at 0.5 Hz and at 2 Hz",
        saw="At 2 Hz the odometry begins to be lost and the map rotates at the end of the path.",
        caption=(
            "The log of fig. 5.1 by GMapping, 30 particles, an update every 2 s (a) and at most "
            "every 0.5 s (b); cells of 5 cm."
        ),
        views=(
            view(runs, "hallway_gmapping_slow", "a) 0.5 Hz", obstacles_only=False),
            view(runs, "hallway_gmapping", "b) 2 Hz", obstacles_only=False),
        ),
        checks=(
            Check(
                claim="at 2 Hz the end of the map is turned, at 0.5 Hz it is not",
                measure="heading of the last 5 m against the first 5 m: at 2 Hz, less at 0.5 Hz",
                value=fast - slow,
                relation=">=",
                bound=BENT,
                unit="deg",
                why_not=RATE_WHY,
            ),
        ),
        table=_scores(runs, ("hallway_gmapping_slow", "hallway_gmapping"), ("0.5 Hz", "2 Hz")),
    )


def _hallway(runs: Runs) -> ThesisFigure:
    names = ("hallway_gmapping", "hallway")
    filling = fill(*runs.of("hallway"), "thesis")
    theirs, ours = (bend_deg(*runs.of(name)) for name in names)
    return ThesisFigure(
        number="Fig. 5.7",
        title="Hallway, GMapping beside OccGridMapp",
        saw=(
            "GMapping's walls have no holes, OccGridMapp's have some even when filled; GMapping's "
            "map is deformed at the end, OccGridMapp's is not."
        ),
        caption="Of the same log: a) GMapping at 2 Hz, b) OccGridMapp with its gaps filled.",
        views=(
            view(runs, "hallway_gmapping", "a) GMapping, 2 Hz"),
            view(runs, "hallway", "b) OccGridMapp, filled", filled=filling.filled),
        ),
        checks=(
            _fewer_holes(hole_share(*runs.of("hallway_gmapping")), filling.holes),
            _bend("GMapping's map is the more deformed", theirs, ">", ours, ENCODERS_WHY),
        ),
        table=_scores(runs, names, ("GMapping", "OccGridMapp")),
    )


def _room(runs: Runs) -> ThesisFigure:
    names = ("room_gmapping", "room")
    filling = fill(*runs.of("room"), "thesis")
    return ThesisFigure(
        number="Fig. 5.8",
        title="Room, GMapping beside OccGridMapp",
        saw="GMapping's walls have no holes; in the room its map is not deformed.",
        caption="Of one log: a) GMapping at 2 Hz, b) OccGridMapp with its gaps filled.",
        views=(
            view(runs, "room_gmapping", "a) GMapping, 2 Hz"),
            view(runs, "room", "b) OccGridMapp, filled", filled=filling.filled),
        ),
        checks=(
            _fewer_holes(hole_share(*runs.of("room_gmapping")), filling.holes),
            _bend("GMapping's map is straight", bend_deg(*runs.of(names[0])), "<", BENT, RATE_WHY),
        ),
        table=_scores(runs, names, ("GMapping", "OccGridMapp")),
    )


def _table(runs: Runs) -> ThesisFigure:
    names = ("hallway", "hallway_gmapping", "room", "room_gmapping")
    of = {name: runs.maps[name] for name in names}
    picture, theirs = picture_kb(view(runs, "hallway", "")), of["hallway_gmapping"].result
    rates = {name: _rates(run) for name, run in of.items()}
    scans = len(runs.drives["hallway"].recording(runs.drives["hallway"].farthest).log.scans)
    per_update = scans / max(theirs["map_updates"], 1)
    return ThesisFigure(
        number="Table 5.3",
        title="Map size, update rate and scores",
        saw=(
            "OccGridMapp's hallway weighs about a quarter of GMapping's and is updated at 6.6 to "
            "10 Hz, with every scan; GMapping's at less than 2 Hz, with one scan of 3 to 5."
        ),
        caption=(
            "The maps above. A rate is 1 over the simulated time between two updates. The thesis "
            "saves the plot of the one and the map file of the other, which the first criterion "
            "compares; the table has both of both. Its rate of 6.6 Hz and more is what the program "
            "could do, and scans come at 5 Hz: see the timings at the end of this page. In place "
            'of "reliability" stand scores against the floor plan, all of it, offices too.'
        ),
        checks=(
            Check(
                claim="OccGridMapp's map of the hallway is the lighter",
                measure="GMapping's map file over OccGridMapp's plot",
                value=theirs["map_file_kb"] / picture,
                relation=">=",
                bound=CLEARLY_LIGHTER,
                unit="x",
                why_not=(
                    "It depends on the file format alone: GMapping's map has cells of 5 cm, a byte "
                    "each, and is cropped here to what is known, which the thesis's was not."
                ),
            ),
            Check(
                claim="OccGridMapp takes every scan when it does not turn",
                measure="its highest update rate",
                value=rates["hallway"][1],
                relation=">=",
                bound=SCAN_RATE - RATE_TOLERANCE,
                unit="Hz",
            ),
            Check(
                claim="GMapping updates at less than 2 Hz",
                measure="its highest update rate",
                value=rates["hallway_gmapping"][1],
                relation="<",
                bound=2.0,
                unit="Hz",
            ),
            Check(
                claim="of 3 to 5 scans it takes one",
                measure="scans per update",
                value=round(per_update),
                relation=">=",
                bound=3,
            ),
        ),
        table=_table_rows(runs, names, of, rates),
    )


def _table_rows(
    runs: Runs,
    names: tuple[str, ...],
    of: dict[str, MapRun],
    rates: dict[str, tuple[float, float]],
) -> tuple[tuple[str, ...], ...]:
    headings = tuple(f"{place}, {mapper}" for place in ("hallway", "room") for mapper in MAPPERS)
    return (
        ("", *headings),
        ("map file, pgm [kB]", *(shown(of[name].result["map_file_kb"]) for name in names)),
        ("plot of the obstacles, png [kB]", *(shown(picture_kb(view(runs, n, ""))) for n in names)),
        ("edge of a cell [cm]", *(shown(100.0 * of[name].map.resolution) for name in names)),
        ("update rate, least to most [Hz]", *("{:.2f} to {:.2f}".format(*rates[n]) for n in names)),
        *_scores(runs, names, headings)[1:],
    )


def _scores(
    runs: Runs, names: tuple[str, ...], headings: tuple[str, ...]
) -> tuple[tuple[str, ...], ...]:
    """Rows of scores, a column a map."""
    of = [runs.of(name) for name in names]
    results = [run.result for _, run in of]
    return (
        ("", *headings),
        ("end turned by [deg]", *(f"{bend_deg(*each):.2f}" for each in of)),
        ("position off at the end [m]", *(f"{end_error_m(*each):.2f}" for each in of)),
        ("wall seen but not drawn", *(shown(hole_share(*each), "%") for each in of)),
        ("pieces per metre of wall", *(shown(pieces_per_metre(*each)) for each in of)),
        ("drawn far from any wall", *(shown(false_wall_share(*each), "%") for each in of)),
        *(
            (key, *("-" if each[key] is None else f"{each[key]:.3f}" for each in results))
            for key in ("coverage", "f1_5cm", "f1_10cm", "adnn_m", "free_iou")
        ),
    )


def _rates(run: MapRun) -> tuple[float, float]:
    """The least and the highest update rate [Hz]; NaN with fewer than two updates."""
    least = update_rates(run.update_stamps)["map_update_rate_min_hz"]
    if least is None:
        return float("nan"), float("nan")
    return least, float(1.0 / np.diff(run.update_stamps).min())


def _bend(claim: str, value: float, relation: str, bound: float, why_not: str) -> Check:
    return Check(
        claim=claim,
        measure="heading of the last 5 m against the first 5 m",
        value=value,
        relation=relation,  # type: ignore[arg-type]
        bound=bound,
        unit="deg",
        why_not=why_not,
    )


def _fewer_holes(theirs: float, ours: float) -> Check:
    return Check(
        claim="GMapping leaves fewer holes",
        measure="share of the wall seen that it does not draw, against OccGridMapp's",
        value=theirs,
        relation="<",
        bound=ours,
        unit="%",
        why_not="Neither map has a hole that the filling left open.",
    )

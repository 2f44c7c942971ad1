"""Figures 5.1 to 5.5: the thesis's mapper in the hallway and the room, gaps open and filled."""

import numpy as np

from evaluation.thesis.figure import ThesisFigure
from evaluation.thesis.holes import (
    Filling,
    can_joins_wall,
    can_share,
    fill,
    hole_share,
    pieces_per_metre,
)
from evaluation.thesis.map_run import MapRun
from evaluation.thesis.regenerate import Runs
from evaluation.thesis.verdict import Check, shown
from evaluation.thesis.views import DRAWN, drawn, view
from mapping.grid import FREE, OCCUPIED, UNKNOWN

MOST_HOLES = 0.5
"""A map that does not show half of the wall seen from near is no map of the place."""

LEAST_PIECES = 1.0
"""Walls with points missing fall apart: a hole a metre is what an eye sees in fig. 5.1."""

FEWER = 0.5
"""Many gaps are filled when at most this share of the pieces is left."""

CAN_SEEN = 0.5
"""The can is visible when half of the side seen from near is drawn."""

DRIFT_WHY = (
    "The pose comes from encoders alone. Where its error grew between two sights of a wall, the "
    "later one is drawn elsewhere, and its beams erase the earlier one."
)


def figures_of_mapping(runs: Runs) -> tuple[ThesisFigure, ...]:
    """Fig. 5.1 to 5.5."""
    fillings = {name: fill(*runs.of(name), "thesis") for name in ("hallway", "room")}
    return (
        _obstacles(runs),
        _three_colours(runs),
        _hallway_filled(runs, fillings["hallway"]),
        _room(runs),
        _room_filled(runs, fillings["room"]),
    )


def _obstacles(runs: Runs) -> ThesisFigure:
    drive, run = runs.of("hallway")
    return ThesisFigure(
        number="Fig. 5.1",
        title="Hallway, obstacles only",
        saw="The hallway as black points, the way red; some points of the walls are missing.",
        caption=(
            f"OccGridMapp's map of lim_hallway on the way to its far end, "
            f"{drive.farthest:.0f} s of driving; cells of 1 cm, the start heading up."
        ),
        views=(view(runs, "hallway", "occupied cells"),),
        checks=(_map_shows_walls(runs, "hallway"), _walls_have_gaps(runs, "hallway")),
        table=_counts(run),
    )


def _three_colours(runs: Runs) -> ThesisFigure:
    drive, run = runs.of("hallway")
    states = run.map.states
    kinds = sum(bool(np.any(states == state)) for state in (OCCUPIED, FREE, UNKNOWN))
    inside = drive.recording(drive.farthest)
    return ThesisFigure(
        number="Fig. 5.2",
        title="Hallway, all cells",
        saw="The same map, occupied cells black, free ones white, unknown ones blue.",
        caption="The same map as fig. 5.1 in three colours: log odds above 3, below -3, between.",
        views=(view(runs, "hallway", "all cells", obstacles_only=False),),
        checks=(
            Check(
                claim="all three states of cells occur",
                measure="states that occur",
                value=kinds,
                relation="==",
                bound=3,
            ),
            Check(
                claim="what the robot drove over is free",
                measure="share of its way on free cells",
                value=_share_on_free(run),
                relation=">=",
                bound=0.99,
                unit="%",
            ),
        ),
        table=(("scans of the log", str(len(inside.log.scans))), *_counts(run)),
    )


def _hallway_filled(runs: Runs, filling: Filling) -> ThesisFigure:
    better = fill(*runs.of("hallway"), "better")
    return ThesisFigure(
        number="Fig. 5.3",
        title="Hallway, gaps filled",
        saw="Many gaps between points of one wall are filled, others are not; no way is closed.",
        caption=(
            "The map of fig. 5.1 with the thesis's gap filling: lines between points within "
            "10 x 10 cm, and up to 50 cm along rows and columns."
        ),
        views=(view(runs, "hallway", "the thesis's filling", filled=filling.filled),),
        checks=_filled_checks(runs, "hallway", filling),
        table=_filling_table(runs, "hallway", filling, better),
    )


def _room(runs: Runs) -> ThesisFigure:
    drive, run = runs.of("room")
    return ThesisFigure(
        number="Fig. 5.4",
        title="Room",
        saw="The room; in the left bottom corner the trash can is visible.",
        caption=(
            f"OccGridMapp's map of lim_room, {drive.end:.0f} s of driving from a fixed start."
        ),
        views=(view(runs, "room", "occupied cells"),),
        checks=(
            _map_shows_walls(runs, "room"),
            _walls_have_gaps(runs, "room"),
            Check(
                claim="the trash can is visible",
                measure="share of its side drawn within 5 cm",
                value=can_share(drive, run),
                relation=">=",
                bound=CAN_SEEN,
                unit="%",
                why_not=DRIFT_WHY,
            ),
        ),
        table=_counts(run),
    )


def _room_filled(runs: Runs, filling: Filling) -> ThesisFigure:
    drive, run = runs.of("room")
    better = fill(drive, run, "better")
    return ThesisFigure(
        number="Fig. 5.5",
        title="Room, gaps filled",
        saw="The corners close, and the trash can becomes an extension of the wall.",
        caption="The map of fig. 5.4 with the thesis's gap filling.",
        views=(view(runs, "room", "the thesis's filling", filled=filling.filled),),
        checks=(
            *_filled_checks(runs, "room", filling),
            Check(
                claim="the trash can joins the wall",
                measure="connected with it after filling",
                value=can_joins_wall(drive, run, filling.filled),
                relation="==",
                bound=1,
                unit="yes",
                why_not="The can is not drawn, or is drawn too far from the wall.",
            ),
        ),
        table=(
            *_filling_table(runs, "room", filling, better),
            (
                "can joined with the wall",
                *(
                    shown(can_joins_wall(drive, run, cells), "yes")
                    for cells in (None, filling.filled, better.filled)
                ),
            ),
        ),
    )


def _map_shows_walls(runs: Runs, name: str) -> Check:
    return Check(
        claim="the map shows the place",
        measure="share of the wall seen from within 1.5 m that is not drawn",
        value=hole_share(*runs.of(name)),
        relation="<=",
        bound=MOST_HOLES,
        unit="%",
        why_not=DRIFT_WHY,
    )


def _walls_have_gaps(runs: Runs, name: str) -> Check:
    return Check(
        claim="points of the walls are missing",
        measure="separate pieces per metre of wall seen",
        value=pieces_per_metre(*runs.of(name)),
        relation=">=",
        bound=LEAST_PIECES,
        unit="/m",
    )


def _filled_checks(runs: Runs, name: str, filling: Filling) -> tuple[Check, ...]:
    before = pieces_per_metre(*runs.of(name))
    return (
        Check(
            claim="many gaps are filled",
            measure="share of the pieces of wall that is left",
            value=filling.pieces / before if before > 0.0 else 1.0,
            relation="<=",
            bound=FEWER,
            unit="%",
        ),
        Check(
            claim="others are not",
            measure="share of the wall seen from near that is still not drawn",
            value=filling.holes,
            relation=">",
            bound=0.0,
            unit="%",
            why_not="Here the rule reached every hole of the wall that was seen from near.",
        ),
        Check(
            claim="no way of the robot is closed",
            measure="filled cells where the robot drove",
            value=filling.on_the_way,
            relation="==",
            bound=0,
        ),
    )


def _filling_table(
    runs: Runs, name: str, thesis: Filling, better: Filling
) -> tuple[tuple[str, ...], ...]:
    drive, run = runs.of(name)
    columns = (
        (hole_share(drive, run), pieces_per_metre(drive, run), 0),
        *((each.holes, each.pieces, int(each.filled.sum())) for each in (thesis, better)),
    )
    holes, pieces, cells = zip(*columns, strict=True)
    return (
        ("gap filling", "none", "thesis", "better"),
        ("wall not drawn", *(shown(value, "%") for value in holes)),
        ("pieces per metre", *(shown(value) for value in pieces)),
        ("cells drawn", *(str(value) for value in cells)),
    )


def _counts(run: MapRun) -> tuple[tuple[str, ...], ...]:
    states = run.map.states
    return (
        (DRAWN, drawn(run)),
        *(
            (f"{name} cells", str(int(np.count_nonzero(states == state))))
            for name, state in (("occupied", OCCUPIED), ("free", FREE))
        ),
    )


def _share_on_free(run: MapRun) -> float:
    """Share of the believed way that lies on free cells of the map."""
    places = run.trajectory.poses[:, :2]
    cells = np.floor((places - np.asarray(run.map.origin)) / run.map.resolution).astype(np.int64)
    inside = np.all((cells >= 0) & (cells < run.map.states.shape[::-1]), axis=1)
    free = run.map.states[cells[inside, 1], cells[inside, 0]] == FREE
    return float(np.count_nonzero(free) / max(len(places), 1))

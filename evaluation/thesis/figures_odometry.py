"""Figures 5.9 to 5.11: what turning and driving back do to a map that believes the encoders."""

import numpy as np

from evaluation.thesis.drift import (
    TWICE,
    bend_deg,
    doubled_share,
    end_error_m,
    false_wall_share,
)
from evaluation.thesis.drive import Drive
from evaluation.thesis.figure import MapView, ThesisFigure
from evaluation.thesis.regenerate import OWN_MAPPERS, Runs
from evaluation.thesis.turning import heading_error_deg, wrong_area_m2
from evaluation.thesis.verdict import Check, shown
from evaluation.thesis.views import DRAWN, drawn, view
from mapping.trajectory import poses_at

BACK_SCALE = 23.0
"""Pixels per metre of the hallways there and back: five of them then stand side by side."""

DETAIL_SCALE, DETAIL_SIDE = 72.0, 2.6
"""Pixels per metre of a detail, and how far it shows to each side of the turn [m]."""

WRONG = 0.05
"""Area that an eye sees to be wrong [m2]: half a metre of wall, 10 cm thick."""

ELIMINATED = 0.5
"""The gate eliminates an error when at most this share of it is left."""

SAME_ERROR = 0.01
"""Two drives of one log have the same odometry; headings that differ by less are the same [deg]."""

LOST = 0.5
"""A heading that a turn leaves off by this much [deg] is 10 cm off after 12 m of hallway."""

DOUBLED = 0.05
"""A hallway is doubled when this share of the wall seen on both ways stands in the map twice; most
of what was drawn first is erased by the beams of the way back."""

LUCKY_WHY = (
    "The thesis says that this is not always so, and it depends on the wheels: here the error that "
    "the turn at the far end left was too small to draw the hallway beside itself."
)

OWN_NAMES = {"graph": "graph SLAM", "scan_match": "scan matching", "ogm": "ogm, by odometry"}


def figures_of_odometry(runs: Runs) -> tuple[ThesisFigure, ...]:
    """Fig. 5.9 to 5.11."""
    return (_ungated(runs), _gated(runs), _there_and_back(runs))


def _ungated(runs: Runs) -> ThesisFigure:
    drive, run = runs.of("turn_ungated")
    return ThesisFigure(
        number="Fig. 5.9",
        title="A turn, mapped without the gate",
        saw="Mapped while the robot turns, walls come out wrong.",
        caption=(
            "Where the robot turned round at the far end of the hallway, every scan drawn; the "
            "thesis shows the start of its hallway, where this drive has no turn."
        ),
        views=(_detail(runs, "turn_ungated", drive, "no gate"),),
        checks=(
            Check(
                claim="the turn draws what is not there",
                measure="area drawn wrongly around the turn",
                value=wrong_area_m2(drive, run),
                relation=">=",
                bound=WRONG,
                unit="m2",
                why_not="The turn was too slow, or too short, for scans to smear.",
            ),
        ),
        table=((DRAWN, drawn(run)),),
    )


def _gated(runs: Runs) -> ThesisFigure:
    (drive, run), (_, ungated) = runs.of("turn"), runs.of("turn_ungated")
    before, after = wrong_area_m2(drive, ungated), wrong_area_m2(drive, run)
    headings = heading_error_deg(drive, run), heading_error_deg(drive, ungated)
    return ThesisFigure(
        number="Fig. 5.10",
        title="The same turn with the gate",
        saw="The error in the map is eliminated, the error in the odometry is not.",
        caption="The same log; scans are dropped while the robot turns at more than 0.2 rad/s.",
        views=(_detail(runs, "turn", drive, "gate at 0.2 rad/s"),),
        checks=(
            Check(
                claim="the error in the map is eliminated",
                measure="share of the wrongly drawn area that is left",
                value=after / before if before > 0.0 else 1.0,
                relation="<=",
                bound=ELIMINATED,
                unit="%",
                why_not="What is left comes from readings of walls far away, not from the turn.",
            ),
            Check(
                claim="the error in the odometry is not",
                measure="heading that the turn left off",
                value=abs(headings[0]),
                relation=">=",
                bound=LOST,
                unit="deg",
                why_not="The encoders of this drive hardly err in turns.",
            ),
            Check(
                claim="it is the same with and without the gate",
                measure="difference of the two",
                value=abs(headings[0] - headings[1]),
                relation="<=",
                bound=SAME_ERROR,
                unit="deg",
            ),
        ),
        table=(
            ("", "no gate", "gate"),
            ("wrong area [m2]", f"{before:.3f}", f"{after:.3f}"),
            (DRAWN, drawn(ungated), drawn(run)),
        ),
    )


def _there_and_back(runs: Runs) -> ThesisFigure:
    drive, run = runs.of("back")
    names = ("back", *(f"back_{mapper}" for mapper in OWN_MAPPERS), "back_gmapping")
    titles = ("OccGridMapp", *(OWN_NAMES[mapper] for mapper in OWN_MAPPERS), "GMapping, 2 Hz")
    return ThesisFigure(
        number="Fig. 5.11",
        title="There and back: the hallway drawn twice",
        saw="The odometry is lost, and a second hallway is drawn over the first.",
        caption=(
            f"The drive of fig. 5.1 goes on: the robot turns and comes back, {drive.length:.0f} m "
            "in all. First OccGridMapp, then the same log with this project's own mappers and with "
            "GMapping, of which no criterion is asked."
        ),
        views=tuple(
            view(runs, name, told, scale=BACK_SCALE)
            for name, told in zip(names, titles, strict=True)
        ),
        checks=(
            Check(
                claim="the odometry is lost",
                measure="position off at the end",
                value=end_error_m(drive, run),
                relation=">=",
                bound=TWICE,
                unit="m",
                why_not=LUCKY_WHY,
            ),
            Check(
                claim="there is a second hallway",
                measure="share of the wall that stands in the map twice, more than 0.2 m apart",
                value=doubled_share(drive, run),
                relation=">=",
                bound=DOUBLED,
                unit="%",
                why_not=LUCKY_WHY,
            ),
        ),
        table=_rows(runs, names, titles),
    )


def _rows(
    runs: Runs, names: tuple[str, ...], titles: tuple[str, ...]
) -> tuple[tuple[str, ...], ...]:
    of = [runs.of(name) for name in names]
    return (
        ("", *titles),
        ("wall drawn twice", *(shown(doubled_share(*each), "%") for each in of)),
        ("position off at the end [m]", *(f"{end_error_m(*each):.3f}" for each in of)),
        ("position off, rms [m]", *(f"{run.result['ate_rmse_m']:.3f}" for _, run in of)),
        ("end turned by [deg]", *(f"{bend_deg(*each):.2f}" for each in of)),
        ("drawn far from any wall", *(shown(false_wall_share(*each), "%") for each in of)),
        ("f1_10cm", *(f"{run.result['f1_10cm']:.3f}" for _, run in of)),
    )


def _detail(runs: Runs, name: str, drive: Drive, title: str) -> MapView:
    """What lies around the turn, where the mapper believes that to be."""
    run = runs.maps[name]
    x, y, _ = poses_at(run.trajectory, np.array([drive.farthest]))[0]
    box = (x - DETAIL_SIDE, x + DETAIL_SIDE, y - DETAIL_SIDE, y + DETAIL_SIDE)
    return view(runs, name, title, scale=DETAIL_SCALE, window=box, obstacles_only=False)

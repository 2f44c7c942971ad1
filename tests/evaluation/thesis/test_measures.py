"""The measures behind the verdicts, on maps drawn by hand."""

import numpy as np
import pytest
from numpy.typing import NDArray

from evaluation.thesis.drift import bend_deg, doubled_share, end_error_m, false_wall_share
from evaluation.thesis.holes import (
    can_joins_wall,
    can_share,
    fill,
    hole_share,
    pieces_per_metre,
    walls_seen,
)
from evaluation.thesis.turning import heading_error_deg, wrong_area_m2
from mapping.geometry import transform_points
from tests.evaluation.thesis.made_up_runs import (
    can_points,
    drive_through,
    map_of,
    room_points,
    wall_points,
)

TURNING = np.column_stack((np.ones(30), np.ones(30), np.deg2rad(np.arange(30.0) / 3.0)))
"""Turns in the middle of the room, so that beams reach every piece of wall."""

THERE_AND_BACK = np.column_stack(
    (
        np.concatenate((np.linspace(0.6, 1.7, 30), np.linspace(1.7, 0.6, 30))),
        np.ones(60),
        np.concatenate((np.zeros(30), np.full(30, np.pi))),
    )
)


def test_a_wall_drawn_whole_has_no_holes() -> None:
    drive = drive_through(TURNING)
    run = map_of(drive, room_points())
    assert len(walls_seen(drive, run)) > 500, "centimetres of wall"
    assert hole_share(drive, run) == pytest.approx(0.0, abs=0.01)


def test_a_wall_drawn_whole_elsewhere_has_none_either() -> None:
    drive = drive_through(TURNING)
    error = (0.3, -0.2, float(np.deg2rad(4.0)))
    moved = map_of(drive, transform_points(error, room_points()), error)
    assert hole_share(drive, moved) < 0.05
    assert hole_share(drive, map_of(drive, room_points(), error)) > 0.5


def test_half_a_wall_is_half_a_hole() -> None:
    drive = drive_through(TURNING)
    half = np.concatenate((wall_points(0.0, 1.0), can_points()))
    assert 0.4 < hole_share(drive, map_of(drive, half)) < 0.6


def test_an_empty_map_is_one_hole() -> None:
    drive = drive_through(TURNING)
    assert hole_share(drive, map_of(drive, np.empty((0, 2)))) == 1.0


def test_points_apart_are_pieces_and_filling_joins_them() -> None:
    drive = drive_through(TURNING)
    apart = map_of(drive, wall_points()[::3])
    pieces = pieces_per_metre(drive, apart)
    assert pieces > 25.0
    filling = fill(drive, apart, "thesis")
    assert filling.pieces < 0.1 * pieces
    assert filling.on_the_way == 0


def test_the_can_is_found_where_it_is_drawn() -> None:
    drive = drive_through(TURNING)
    assert can_share(drive, map_of(drive, wall_points())) < 0.3
    assert can_share(drive, map_of(drive, room_points())) == 1.0


def test_the_can_joins_the_wall_when_a_line_leads_there() -> None:
    drive = drive_through(TURNING)
    assert not can_joins_wall(drive, map_of(drive, room_points()))
    line = np.column_stack((np.arange(-0.005, 0.15, 0.005), np.full(31, 0.255)))
    joined = map_of(drive, np.concatenate((room_points(), line)))
    assert can_joins_wall(drive, joined)


def test_false_walls_are_the_share_of_cells_far_from_any_wall() -> None:
    drive = drive_through(TURNING)
    assert false_wall_share(drive, map_of(drive, room_points())) == 0.0
    ghosts = np.column_stack((np.arange(0.805, 1.2, 0.01), np.full(40, 1.005)))
    walls = wall_points()
    share = false_wall_share(drive, map_of(drive, np.concatenate((walls, ghosts))))
    assert share == pytest.approx(40 / (len(walls) + 40))


def test_a_wall_seen_both_ways_stands_twice_when_both_drawings_are_there() -> None:
    drive = drive_through(THERE_AND_BACK)
    back = drive.ground_truth.stamps > drive.farthest
    assert doubled_share(drive, map_of(drive, room_points())) == 0.0
    moved = room_points() + (0.0, 0.4)
    run = map_of(drive, np.concatenate((room_points(), moved)))
    run.trajectory.poses[back, 1] += 0.4
    assert 0.3 < doubled_share(drive, run) < 0.6, "two walls of four were moved along themselves"
    only_back = map_of(drive, moved)
    only_back.trajectory.poses[back, 1] += 0.4
    assert doubled_share(drive, only_back) < 0.1, "what was erased does not stand there"


def test_a_heading_that_drifts_bends_the_map_and_one_that_is_off_throughout_does_not() -> None:
    count = 100
    poses = np.column_stack((np.linspace(0.5, 1.5, count), np.ones(count), np.zeros(count)))
    drive = drive_through(poses)
    turned = map_of(drive, wall_points(), (0.0, 0.0, float(np.deg2rad(5.0))))
    assert bend_deg(drive, turned) == pytest.approx(0.0, abs=1e-9)
    drifting = map_of(drive, wall_points())
    drifting.trajectory.poses[:, 2] += np.deg2rad(np.linspace(0.0, 4.0, count))
    assert bend_deg(drive, drifting) == pytest.approx(2.0, abs=0.1), "its halves lie 2 deg apart"
    drifting.trajectory.poses[-1, 0] += 0.3
    assert end_error_m(drive, drifting) == pytest.approx(0.3)


def test_wrong_around_a_turn_is_what_stands_or_opens_where_it_cannot() -> None:
    drive = drive_through(THERE_AND_BACK)
    assert wrong_area_m2(drive, map_of(drive, wall_points())) == pytest.approx(0.0, abs=0.02)
    ghosts = np.column_stack((np.arange(0.805, 1.2, 0.01), np.full(40, 1.505)))
    more = map_of(drive, np.concatenate((wall_points(), ghosts)))
    assert wrong_area_m2(drive, more) == pytest.approx(
        wrong_area_m2(drive, map_of(drive, wall_points())) + 40e-4
    )


def test_what_a_turn_adds_to_the_heading_has_its_sign() -> None:
    drive = drive_through(_there_and_far_back())
    run = map_of(drive, wall_points())
    run.trajectory.poses[drive.ground_truth.stamps > drive.farthest, 2] -= np.deg2rad(3.0)
    assert heading_error_deg(drive, run) == pytest.approx(-3.0)


def _there_and_far_back() -> NDArray[np.float64]:
    """As there and back, but so far that the robot counts as having left its farthest place."""
    poses = THERE_AND_BACK.copy()
    poses[:, 0] = np.concatenate((np.linspace(0.4, 1.8, 30), np.linspace(1.8, 0.4, 30)))
    return poses

"""Drives of some seconds, recorded and mapped: the same seed, the same page."""

from evaluation.thesis.config import ThesisConfig, room_drive
from evaluation.thesis.drive import record_drive
from evaluation.thesis.map_run import run_map
from evaluation.thesis.page import page_of
from evaluation.thesis.regenerate import SPECS, STEPS, Runs, regenerate
from evaluation.thesis.thesis_folder import figures_of
from tests.evaluation.thesis.made_up_runs import without_timings


def test_the_same_seed_writes_the_same_page_in_processes_or_without() -> None:
    tour = room_drive(3, time_limit=3.0)
    config = ThesisConfig(hallway=tour, room=tour)  # the hallway's truth takes long to make
    told: list[str] = []
    in_processes = regenerate(config, processes=2, on_done=told.append)
    assert len(told) == STEPS
    assert list(in_processes.maps) == list(SPECS), "in one order, whichever came first"
    drive = record_drive(tour)
    assert drive.stop_reason == "time_limit"
    here = Runs(
        drives={"hallway": drive, "room": drive},
        maps={name: run_map(drive, spec) for name, spec in SPECS.items()},
    )
    pages = [
        without_timings(page_of(config, runs, figures_of(runs))) for runs in (in_processes, here)
    ]
    assert pages[0] == pages[1]

"""Drives of some seconds, recorded and mapped in processes: the same seed, the same page."""

from evaluation.thesis.config import ThesisConfig, hallway_drive, room_drive
from evaluation.thesis.page import page_of
from evaluation.thesis.regenerate import SPECS, STEPS, regenerate
from evaluation.thesis.thesis_folder import figures_of
from evaluation.thesis.timings import without_timings


def test_the_same_seed_writes_the_same_page() -> None:
    config = ThesisConfig(
        hallway=hallway_drive(3, time_limit=3.0), room=room_drive(3, time_limit=3.0)
    )
    pages, told = [], []
    for processes in (1, 2):
        runs = regenerate(config, processes=processes, on_done=told.append)
        pages.append(without_timings(page_of(config, runs, figures_of(runs))))
    assert pages[0] == pages[1]
    assert len(told) == 2 * STEPS
    assert list(runs.maps) == list(SPECS), "in one order, whichever came first"
    assert all(drive.stop_reason == "time_limit" for drive in runs.drives.values())

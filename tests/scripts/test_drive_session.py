"""A person at a keyboard as a navigator, without a terminal: what keys do and what is told."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from evaluation.map_snapshots import MapSnapshots
from evaluation.pace import Pace
from mapping.mappers import make_mapper
from mapping.messages import Twist
from nav.navigator import RUNNING
from nav.reactive import Reactive
from nav.teleop import QUIT, Teleop
from scripts.drive_session import DriveSession
from scripts.live_map import LiveMap


class Clock:
    """Wall time that passes while one waits for keys."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def session_with(
    read: Callable[[float], bytes | None], snapshots: MapSnapshots, clock: Clock
) -> tuple[DriveSession, Callable[[], Twist]]:
    mapper = make_mapper("ogm")
    session = DriveSession(
        Teleop(Reactive),
        mapper,
        Pace(0.1, clock=clock),
        read,
        LiveMap(""),
        snapshots,
    )
    return session, lambda: session.command(mapper.grid, np.zeros(3), None)


def typed(clock: Clock, *pieces: bytes | None) -> Callable[[float], bytes | None]:
    """A keyboard that sends a piece each time it is asked, then nothing any more."""
    waiting = list(pieces)

    def read(timeout: float) -> bytes | None:
        if waiting:
            clock.now += 0.3 * timeout
            return waiting.pop(0)
        clock.now += timeout
        return b""

    return read


def test_keys_of_one_period_all_count_and_a_split_arrow_is_one_key(tmp_path: Path) -> None:
    clock = Clock()
    _, drive = session_with(
        typed(clock, b"w", b"w\x1b", b"[", b"Cw"), MapSnapshots(tmp_path), clock
    )
    assert drive() == Twist(linear_x=0.01), "the first period begins at once"
    assert drive() == Twist(linear_x=0.03, angular_z=-0.1)
    assert clock.now == pytest.approx(0.1)


def test_a_keyboard_that_is_gone_quits(tmp_path: Path) -> None:
    clock = Clock()
    session, drive = session_with(typed(clock, b"w", None), MapSnapshots(tmp_path), clock)
    drive()
    assert session.status == RUNNING
    assert drive() == Twist()
    assert session.status == QUIT


def test_a_plot_is_saved_while_the_robot_drives_on(tmp_path: Path) -> None:
    clock = Clock()
    snapshots = MapSnapshots(tmp_path)
    _, drive = session_with(typed(clock, b"wp", b"p"), snapshots, clock)
    assert drive() == drive() == Twist(linear_x=0.01)
    assert snapshots.close() == 2
    assert {file.name for file in tmp_path.iterdir()} == {"plot_001.png", "plot_002.png"}


def test_a_machine_that_is_too_slow_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = Clock()
    session, drive = session_with(typed(clock), MapSnapshots(tmp_path), clock)
    drive()
    for _ in range(30):
        clock.now += 0.25
        drive()
    session.draw()
    assert "too slow: 0.40x real time" in capsys.readouterr().err
    assert session.late_share > 0.5

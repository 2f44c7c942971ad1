"""Driving by hand, as a person at a terminal meets it, and the parts that make it up."""

import itertools
import json
import os
import signal
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evaluation.kernels.warm_up import kernels_of_mapper
from mapping.geometry import wrap_to_pi
from mapping.io.tum import read_tum
from nav.teleop import TeleopCommand
from scripts.__main__ import run
from scripts.first_run import compile_if_needed
from scripts.keyboard import KEYS, KeyDecoder, Request, command_of
from tests.scripts.terminal import Terminal

WORDS = "drive --world empty_room --mapper ogm --odometry truth --speed 8 --out".split()

FILES = {
    *("config.json", "result.json", "map.pgm", "map.yaml", "map.png"),
    *("trajectory.tum", "ground_truth.tum", "odometry.tum"),
}


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    """No test waits for a compilation with its patience."""
    compile_if_needed(kernels_of_mapper("ogm", simulates=True))


def test_a_drive_by_hand_then_autonomous_leaves_a_whole_run_folder(tmp_path: Path) -> None:
    with Terminal([*WORDS, str(tmp_path)]) as terminal:
        terminal.wait_for(r"by hand +\+0\.00 m/s \+0\.00 rad/s")
        assert not terminal.echoes
        terminal.press("ww\033[D")
        begin = time_in(terminal.wait_for(r"by hand +\+0\.02 m/s \+0\.10 rad/s.* \d+ s\r"))
        end = begin
        while end < begin + 3:
            end = time_in(terminal.wait_for(r"by hand +\+0\.02 m/s.* \d+ s\r"))
        terminal.press("g")
        terminal.wait_for(r"autonomous +[+-]0\.[12]\d m/s")
        terminal.press("w")
        terminal.wait_for(r"by hand +\+0\.01 m/s \+0\.00 rad/s")
        terminal.press("p")
        terminal.wait_for(r"plot in \S+plot_001\.png")
        terminal.press("q")
        assert terminal.end() == 0, terminal.shown
        assert terminal.is_as_before
    assert "empty_room: quit after" in terminal.shown
    assert FILES | {"plot_001.png"} <= {path.name for path in tmp_path.iterdir()}
    assert (tmp_path / "plot_001.png").read_bytes()[:4] == b"\x89PNG"
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["stop_reason"] == "quit"
    assert result["navigator"] == "teleop+frontier"
    odometry = read_tum(tmp_path / "odometry.tum")
    by_hand = odometry.poses[(odometry.stamps > begin + 1) & (odometry.stamps < end)]
    assert np.hypot(*(by_hand[-1] - by_hand[0])[:2]) > 0.02, "2 cm/s for 2 s"
    assert wrap_to_pi(by_hand[-1, 2] - by_hand[0, 2]) > 0.1, "to the left"


def time_in(status: str) -> int:
    """The simulated time that a status line ends with [s]."""
    return int(status.split()[-2])


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_and_ctrl_c_save_the_run_and_give_the_terminal_back(
    number: signal.Signals, tmp_path: Path
) -> None:
    with Terminal([*WORDS, str(tmp_path)]) as terminal:
        terminal.wait_for(r"by hand.* [1-9]\d* s\r")
        if number == signal.SIGINT:
            terminal.press("\x03")
        else:
            os.kill(terminal.process, number)
        assert terminal.end() == 0, terminal.shown
        assert terminal.is_as_before
    assert {path.name for path in tmp_path.iterdir()} >= FILES
    assert json.loads((tmp_path / "result.json").read_text())["stop_reason"] == "interrupted"


def test_after_a_stop_keys_count_again_at_once(tmp_path: Path) -> None:
    with Terminal([*WORDS, str(tmp_path)]) as terminal:
        terminal.wait_for(r"by hand.* [1-9]\d* s\r")
        os.kill(terminal.process, signal.SIGSTOP)
        sleep(0.5)
        os.kill(terminal.process, signal.SIGCONT)
        terminal.press("w")
        terminal.wait_for(r"by hand +\+0\.01 m/s")
        assert not terminal.echoes
        terminal.press("q")
        assert terminal.end() == 0, terminal.shown
        assert terminal.is_as_before


def test_without_a_display_there_is_no_viewer_which_is_told_in_one_line(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with Terminal(["drive", "--viewer", "--out", str(out)]) as terminal:
        assert terminal.end() == 2
        assert terminal.is_as_before
    assert "no display" in terminal.shown
    assert len(terminal.shown.strip().splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--world", "nowhere"], "no such world"),
        (["--speed", "0"], "speed: 0"),
        (["--navigator", "pilot"], "frontier"),
    ],
)
def test_bad_input_gives_one_line_and_leaves_nothing(
    words: list[str],
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("scripts.drive._check_terminal", lambda: None)
    out = tmp_path / "out"
    assert run(["drive", "--mapper", "ogm", *words, "--out", str(out)]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert said in lines[0]
    assert not out.exists()


def test_without_a_terminal_it_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["drive"]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert "terminal" in lines[0]


def test_keys_stand_for_what_turtlebot3_teleop_has_them_do() -> None:
    wanted = {
        "w": TeleopCommand.FORWARD,
        "x": TeleopCommand.BACKWARD,
        "a": TeleopCommand.LEFT,
        "d": TeleopCommand.RIGHT,
        "s": TeleopCommand.STOP,
        "space": TeleopCommand.STOP,
        "up": TeleopCommand.FORWARD,
        "down": TeleopCommand.BACKWARD,
        "left": TeleopCommand.LEFT,
        "right": TeleopCommand.RIGHT,
        "g": TeleopCommand.GO,
        "p": Request.PLOT,
        "q": Request.QUIT,
    }
    assert {key: command_of(key) for key in wanted} == wanted == KEYS
    assert command_of("S") is TeleopCommand.STOP
    assert command_of("z") is None


STREAM = {
    b"w": ["w"],
    b" ": ["space"],
    b"\x1b[A": ["up"],
    b"\x1bOB": ["down"],
    b"\x1b[1;2C": ["right"],
    b"\x1b[D": ["left"],
    b"\x1b[3~": [],
    b"\x1bOP": [],
    b"\x1b[[A": [],
    b"\x1b[15~": [],
    b"\x1b\x1b[A": ["up"],
    "é".encode(): [],
    b"\r\n\t": [],
    b"q": ["q"],
}


@given(st.lists(st.sampled_from(sorted(STREAM)), max_size=8), st.lists(st.integers(0, 40)))
def test_keys_are_the_same_however_the_bytes_are_cut(keys: list[bytes], cuts: list[int]) -> None:
    stream = b"".join(keys)
    decoder = KeyDecoder()
    ends = [0, *sorted(cuts), len(stream)]
    read = [key for a, b in itertools.pairwise(ends) for key in decoder.feed(stream[a:b])]
    assert read == [name for key in keys for name in STREAM[key]]

"""The explore verb as its users meet it: in a pipe and on a terminal."""

import fcntl
import json
import os
import pty
import struct
import sys
import termios
from pathlib import Path
from unittest.mock import patch

import pytest
from PIL import Image

from mapping.slam.graph_slam import GraphSlam
from scripts.__main__ import run

WORDS = ["explore", "--world", "empty_room", "--odometry", "truth", "--time-limit", "4"]


def test_in_a_pipe_it_prints_the_result_and_nothing_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*WORDS, "--out", str(tmp_path)]) == 1, "out of time"
    captured = capsys.readouterr()
    assert "empty_room: time_limit after 4 s" in captured.out
    assert all(line.startswith("compiling") for line in captured.err.splitlines())
    assert json.loads((tmp_path / "result.json").read_text())["stop_reason"] == "time_limit"


def test_an_error_ends_a_run_whose_map_and_traceback_are_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = patch.object(GraphSlam, "finish", side_effect=ZeroDivisionError("a defect"))
    with broken:
        assert run([*WORDS, "--out", str(tmp_path)]) == 1
    captured = capsys.readouterr()
    assert "empty_room: error after 4 s" in captured.out
    assert captured.err.endswith("ZeroDivisionError: a defect\n")
    told = (tmp_path / "failure.txt").read_text()
    assert told.startswith("ZeroDivisionError: a defect\n\nTraceback")
    assert json.loads((tmp_path / "result.json").read_text())["stop_reason"] == "error"
    assert run([*WORDS, "--out", str(tmp_path)]) == 1, "out of time"
    assert not (tmp_path / "failure.txt").exists()


def test_an_animated_run_says_that_it_left_a_moving_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*WORDS, "--animate", "--out", str(tmp_path)]) == 1, "out of time"
    assert "trajectories, episode.gif and result.json" in capsys.readouterr().out
    with Image.open(tmp_path / "episode.gif") as picture:
        assert picture.n_frames >= 4


def test_on_a_terminal_the_map_grows_before_the_users_eyes(tmp_path: Path) -> None:
    child, terminal = pty.fork()
    if child == 0:
        words = [sys.executable, "-m", "scripts", *WORDS, "--out", str(tmp_path)]
        os.execve(sys.executable, words, {**os.environ, "PYTHONIOENCODING": "utf-8"})
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
    shown = b""
    while True:
        try:
            piece = os.read(terminal, 65536)
        except OSError:  # how Linux says that the child has closed its end
            break
        if not piece:
            break
        shown += piece
    os.waitpid(child, 0)
    text = shown.decode()
    assert "exploring empty_room: 3 s simulated" in text
    assert "●" in text
    assert "█" in text
    assert "empty_room: time_limit" in text

"""The replay verb as its users meet it: in a pipe, on a terminal, with bad input."""

import fcntl
import json
import os
import pty
import struct
import sys
import termios
from pathlib import Path

import numpy as np
import pytest

from scripts.__main__ import run
from tests.scripts.test_bad_input import refused

FAR = "81.83"
"""What a SICK reports without a return [m]."""


def carmen_line(stamp: float, x: float, ranges: str) -> str:
    pose = f"{x:.3f} 0.000 0.000"
    return f"FLASER 180 {ranges} {pose} {pose} {stamp:.6f} nohost {stamp:.6f}"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A robot that drives 10 cm a second along a wall 2 m to its right; left of it is nothing."""
    angles = np.radians(np.arange(180) - 90.0)
    wall = np.where(angles < -0.3, 2.0 / np.maximum(np.sin(-angles), 0.1), np.inf)
    ranges = " ".join(FAR if np.isinf(r) else f"{r:.2f}" for r in wall)
    path = tmp_path / "wall.log"
    path.write_text("\n".join(carmen_line(k, 1.0 + 0.1 * k, ranges) for k in range(20)) + "\n")
    return path


@pytest.fixture
def relations(tmp_path: Path) -> Path:
    path = tmp_path / "wall.relations"
    path.write_text("2.0 7.0 0.53 0.04 0 0 0 0\n3.0 99.0 0 0 0 0 0 0\n")
    return path


def test_in_a_pipe_it_prints_the_scores_and_nothing_else(
    log: Path, relations: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = ["--log", str(log), "--relations", str(relations), "--out", str(out)]
    assert run(["replay", "--mapper", "ogm", *words]) == 0
    captured = capsys.readouterr()
    assert "wall.log: complete, 19 s of log" in captured.out
    assert "20 scans mapped, 0 dropped" in captured.out
    assert "1 relations: 0.050 +- 0.000 m, 0.00 deg, max 0.050 m" in captured.out
    assert all(line.startswith("compiling") for line in captured.err.splitlines())
    result = json.loads((out / "result.json").read_text())
    assert result["relations_trans_mean_m"] == pytest.approx(0.05)
    config = json.loads((out / "config.json").read_text())
    assert (config["lidar"], config["resolution"]) == ("sick", 0.05)
    assert len(config["log_sha256"]) == 64
    lines = (out / "trajectory.tum").read_text().splitlines()
    assert len(lines) == 20
    assert lines[-1].split()[:3] == ["19.000000000", "1.900000000", "0.000000000"]


def test_options_reach_the_mapper(log: Path, tmp_path: Path) -> None:
    words = [
        "--mapper",
        "occgridmapp",
        "--max-range",
        "3.5",
        "--resolution",
        "0.1",
        "--period",
        "5",
    ]
    words += ["--set", "cells=400", "--set", "turn_gate=none", "--lidar", "lds01"]
    assert run(["replay", "--log", str(log), "--out", str(tmp_path / "out"), *words]) == 0
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    config = json.loads((tmp_path / "out" / "config.json").read_text())
    assert result["map_updates"] == 4
    assert (config["max_range"], config["lidar"], config["resolution"]) == (3.5, "lds01", 0.1)
    assert config["set"] == ["cells=400", "turn_gate=none"]


def test_on_a_terminal_it_shows_how_far_it_is(log: Path, tmp_path: Path) -> None:
    child, terminal = pty.fork()
    if child == 0:
        words = ["replay", "--log", str(log), "--out", str(tmp_path / "out")]
        os.execv(sys.executable, [sys.executable, "-m", "scripts", *words])
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
    assert "/20" in text
    assert "wall.log: complete" in text


def refused_replay(words: list[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The line that a replay is refused with; it leaves nothing behind."""
    before = sorted(folder.rglob("*"))
    line = refused(["replay", "--out", str(folder / "out"), *words], capsys)
    assert sorted(folder.rglob("*")) == before
    return line


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "nowhere.log"),
        ("", "nowhere.log"),
        ("# only a comment\n", "nowhere.log"),
        ("ODOM 0 0 0 0 0 0 1.0 nohost 1.0\n", "nowhere.log"),
    ],
)
def test_a_log_that_is_missing_empty_or_without_scans(
    content: str | None, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "nowhere.log"
    if content is not None:
        path.write_text(content)
    assert told in refused_replay(["--log", str(path)], tmp_path, capsys)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "cannot be read"),
        ("", "no relation"),
        ("1 2 3\n", "line 1"),
        ("1e6 2e6 0 0 0 0 0 0\n", "none of 1 relations"),
    ],
)
def test_relations_that_are_missing_broken_or_of_another_log(
    content: str | None,
    told: str,
    log: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "other.relations"
    if content is not None:
        path.write_text(content)
    line = refused_replay(["--log", str(log), "--relations", str(path)], tmp_path, capsys)
    assert "other.relations" in line
    assert told in line


@pytest.mark.parametrize(
    ("option", "value", "told"),
    [
        ("--mapper", "nonsense", "nonsense"),
        ("--max-range", "-1", "max_range"),
        ("--resolution", "9", "resolution"),
        ("--period", "nan", "period"),
        ("--lidar", "hokuyo", "hokuyo"),
        ("--seed", "-1", "seed"),
        ("--set", "hit", "NAME=VALUE"),
        ("--set", "hits=1", "hits"),
        ("--set", "way=far", "far"),
        ("--set", "max_range=-1", "max_range: -1.0"),
        ("--navigator", "frontier", "--navigator"),
    ],
)
def test_an_option_that_does_not_fit(
    option: str,
    value: str,
    told: str,
    log: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert told in refused_replay(["--log", str(log), option, value], tmp_path, capsys)


def test_a_replay_without_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "--log" in refused_replay([], tmp_path, capsys)


def test_an_out_in_which_the_log_lies(
    log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for path in (tmp_path, log):
        words = ["replay", "--log", str(path), "--out", str(tmp_path)]
        assert "--out" in refused(words, capsys)
    assert list(tmp_path.iterdir()) == [log]

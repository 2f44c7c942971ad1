"""The calibrate verb as its users meet it."""

import json
from pathlib import Path

import pytest

from scripts.__main__ import run


def test_it_prints_the_four_figures_and_writes_three_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["calibrate", "--scans", "30", "--out", str(tmp_path)]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    for word in ("p(m=1 given z=1)", "p(m=0 given z=0)", "lo1", "lo0", "0.991", "5.1100"):
        assert word in captured.out
    assert {path.name for path in tmp_path.iterdir()} == {
        "readings.csv",
        "histogram.png",
        "calibration.json",
    }
    assert json.loads((tmp_path / "calibration.json").read_text())["settings"]["scans"] == 30


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--lidar", "sonar"], "datasheet"),
        (["--scans", "0"], "scans"),
        (["--scans", "many"], "scans"),
        (["--seed", "-1"], "seed"),
    ],
)
def test_bad_input_gives_one_line_and_leaves_nothing(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run(["calibrate", *words, "--out", str(out)]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert said in lines[0]
    assert not out.exists()

"""The optimize verb as its users meet it."""

from pathlib import Path

import pytest

from mapping.io.g2o import read_g2o
from scripts.__main__ import run
from tests.scripts.test_bad_input import refused

TRIANGLE = """\
VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1.3 0 0
VERTEX_SE2 2 2.1 0 0
EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1
EDGE_SE2 1 2 1 0 0 1 0 0 1 0 1
EDGE_SE2 0 2 2.3 0 0 1 0 0 1 0 1
"""
"""Three measurements on a line: 1, 1 and 2.3 m. Each takes a third of the 0.3 m that they disagree
by, so the vertices come to 1.1 and 2.2 m and chi2 to 3 * 0.1^2."""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "line.g2o"
    path.write_text(TRIANGLE)
    return path


def test_it_prints_chi2_and_writes_the_answer_and_a_picture(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run(["optimize", str(file), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    # before: (1.3 - 1)^2 + (0.8 - 1)^2 + (2.1 - 2.3)^2
    assert "line.g2o: 3 vertices, 3 edges, chi2 0.17 before, 0.03 after" in printed
    assert {path.name for path in out.iterdir()} == {"optimized.g2o", "graph.png"}
    assert read_g2o(out / "optimized.g2o").poses[:, 0] == pytest.approx([0.0, 1.1, 2.2], abs=1e-6)


def test_without_out_it_writes_nothing(file: Path, tmp_path: Path) -> None:
    assert run(["optimize", str(file)]) == 0
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "cannot be read"),
        ("", "there is no vertex"),
        ("VERTEX_SE2 0 0 0\n", "line 1"),
        ("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "VERTEX_SE3:QUAT"),
        ("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\n", "no edges lead from vertex 1"),
        ("VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n", "no vertex 1"),
    ],
)
def test_a_file_that_cannot_be_optimised_is_told_in_one_line(
    content: str | None, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.g2o"
    if content is not None:
        path.write_text(content)
    out = tmp_path / "out"
    line = refused(["optimize", str(path), "--out", str(out)], capsys)
    assert "bad.g2o" in line
    assert told in line
    assert not out.exists()


def test_it_does_not_write_over_the_file_it_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "optimized.g2o"
    path.write_text(TRIANGLE)
    assert run(["optimize", str(path), "--out", str(tmp_path)]) == 2
    assert "another folder" in capsys.readouterr().err
    assert path.read_text() == TRIANGLE


def test_a_file_must_be_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert "FILE" in refused(["optimize"], capsys).upper()

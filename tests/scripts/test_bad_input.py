"""Bad input: one clear line, status 2, nothing half-written."""

from pathlib import Path

import pytest

from scripts.__main__ import run

PLAN = """\
name: box
start: {start}
walls:
  - points: {points}
    closed: true
"""
SQUARE = "[[0, 0], [4, 0], [4, 4], [0, 4]]"


def plan_file(folder: Path, *, start: str = "[2, 2, 0]", points: str = SQUARE) -> str:
    path = folder / "plan.yaml"
    path.write_text(PLAN.format(start=start, points=points))
    return str(path)


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line that a command line is refused with."""
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.strip().splitlines()
    assert len(lines) == 1, captured.err
    return lines[0]


def refused_exploration(
    world: str, folder: Path, capsys: pytest.CaptureFixture[str], *more: str
) -> str:
    out = folder / "run"
    line = refused(["explore", "--world", world, "--out", str(out), *more], capsys)
    assert not out.exists() or list(out.iterdir()) == []
    return line


def test_a_missing_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "nowhere.yaml" in refused_exploration(str(tmp_path / "nowhere.yaml"), tmp_path, capsys)


def test_broken_yaml(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "broken.yaml"
    path.write_text("name: [unclosed\nwalls: {")
    assert "broken.yaml" in refused_exploration(str(path), tmp_path, capsys)


def test_an_unknown_world_is_answered_with_the_known_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused_exploration("lim_rom", tmp_path, capsys)
    assert "lim_room" in line


def test_a_start_inside_a_wall(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused_exploration(plan_file(tmp_path, start="[0, 2, 0]"), tmp_path, capsys)
    assert "start" in line


def test_nan_in_the_start_pose(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused_exploration(plan_file(tmp_path, start="[.nan, 2, 0]"), tmp_path, capsys)
    assert "start" in line


def test_a_plan_without_area(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flat = plan_file(tmp_path, points="[[0, 0], [0, 0], [0, 0]]", start="[2, 2, 0]")
    assert "plan.yaml" in refused_exploration(flat, tmp_path, capsys)


def test_an_unknown_key_names_the_file_and_the_key(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(plan_file(tmp_path))
    path.write_text(path.read_text() + "colour: red\n")
    line = refused_exploration(str(path), tmp_path, capsys)
    assert "plan.yaml" in line
    assert "colour" in line


@pytest.mark.parametrize("resolution", ["0", "-0.01", "nan", "fine"])
def test_a_resolution_that_makes_no_map(
    resolution: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused_exploration("lim_room", tmp_path, capsys, "--resolution", resolution)
    assert "resolution" in line


def test_a_map_without_resolution(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "map.yaml"
    path.write_text(
        "image: map.pgm\nresolution: 0\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (tmp_path / "map.pgm").write_bytes(b"P5\n2 2\n255\n\xfe\xfe\xfe\xfe")
    assert "resolution" in refused_exploration(str(path), tmp_path, capsys)


def test_a_map_turned_in_its_origin(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "map.yaml"
    path.write_text(
        "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0.5]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (tmp_path / "map.pgm").write_bytes(b"P5\n2 2\n255\n\xfe\xfe\xfe\xfe")
    assert "origin" in refused_exploration(str(path), tmp_path, capsys)


def test_an_unwritable_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()  # nothing can be made below a file, not even by root
    line = refused(["explore", "--out", str(tmp_path / "file" / "run")], capsys)
    assert "--out" in line


def test_an_out_that_is_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "taken"
    path.write_text("mine")
    line = refused(["explore", "--out", str(path)], capsys)
    assert str(path) in line
    assert path.read_text() == "mine"


@pytest.mark.parametrize("field", ["mapper", "navigator", "odometry", "lidar"])
def test_an_unknown_name(field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused_exploration("empty_room", tmp_path, capsys, f"--{field}", "nonsense")
    assert "nonsense" in line


def test_an_unknown_option_and_an_unknown_verb(capsys: pytest.CaptureFixture[str]) -> None:
    assert "--wrold" in refused(["explore", "--wrold", "lim_room"], capsys)
    assert "explor" in refused(["explor"], capsys)


def test_a_missing_map_to_compare(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    missing = str(tmp_path / "map.yaml")
    assert missing in refused(["compare", missing, "--world", "lim_room"], capsys)


def test_compare_wants_one_truth(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(["compare", str(tmp_path / "map.yaml")], capsys)
    assert "--world" in line
    assert "--truth" in line

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import wrap_to_pi
from mapping.io.tum import read_tum, write_tum


@given(
    start=st.floats(0.0, 2e9),
    poses=st.lists(
        st.tuples(st.floats(-99, 99), st.floats(-99, 99), st.floats(-3.14, 3.14)),
        min_size=1,
        max_size=5,
    ),
)
@settings(max_examples=30, deadline=None)
def test_a_trajectory_survives_being_written_and_read(
    tmp_path_factory: pytest.TempPathFactory,
    start: float,
    poses: list[tuple[float, float, float]],
) -> None:
    path = tmp_path_factory.mktemp("tum") / "a.tum"
    stamps = start + 0.1 * np.arange(len(poses))
    write_tum(path, stamps, poses)
    read = read_tum(path)
    # nine decimals are written; a stamp of today has less than seven in float64
    assert np.allclose(read.stamps, stamps, rtol=0.0, atol=1e-6)
    assert np.allclose(read.poses[:, :2], np.array(poses)[:, :2], rtol=0.0, atol=1e-9)
    assert np.allclose(wrap_to_pi(read.poses[:, 2] - np.array(poses)[:, 2]), 0.0, atol=1e-8)


def test_lines_are_as_evo_wants_them(tmp_path: Path) -> None:
    write_tum(tmp_path / "a.tum", [1.5], [[1.0, -2.0, np.pi / 2]])
    numbers = (tmp_path / "a.tum").read_text().splitlines()[0].split(" ")
    assert numbers[0] == "1.500000000"
    assert [float(n) for n in numbers[1:4]] == [1.0, -2.0, 0.0]
    half = np.sqrt(0.5)
    assert [float(n) for n in numbers[4:]] == pytest.approx([0.0, 0.0, half, half], abs=1e-9)


def test_comments_and_empty_lines_are_skipped(tmp_path: Path) -> None:
    (tmp_path / "a.tum").write_text("# t x y z q\n\n0 1 2 0 0 0 0 1\n1 2 2 0 0 0 1 0\n")
    read = read_tum(tmp_path / "a.tum")
    assert read.stamps.tolist() == [0.0, 1.0]
    assert np.allclose(read.poses, [[1, 2, 0], [2, 2, np.pi]])


@pytest.mark.parametrize(
    "text", ["0 1 2 0 0 0 1\n", "0 1 2 0 0 0 x 1\n", "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"]
)
def test_a_broken_file_is_told_in_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.tum").write_text(text)
    with pytest.raises(TestbedError, match=r"a\.tum") as error:
        read_tum(tmp_path / "a.tum")
    assert "\n" not in str(error.value)


def test_poses_that_are_not_finite_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="finite"):
        write_tum(tmp_path / "a.tum", [0.0], [[np.nan, 0.0, 0.0]])
    assert not (tmp_path / "a.tum").exists()

import os
from pathlib import Path
from typing import BinaryIO

import pytest

from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically


def test_a_file_is_written_and_nothing_else_is_left(tmp_path: Path) -> None:
    write_atomically(tmp_path / "a.txt", lambda file: file.write(b"whole"))
    assert (tmp_path / "a.txt").read_bytes() == b"whole"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_failure_half_way_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_bytes(b"old")

    def fail(file: BinaryIO) -> None:
        file.write(b"half")
        raise KeyError("stop")

    with pytest.raises(KeyError):
        write_atomically(path, fail)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_an_old_file_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"a much longer old content")
    write_atomically(tmp_path / "a", lambda file: file.write(b"new"))
    assert (tmp_path / "a").read_bytes() == b"new"


def test_the_file_gets_the_permissions_that_open_would_give(tmp_path: Path) -> None:
    write_atomically(tmp_path / "a", lambda file: file.write(b""))
    (tmp_path / "b").write_bytes(b"")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "b").stat().st_mode


@pytest.mark.parametrize("folder", ["missing", "a_file"])
def test_a_folder_that_cannot_be_written_is_told_in_one_line(tmp_path: Path, folder: str) -> None:
    (tmp_path / "a_file").write_bytes(b"")
    path = tmp_path / folder / "map.pgm"
    with pytest.raises(TestbedError, match=r"map\.pgm: cannot be written") as error:
        write_atomically(path, lambda file: file.write(b""))
    assert "\n" not in str(error.value)

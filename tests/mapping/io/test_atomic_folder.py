"""A folder is there whole or not at all."""

from pathlib import Path

import pytest

from mapping.errors import TestbedError
from mapping.io.atomic_folder import write_folder_atomically


def filled(text: str) -> object:
    def write(path: Path) -> None:
        path.mkdir()
        (path / "a.txt").write_text(text)

    return write


def test_a_new_folder_takes_the_place_of_the_old_one(tmp_path: Path) -> None:
    for text in ("old", "new"):
        write_folder_atomically(tmp_path / "folder", filled(text))
        assert (tmp_path / "folder" / "a.txt").read_text() == text
        assert [path.name for path in tmp_path.iterdir()] == ["folder"], "nothing else is left"


@pytest.mark.parametrize("reason", [KeyboardInterrupt, ValueError])
def test_a_folder_that_could_not_be_finished_leaves_the_old_one(
    tmp_path: Path, reason: type[BaseException]
) -> None:
    def fail(path: Path) -> None:
        path.mkdir()
        (path / "a.txt").write_text("half")
        raise reason

    write_folder_atomically(tmp_path / "folder", filled("old"))
    with pytest.raises(reason):
        write_folder_atomically(tmp_path / "folder", fail)
    assert (tmp_path / "folder" / "a.txt").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]


def test_a_new_folder_that_was_never_made_leaves_the_old_one(tmp_path: Path) -> None:
    write_folder_atomically(tmp_path / "folder", filled("old"))
    with pytest.raises(TestbedError, match="cannot be written"):
        write_folder_atomically(tmp_path / "folder", lambda path: None)
    assert (tmp_path / "folder" / "a.txt").read_text() == "old"


def test_a_place_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="cannot be written"):
        write_folder_atomically(tmp_path / "gone" / "folder", filled("new"))

from pathlib import Path

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.io.relations import read_relations

LINE = "976052905.167303 976052911.885496 -0.056990 -0.128430 0.000000 0.000000 0.000000 -1.682210"


def test_a_line_is_two_stamps_and_a_pose_of_which_the_plane_is_kept(tmp_path: Path) -> None:
    (tmp_path / "a.relations").write_text(f"# checked by hand\n\n{LINE}\n1 2 3 4 9 9 9 0.5\n")
    relations = read_relations(tmp_path / "a.relations")
    assert np.array_equal(relations.stamps, [[976052905.167303, 976052911.885496], [1.0, 2.0]])
    assert np.array_equal(relations.poses, [[-0.05699, -0.12843, -1.68221], [3.0, 4.0, 0.5]])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "no relation"),
        ("# only a comment\n", "no relation"),
        (f"{LINE}\n1 2 3 4 5 6 7\n", "line 2"),
        (f"{LINE} 9\n", "line 1"),
        ("1 2 3 4 5 6 7 east\n", "east"),
        ("1 2 nan 4 5 6 7 8\n", "finite"),
    ],
)
def test_a_broken_file_is_told_in_one_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "a.relations"
    path.write_text(text)
    with pytest.raises(TestbedError, match=told) as error:
        read_relations(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_a_file_that_cannot_be_read_is_told(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "a.relations"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(TestbedError, match=r"a\.relations: cannot be read"):
        read_relations(path)

"""Pictures of a map are saved as it was when they were asked for, while mapping goes on."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from evaluation.map_snapshots import MapSnapshots
from mapping.errors import TestbedError
from mapping.mappers import make_mapper


def test_pictures_show_the_moment_they_were_asked_for(tmp_path: Path) -> None:
    mapper = make_mapper("ogm")
    snapshots = MapSnapshots(tmp_path)
    pictures = []
    for rows in (40, 40, 200):
        mapper.grid.log_odds[:rows, :100] = 5.0
        pictures.append(snapshots.save(mapper, "a title"))
    mapper.grid.log_odds[:] = -5.0  # nothing of this is to be seen
    assert snapshots.close() == 3
    assert [file.name for file in pictures] == ["plot_001.png", "plot_002.png", "plot_003.png"]
    first, second, third = (np.asarray(Image.open(file)) for file in pictures)
    assert np.array_equal(first, second)
    assert third.shape != first.shape or not np.array_equal(first, third)


def test_pictures_of_an_earlier_run_are_taken_away(tmp_path: Path) -> None:
    for name in ("plot_001.png", "plot_002.png", "plot_of_mine.png"):
        (tmp_path / name).touch()
    MapSnapshots(tmp_path).close()
    assert [file.name for file in tmp_path.iterdir()] == ["plot_of_mine.png"]


def test_a_picture_that_cannot_be_written_is_told_in_the_end(tmp_path: Path) -> None:
    folder = tmp_path / "gone"
    snapshots = MapSnapshots(folder)
    snapshots.save(make_mapper("ogm"), "a title")
    with pytest.raises(TestbedError, match="gone"):
        snapshots.close()

"""Saves pictures of a map while mapping goes on: a copy is drawn, in a thread of its own."""

from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from mapping.io.map_server import MapFile
from mapping.mapper import Mapper
from mapping.plot import save_map_picture

NAME = "plot_{:03d}.png"
"""Name of the n-th picture."""


class MapSnapshots:
    """Numbered pictures in a folder, from 1 on; close it to have them all.

    Making it takes away the pictures of an earlier run, which would pass for this one's.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._saved: list[Future[None]] = []
        self._thread = ThreadPoolExecutor(max_workers=1)
        for earlier in folder.glob("plot_[0-9]*.png"):
            earlier.unlink()

    def save(self, mapper: Mapper, title: str) -> Path:
        """Begin to save the map as it is now, with the path so far; returns where to."""
        grid = mapper.grid
        file = self._folder / NAME.format(len(self._saved) + 1)
        copy = MapFile(
            resolution=grid.resolution,
            origin=(float(grid.origin[0]), float(grid.origin[1])),
            states=grid.states(),
        )
        path = mapper.trajectory.poses[:, :2].copy()
        saving = self._thread.submit(save_map_picture, file, copy, path=path, title=title)
        self._saved.append(saving)
        return file

    def close(self) -> int:
        """Wait for the last; returns how many there are.

        Raises:
            TestbedError: One could not be written.
        """
        self._thread.shutdown()
        for saving in self._saved:
            saving.result()
        return len(self._saved)

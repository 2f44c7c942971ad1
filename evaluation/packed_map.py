"""Packs maps into a hundredth of their size, to keep many of one that grows."""

import zlib
from dataclasses import dataclass

import numpy as np

from mapping.io.map_server import MapFile


@dataclass(frozen=True, slots=True, kw_only=True)
class PackedMap:
    """A map in a hundredth of its size."""

    time: float
    """When it was so [s]."""
    resolution: float
    origin: tuple[float, float]
    shape: tuple[int, ...]
    states: bytes

    @classmethod
    def of(cls, time: float, drawn: MapFile) -> "PackedMap":
        """The map as it is at a time [s]."""
        states = zlib.compress(drawn.states.tobytes(), level=1)
        return cls(
            time=time,
            resolution=drawn.resolution,
            origin=drawn.origin,
            shape=drawn.states.shape,
            states=states,
        )

    def unpack(self) -> MapFile:
        """The map again."""
        states = np.frombuffer(zlib.decompress(self.states), dtype=np.int8).reshape(self.shape)
        return MapFile(resolution=self.resolution, origin=self.origin, states=states)

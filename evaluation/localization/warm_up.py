"""Tells the numba kernels that a localiser needs, and the short run that calls them all."""

from pathlib import Path

import numpy as np

from envs.truth import truth_of_plan
from evaluation.kernels.kernel_set import KernelSet
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.localization.config import LocalizationConfig
from evaluation.localization.run import run_localization
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile
from mapping.localization.localizers import FilterName

RESOLUTION = 0.05
"""Edge of a cell of the map that is localised on [m]."""

TIME = 3.0
"""So long a run calls every kernel [s]."""


def kernels_of_localizer(name: FilterName) -> KernelSet:
    """All that runs with a localiser need."""
    return KernelSet(
        owner=f"filter {name}", kind=f"{name}-localize", call=lambda: _localize_in_a_tiny_room(name)
    )


def tiny_map() -> MapFile:
    """A perfect map of the tiny room."""
    truth = truth_of_plan(TINY_ROOM, resolution=RESOLUTION)
    states = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    states[truth.visible_free] = FREE
    states[truth.visible_surface] = OCCUPIED
    return MapFile(resolution=truth.resolution, origin=truth.origin, states=states)


def _localize_in_a_tiny_room(name: FilterName) -> None:
    config = LocalizationConfig(
        map=Path("tiny_room.yaml"), world="tiny_room", filter=name, start="known", time_limit=TIME
    )
    run_localization(config, plan=TINY_ROOM, map_file=tiny_map())

"""Compiles the numba kernels that a localiser needs, so that no measured update pays for it."""

from pathlib import Path

import numpy as np

from envs.truth import truth_of_plan
from evaluation.kernel_cache import is_compiled, note_kernels
from evaluation.localization_run import LocalizationConfig, run_localization
from evaluation.warm_up import TINY_ROOM
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile
from mapping.localization.localizers import FilterName

RESOLUTION = 0.05
"""Edge of a cell of the map that is localised on [m]."""

TIME = 3.0
"""So long a run calls every kernel [s]."""


def is_warm(name: FilterName) -> bool:
    """Whether all that runs with a localiser need is compiled."""
    return is_compiled(_kind(name))


def compile_localizer(name: FilterName) -> None:
    """Localise in a tiny room; numba keeps what it compiles for the next process."""
    config = LocalizationConfig(
        map=Path("tiny_room.yaml"), world="tiny_room", filter=name, start="known", time_limit=TIME
    )
    run_localization(config, plan=TINY_ROOM, map_file=tiny_map())
    note_kernels(_kind(name))


def tiny_map() -> MapFile:
    """A perfect map of the tiny room."""
    truth = truth_of_plan(TINY_ROOM, resolution=RESOLUTION)
    states = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    states[truth.visible_free] = FREE
    states[truth.visible_surface] = OCCUPIED
    return MapFile(resolution=truth.resolution, origin=truth.origin, states=states)


def _kind(name: FilterName) -> str:
    return f"{name}-localize"

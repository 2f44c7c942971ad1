"""Records the two drives and maps each with every mapper that a figure needs, in processes."""

import signal
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

from evaluation.episode_pool import START_METHOD
from evaluation.thesis.config import ThesisConfig
from evaluation.thesis.drive import Drive, record_drive
from evaluation.thesis.map_run import MapRun, MapSpec, run_map
from mapping.errors import TestbedError

EVERY_PERIOD = ("linearUpdate=0", "angularUpdate=0")
"""GMapping's thresholds of motion set aside: it updates whenever its period is over."""

AT_HALF_HERTZ = ("update_interval=2.0", *EVERY_PERIOD)
AT_TWO_HERTZ = ("update_interval=0.5", *EVERY_PERIOD)
"""The thesis's two update rates of GMapping, 0.5 Hz and at most 2 Hz (5.2)."""

OWN_MAPPERS = ("graph", "scan_match", "ogm")
"""This project's own, shown beside fig. 5.11."""

SPECS: dict[str, MapSpec] = {
    "hallway_gmapping": MapSpec(
        drive="hallway", until="farthest", mapper="gmapping", settings=AT_TWO_HERTZ
    ),
    "hallway_gmapping_slow": MapSpec(
        drive="hallway", until="farthest", mapper="gmapping", settings=AT_HALF_HERTZ
    ),
    "room_gmapping": MapSpec(drive="room", until="end", mapper="gmapping", settings=AT_TWO_HERTZ),
    "back_gmapping": MapSpec(
        drive="hallway", until="end", mapper="gmapping", settings=AT_TWO_HERTZ
    ),
    **{
        f"back_{mapper}": MapSpec(drive="hallway", until="end", mapper=mapper)
        for mapper in OWN_MAPPERS
    },
    "hallway": MapSpec(drive="hallway", until="farthest", mapper="occgridmapp"),
    "room": MapSpec(drive="room", until="end", mapper="occgridmapp"),
    "back": MapSpec(drive="hallway", until="end", mapper="occgridmapp"),
    "turn": MapSpec(drive="hallway", until="turned", mapper="occgridmapp"),
    "turn_ungated": MapSpec(
        drive="hallway", until="turned", mapper="occgridmapp", settings=("turn_gate=none",)
    ),
}
"""Every map that a figure shows, by the name that the figures use; the slow ones first."""

STEPS = 2 + len(SPECS)
"""How many drives and maps there are."""

Told = Callable[[str], None]
"""Told what is done."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Runs:
    """All that the figures are made of."""

    drives: Mapping[str, Drive]
    """``hallway`` and ``room``."""
    maps: Mapping[str, MapRun]
    """The maps by the names in SPECS."""

    def of(self, name: str) -> tuple[Drive, MapRun]:
        """A map and the drive that it is of."""
        return self.drives[SPECS[name].drive], self.maps[name]


def regenerate(config: ThesisConfig, *, processes: int = 2, on_done: Told | None = None) -> Runs:
    """Record both drives, then map each as soon as it is there.

    Args:
        config: What to drive.
        processes: How many work at the same time.
        on_done: Called after each drive and each map with its name.

    Raises:
        TestbedError: A drive or mapper cannot be run as told, ``processes`` is not positive, or a
            process was killed from outside, as when memory runs out.
    """
    if processes < 1:
        raise TestbedError(f"jobs: {processes}; must be 1 or more")
    context = get_context(START_METHOD)
    context.set_forkserver_preload([__name__])
    pool = ProcessPoolExecutor(
        max_workers=processes, mp_context=context, initializer=_end_at_ctrl_c
    )
    try:
        return _run_all(config, pool, on_done)
    except BrokenProcessPool as error:
        raise TestbedError(f"a process died ({error}); memory for {processes} is needed") from error
    finally:
        pool.shutdown(cancel_futures=True)


def _end_at_ctrl_c() -> None:
    """Let Ctrl-C, which reaches every process of a terminal, end this one without a traceback."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _run_all(config: ThesisConfig, pool: ProcessPoolExecutor, on_done: Told | None) -> Runs:
    """Give the pool the drives, then of each drive that ends the maps."""
    drives: dict[str, Drive] = {}
    maps: dict[str, MapRun] = {}
    asked = ((name, getattr(config, name)) for name in ("hallway", "room"))
    waiting: dict[Future[Any], str] = {
        pool.submit(record_drive, episode): name for name, episode in asked
    }
    while waiting:
        for future in wait(waiting, return_when=FIRST_COMPLETED).done:
            name, done = waiting.pop(future), future.result()
            if isinstance(done, Drive):
                drives[name] = done
                for key, spec in SPECS.items():
                    if spec.drive == name:
                        waiting[pool.submit(run_map, done, spec)] = key
            else:
                maps[name] = done
            if on_done is not None:
                on_done(name)
    return Runs(drives=drives, maps={name: maps[name] for name in SPECS})

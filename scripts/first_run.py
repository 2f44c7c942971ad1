"""Tells the user why the first run takes longer, and gets it over with."""

import sys

from evaluation.kernel_cache import forget_stale_kernels
from evaluation.warm_up import compile_kernels, is_warm
from mapping.mappers import MAPPERS


def compile_if_needed(mapper: str, *, simulates: bool) -> None:
    """Compile what runs with a mapper need now if it is not, saying so on stderr.

    Args:
        mapper: Its name; nothing is done for one that there is not, which the run will tell.
        simulates: Whether an episode is run, or else a log mapped.
    """
    if mapper not in MAPPERS:
        return
    forget_stale_kernels()
    if not is_warm(mapper, simulates=simulates):
        print(
            f"compiling the kernels of mapper {mapper}, once: up to a minute ...",
            file=sys.stderr,
            flush=True,
        )
        compile_kernels(mapper, simulates=simulates)

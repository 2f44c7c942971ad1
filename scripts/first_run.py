"""Tells the user why the first run takes longer, and gets it over with."""

import sys
from collections.abc import Callable

from evaluation.kernel_cache import forget_stale_kernels
from evaluation.warm_up import compile_kernels, is_warm


def compile_if_needed(
    mapper: str, *, simulates: bool, check: Callable[[], None] | None = None
) -> None:
    """Compile what runs with a mapper need now if it is not, saying so on stderr.

    Args:
        mapper: Its name.
        simulates: Whether an episode is run, or else a log mapped.
        check: Raises what the run would, if that is not known yet: nobody waits a minute to be
            told of a typing error.

    Raises:
        TestbedError: What ``check`` raises, before anything is said or compiled.
    """
    forget_stale_kernels()
    if not is_warm(mapper, simulates=simulates):
        if check is not None:
            check()
        print(
            f"compiling the kernels of mapper {mapper}, once: up to a minute ...",
            file=sys.stderr,
            flush=True,
        )
        compile_kernels(mapper, simulates=simulates)

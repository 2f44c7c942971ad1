"""Tells the user why the first run takes longer, and gets it over with."""

import sys
from collections.abc import Callable

from evaluation.kernels.cache import forget_stale_kernels
from evaluation.kernels.kernel_set import KernelSet


def compile_if_needed(kernels: KernelSet, check: Callable[[], None] | None = None) -> None:
    """Compile the kernels of a run now if they are not, saying so on stderr.

    Args:
        kernels: What the run needs.
        check: Raises what the run would, if that is not known yet: nobody waits a minute to be
            told of a typing error.

    Raises:
        TestbedError: What ``check`` raises, before anything is said or compiled.
    """
    forget_stale_kernels()
    if kernels.is_ready:
        return
    if check is not None:
        check()
    print(
        f"compiling the kernels of {kernels.owner}, once: up to a minute ...",
        file=sys.stderr,
        flush=True,
    )
    kernels.compile()

"""Tells the user why the first run takes longer, and gets it over with."""

import sys

from evaluation.warm_up import compile_kernels, kernel_cache


def compile_if_needed() -> None:
    """Compile the kernels now if they are not, saying so on stderr."""
    cache = kernel_cache()
    if cache.is_cold:
        missing = cache.total - cache.compiled
        print(
            f"compiling {missing} of {cache.total} kernel files, once: about a minute ...",
            file=sys.stderr,
            flush=True,
        )
        compile_kernels()

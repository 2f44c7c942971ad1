"""Holds Ctrl-C back until a loop asks for it.

Raised in the middle of compiled code it comes out as another error, and a mapper that was broken
off in the middle of a scan has no map to save.
"""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType


@contextmanager
def held_interrupt() -> Iterator[Callable[[], None]]:
    """Within it Ctrl-C is raised only where what it yields is called, at its end, and by a second.

    Where Ctrl-C does not raise KeyboardInterrupt, in threads and where it is ignored, nothing is
    changed.
    """
    pressed = False

    def note(_signal: int, _frame: FrameType | None) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    if current_thread() is not main_thread() or (
        signal.getsignal(signal.SIGINT) is not signal.default_int_handler
    ):
        yield check
        return
    signal.signal(signal.SIGINT, note)
    try:
        yield check
        check()
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)

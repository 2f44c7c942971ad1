"""Has a terminal send every key at once, and gives it back as it was, whatever happens."""

import atexit
import os
import select
import signal
import termios
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

ENDINGS = (signal.SIGTERM, signal.SIGHUP)
"""Signals that end a process before it can clean up; here they do what Ctrl-C does."""

MOST_BYTES = 1024
"""Read at once: more keys than anybody types in a control period."""


@contextmanager
def raw_terminal(terminal: int, on_resume: Callable[[], object] = lambda: None) -> Iterator[None]:
    """Let keys come at once and unechoed from a terminal.

    Ctrl-C still raises KeyboardInterrupt, and so do SIGTERM and SIGHUP; Ctrl-Z still stops.

    Args:
        terminal: Its file descriptor.
        on_resume: Called when the process goes on after a stop, with the mode set again.
    """
    before = termios.tcgetattr(terminal)

    def give_back() -> None:
        with suppress(termios.error):  # the terminal may be gone
            termios.tcsetattr(terminal, termios.TCSAFLUSH, before)

    def take_again(_signal: int, _frame: FrameType | None) -> None:
        tty.setcbreak(terminal, termios.TCSANOW)  # a flush could take what select has announced
        on_resume()

    atexit.register(give_back)
    handlers = {ending: signal.signal(ending, _interrupt) for ending in ENDINGS}
    handlers[signal.SIGCONT] = signal.signal(signal.SIGCONT, take_again)
    try:
        tty.setcbreak(terminal, termios.TCSANOW)
        yield
    finally:
        give_back()
        for number, handler in handlers.items():
            signal.signal(number, handler)
        atexit.unregister(give_back)


def read_keys(terminal: int, timeout: float) -> bytes | None:
    """The bytes that came within a time [s], maybe none; None when the terminal is gone."""
    ready, _, _ = select.select([terminal], [], [], timeout)
    if not ready:
        return b""
    try:
        return os.read(terminal, MOST_BYTES) or None
    except OSError:  # how Linux says that the other end was closed
        return None


def _interrupt(_signal: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt

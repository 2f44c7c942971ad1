"""A command in a terminal of its own, as a person would have it: keys in, what is shown out."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
from pathlib import Path
from time import monotonic
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 60.0
"""What does not show up within this time [s] will not: a loaded machine takes 10 to start."""

HIDDEN = ("DISPLAY", "WAYLAND_DISPLAY", "COLUMNS", "LINES")
"""Variables that would tell the command of another screen or terminal."""


class Terminal:
    """A pseudo-terminal with a command in it; the test holds both ends, so it can see the mode."""

    def __init__(self, words: list[str], **environment: str) -> None:
        self._keyboard, self._child_end = pty.openpty()
        fcntl.ioctl(self._keyboard, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 100, 0, 0))
        self._before = termios.tcgetattr(self._child_end)
        self.shown = ""
        inherited = {key: value for key, value in os.environ.items() if key not in HIDDEN}
        self._child = subprocess.Popen(
            [sys.executable, "-m", "scripts", *words],
            cwd=ROOT,
            env={**inherited, "PYTHONIOENCODING": "utf-8", **environment},
            stdin=self._child_end,
            stdout=self._child_end,
            stderr=self._child_end,
            start_new_session=True,
            preexec_fn=_have_own_terminal,
        )

    @property
    def process(self) -> int:
        """The id of the command's process."""
        return self._child.pid

    @property
    def is_as_before(self) -> bool:
        """Whether the terminal's mode is what it was before the command."""
        return termios.tcgetattr(self._child_end) == self._before

    @property
    def echoes(self) -> bool:
        """Whether what is typed is shown."""
        flags: list[Any] = termios.tcgetattr(self._child_end)
        return bool(flags[3] & termios.ECHO)

    def press(self, keys: str) -> None:
        """Type."""
        os.write(self._keyboard, keys.encode())

    def wait_for(self, pattern: str) -> str:
        """Wait until something new matches a regular expression; returns what did."""
        start, give_up = len(self.shown), monotonic() + PATIENCE
        while True:
            found = re.search(pattern, self.shown[start:])
            if found is not None:
                return found.group()
            waiting = monotonic() < give_up and self._child.poll() is None
            assert waiting, f"no {pattern!r} in {self.shown[-3000:]}"
            self._take(0.05)

    def end(self) -> int:
        """Wait until the command has ended; returns its exit status."""
        give_up = monotonic() + PATIENCE
        while self._child.poll() is None:
            assert monotonic() < give_up, f"did not end: {self.shown[-3000:]}"
            self._take(0.05)
        while self._take(0.05):
            pass
        return int(self._child.returncode)

    def close(self) -> None:
        """End the command if it has not ended, and take the terminal away."""
        self._child.kill()
        self._child.wait()
        os.close(self._child_end)
        os.close(self._keyboard)

    def __enter__(self) -> "Terminal":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _take(self, timeout: float) -> bool:
        """Take what is shown now; whether there was something."""
        if not select.select([self._keyboard], [], [], timeout)[0]:
            return False
        self.shown += os.read(self._keyboard, 65536).decode(errors="replace")
        return True


def _have_own_terminal() -> None:
    """Make stdin the terminal that Ctrl-C comes from, and have it heard.

    Whoever runs the tests in the background may have them ignore it, and children inherit that.
    """
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    signal.signal(signal.SIGINT, signal.SIG_DFL)

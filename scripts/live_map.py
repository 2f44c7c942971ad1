"""Shows a growing map on a terminal, drawn over itself a few times a second."""

import shutil
import sys
from collections.abc import Sequence
from time import monotonic

from evaluation.progress import Progress
from mapping.text_map import text_map
from scripts.arguments import is_terminal

REDRAW_EVERY = 0.1
"""Wall time between two drawings [s], at least."""
MOST_SHARE = 0.2
"""Share of the wall time that drawing takes, at most: large maps are drawn less often."""
REDRAW_WITHIN = 1.0
"""Wall time after which there is another drawing [s], whatever the last one took."""
MOST_COLUMNS, MOST_LINES = 100, 28
"""Size that the map never exceeds, however large the terminal."""
RESERVED_LINES = 4
"""Lines left for the status line, the prompt and what was there before."""


def can_draw() -> bool:
    """Whether somebody watches stderr, on a terminal that knows block characters."""
    return is_terminal() and "utf" in (sys.stderr.encoding or "").lower()


class LiveMap:
    """Draws on stderr; the last drawing stays."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._started = monotonic()
        self._next = self._started + REDRAW_EVERY
        self._lines = 0

    @property
    def is_due(self) -> bool:
        """Whether the last drawing is old enough for another."""
        return monotonic() >= self._next

    def show(self, progress: Progress) -> None:
        """Draw how the episode stands, unless that was done just now."""
        if self.is_due:
            self.draw(progress)

    def draw(self, progress: Progress, status: Sequence[str] = ()) -> None:
        """Draw over the last drawing, with a status of one's own below the map if one is given."""
        began = monotonic()
        size = shutil.get_terminal_size()
        columns = min(size.columns - 1, MOST_COLUMNS)
        lines = text_map(
            progress.grid,
            progress.pose_map,
            max(columns, 1),
            max(min(size.lines - RESERVED_LINES, MOST_LINES), 1),
        )
        status = status or (
            f"{self._title}: {progress.time:.0f} s simulated, "
            f"{monotonic() - self._started:.1f} s real, coverage {progress.coverage:.1%}",
        )
        back = f"\033[{self._lines}A" if self._lines else ""
        drawing = [*lines, *(line[: max(columns, 1)] for line in status)]
        text = "".join(f"\033[2K{line}\n" for line in drawing)
        sys.stderr.write(f"{back}\033[J{text}")
        sys.stderr.flush()
        self._lines = len(drawing)
        ended = monotonic()
        pause = max(REDRAW_EVERY, (ended - began) / MOST_SHARE)
        self._next = ended + min(pause, REDRAW_WITHIN)

"""Keeps the frontiers that were given up, and why, and gives each another chance at the end."""

from collections.abc import Sequence
from dataclasses import dataclass

from nav.frontier import Frontier
from nav.navigator import DroppedFrontier

SAME_PLACE = 0.35
"""A frontier this close to one that was given up counts as that one [m]."""

GIVEN_UP, DISAPPOINTED = 1.0, 0.5
"""What counts as once given up: two disappointments do."""


@dataclass(slots=True)
class _Record:
    frontier: Frontier
    reason: str
    times: float = 0.0


class GivenUp:
    """Frontiers given up so far, by place."""

    def __init__(self) -> None:
        self._records: list[_Record] = []
        self._chances = 1

    def give_up(self, frontier: Frontier, reason: str) -> None:
        """Leave a frontier alone, for now or, after its last chance, for good."""
        self._add(frontier, reason, GIVEN_UP)

    def disappoint(self, frontier: Frontier, reason: str) -> None:
        """Note that a viewpoint of it was of no use; the second such leads to giving up."""
        self._add(frontier, reason, DISAPPOINTED)

    def holds(self, frontier: Frontier) -> bool:
        """Whether a frontier is to be left alone now."""
        record = self._find(frontier)
        return record is not None and record.times >= self._chances

    def another_chance(self, most: int) -> bool:
        """Let every frontier be tried once more; False after ``most`` tries or when none waits."""
        if self._chances >= most or not self._records:
            return False
        self._chances += 1
        return True

    def left_over(
        self, frontiers: Sequence[Frontier], otherwise: str | None = None
    ) -> tuple[DroppedFrontier, ...]:
        """Those of ``frontiers``, the ones still there, that were given up, with the reason.

        The others are among them too if there is a reason for them, ``otherwise``.
        """
        reasons = [(frontier, self._reason(frontier) or otherwise) for frontier in frontiers]
        return tuple(
            DroppedFrontier(
                x=float(frontier.middle[0]),
                y=float(frontier.middle[1]),
                size_m=float(frontier.size),
                reason=reason,
            )
            for frontier, reason in reasons
            if reason is not None
        )

    def _reason(self, frontier: Frontier) -> str | None:
        """Why a frontier was given up, None if it was not."""
        record = self._find(frontier)
        return record.reason if record is not None and record.times >= GIVEN_UP else None

    def _add(self, frontier: Frontier, reason: str, times: float) -> None:
        record = self._find(frontier)
        if record is None:
            record = _Record(frontier, reason)
            self._records.append(record)
        record.times, record.reason = record.times + times, reason

    def _find(self, frontier: Frontier) -> _Record | None:
        for record in self._records:
            if record.frontier.distance_to(frontier.middle) < SAME_PLACE:
                return record
        return None

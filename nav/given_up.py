"""Keeps the frontiers that were given up, and why, and gives each another chance at the end."""

from collections.abc import Sequence
from dataclasses import dataclass

from nav.frontier import Frontier
from nav.navigator import DroppedFrontier
from nav.viewpoint import Viewpoint

SAME_PLACE = 0.35
"""A frontier this close to one that was given up counts as that one [m]."""

GIVEN_UP, DISAPPOINTED = 1.0, 0.5
"""What counts as once given up: two disappointments do."""

MORE = 1.5
"""A viewpoint must promise so many times as much as one that showed nothing to be another one."""


@dataclass(slots=True)
class _Record:
    frontier: Frontier
    reason: str
    times: float = 0.0
    promised: float = 0.0


class GivenUp:
    """Frontiers given up so far, by place."""

    def __init__(self) -> None:
        self._records: list[_Record] = []
        self._chances = 1

    def give_up(self, frontier: Frontier, reason: str) -> None:
        """Leave a frontier alone, for now or, after its last chance, for good."""
        self._add(frontier, reason, GIVEN_UP)

    def disappoint(self, viewpoint: Viewpoint, reason: str) -> None:
        """Note that a viewpoint was of no use; the second of a frontier leads to giving it up.

        That is, the second when no other place promised more: a robot before a doorway shall look
        through it, however often it has looked from beside it.
        """
        record = self._add(viewpoint.frontier, reason, 0.0)
        record.promised = max(record.promised, viewpoint.gain)
        if viewpoint.rival <= MORE * record.promised:
            record.times += DISAPPOINTED

    def not_in_vain(self, viewpoints: Sequence[Viewpoint]) -> list[Viewpoint]:
        """The viewpoints without those that promise no more than one that showed nothing did.

        Of a frontier all of whose viewpoints are such, all stay: each is another chance.
        """
        promising = [item.gain > MORE * self._promised(item.frontier) for item in viewpoints]
        others = {
            id(item.frontier)
            for item, is_promising in zip(viewpoints, promising, strict=True)
            if is_promising
        }
        return [
            item
            for item, is_promising in zip(viewpoints, promising, strict=True)
            if is_promising or id(item.frontier) not in others
        ]

    def _promised(self, frontier: Frontier) -> float:
        """The most that a viewpoint of a frontier promised in vain [m2]."""
        record = self._find(frontier)
        return 0.0 if record is None else record.promised

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

        The others are among them too if there is a reason for them, ``otherwise``. What counts as
        one, a border and the opening in it, is told once, the first of them.
        """
        told: list[Frontier] = []
        for frontier in frontiers:
            if all(other.distance_to(frontier.middle) >= SAME_PLACE for other in told):
                told.append(frontier)
        reasons = [(frontier, self.reason(frontier) or otherwise) for frontier in told]
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

    def reason(self, frontier: Frontier) -> str | None:
        """Why a frontier was given up, None if it was not."""
        record = self._find(frontier)
        return record.reason if record is not None and record.times >= GIVEN_UP else None

    def _add(self, frontier: Frontier, reason: str, times: float) -> _Record:
        record = self._find(frontier)
        if record is None:
            record = _Record(frontier, reason)
            self._records.append(record)
        record.times, record.reason = record.times + times, reason
        return record

    def _find(self, frontier: Frontier) -> _Record | None:
        for record in self._records:
            if record.frontier.distance_to(frontier.middle) < SAME_PLACE:
                return record
        return None

"""Decides by numbers whether what the thesis saw in a figure was seen again."""

import operator
from dataclasses import dataclass
from typing import Literal

from mapping.errors import TestbedError

Relation = Literal[">=", "<=", ">", "<", "=="]
Verdict = Literal["seen again", "seen in part", "not seen"]

_HOLDS = {
    ">=": operator.ge,
    "<=": operator.le,
    ">": operator.gt,
    "<": operator.lt,
    "==": operator.eq,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One criterion: a figure of the run, and what it must be."""

    claim: str
    """What the thesis saw, in a few words."""
    measure: str
    """What is measured."""
    value: float
    """What came out."""
    relation: Relation
    bound: float
    unit: str = ""
    """Unit of value and bound; ``%`` shows shares as percentages."""
    why_not: str = ""
    """Why it may not hold here; told only if it does not."""

    def __post_init__(self) -> None:
        """Refuse a relation that there is not."""
        if self.relation not in _HOLDS:
            raise TestbedError(f"relation: {self.relation!r}; must be one of {', '.join(_HOLDS)}")

    @property
    def holds(self) -> bool:
        """Whether the figure is what it must be; NaN never is."""
        return bool(_HOLDS[self.relation](self.value, self.bound))

    @property
    def shown_value(self) -> str:
        """The value with its unit."""
        return shown(self.value, self.unit)

    @property
    def shown_bound(self) -> str:
        """What it must be, with its unit."""
        signs = {">=": "at least", "<=": "at most", ">": "above", "<": "below", "==": "exactly"}
        return f"{signs[self.relation]} {shown(self.bound, self.unit)}"


def verdict_of(checks: tuple[Check, ...]) -> Verdict:
    """All criteria hold: seen again; some: seen in part; none: not seen.

    Raises:
        TestbedError: There is no criterion, so nothing can be decided.
    """
    if not checks:
        raise TestbedError("checks: none; a verdict must have one at least")
    held = sum(check.holds for check in checks)
    if held == len(checks):
        return "seen again"
    return "seen in part" if held else "not seen"


def shown(value: float, unit: str = "") -> str:
    """A figure as the page shows it: three significant digits, whole numbers whole."""
    if unit == "yes":
        return "yes" if value else "no"
    if unit == "%":
        return f"{100.0 * value:.1f} %"
    digits = f"{value:.0f}" if abs(value) >= 100.0 or value == int(value) else f"{value:.3g}"
    return f"{digits} {unit}".strip()

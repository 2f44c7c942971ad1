"""Verdicts: decided by numbers, never by words."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evaluation.thesis.verdict import Check, verdict_of
from mapping.errors import TestbedError


def check(value: float, relation: str, bound: float) -> Check:
    return Check(
        claim="a claim",
        measure="a measure",
        value=value,
        relation=relation,  # type: ignore[arg-type]
        bound=bound,
    )


@pytest.mark.parametrize(
    ("value", "relation", "bound", "holds"),
    [
        (1.0, ">=", 1.0, True),
        (0.9, ">=", 1.0, False),
        (1.0, ">", 1.0, False),
        (1.0, "<=", 1.0, True),
        (1.1, "<=", 1.0, False),
        (1.0, "<", 1.0, False),
        (3, "==", 3, True),
        (2, "==", 3, False),
        (True, "==", 1, True),
        (math.nan, ">=", 0.0, False),
        (math.nan, "<", 0.0, False),
    ],
)
def test_a_criterion_holds_as_its_relation_says(
    value: float, relation: str, bound: float, holds: bool
) -> None:
    assert check(value, relation, bound).holds is holds


@given(st.lists(st.booleans(), min_size=1, max_size=6))
def test_a_verdict_counts_the_criteria_that_hold(held: list[bool]) -> None:
    verdict = verdict_of(tuple(check(float(each), "==", 1.0) for each in held))
    expected = "seen again" if all(held) else "seen in part" if any(held) else "not seen"
    assert verdict == expected


def test_no_criterion_gives_no_verdict() -> None:
    with pytest.raises(TestbedError, match="must have one at least"):
        verdict_of(())


def test_an_unknown_relation_is_refused() -> None:
    with pytest.raises(TestbedError, match="must be one of >="):
        check(1.0, "~", 1.0)


def test_shares_are_shown_as_percentages_and_yes_as_a_word() -> None:
    share = Check(claim="", measure="", value=0.125, relation="<=", bound=0.5, unit="%")
    assert (share.shown_value, share.shown_bound) == ("12.5 %", "at most 50.0 %")
    word = Check(claim="", measure="", value=True, relation="==", bound=1, unit="yes")
    assert (word.shown_value, word.shown_bound) == ("yes", "exactly yes")

"""Ctrl-C waits until a loop asks for it."""

import signal
from collections.abc import Iterator

import pytest

from evaluation.held_interrupt import held_interrupt


@pytest.fixture(autouse=True)
def ctrl_c_raises() -> Iterator[None]:
    """As in a terminal: a test run in the background may ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def press(times: int, asked: list[bool]) -> None:
    """Press Ctrl-C in a loop that asks for it afterwards."""
    with held_interrupt() as check:
        check()
        for _ in range(times):
            signal.raise_signal(signal.SIGINT)
        asked.append(True)
        check()


def test_ctrl_c_waits_until_the_loop_asks_and_is_as_before_afterwards() -> None:
    asked: list[bool] = []
    with pytest.raises(KeyboardInterrupt):
        press(1, asked)
    assert asked
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_a_second_ctrl_c_does_not_wait() -> None:
    asked: list[bool] = []
    with pytest.raises(KeyboardInterrupt):
        press(2, asked)
    assert not asked


def test_where_ctrl_c_is_ignored_it_stays_so() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with held_interrupt() as check:
        signal.raise_signal(signal.SIGINT)
        check()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN

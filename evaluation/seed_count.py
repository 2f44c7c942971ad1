"""Refuses counts of seeds that are none, or a slip."""

from mapping.errors import TestbedError

MOST_SEEDS = 100_000
"""More than a month's runs of one processor, of a minute each."""


def check_seed_count(count: int) -> None:
    """Refuse a count below 1 or above MOST_SEEDS.

    Raises:
        TestbedError: It is one of these.
    """
    if not 1 <= count <= MOST_SEEDS:
        raise TestbedError(f"seeds: {count}; must be 1 to {MOST_SEEDS}")

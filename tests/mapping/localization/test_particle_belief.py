"""What of a scan particles can bear: enough of them must keep weight."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.filters.resampling import effective_number
from mapping.localization.particle_belief import bearable_share


@given(st.integers(0, 10_000), st.floats(0.1, 200.0), st.floats(5.0, 80.0))
def test_enough_particles_keep_weight_and_no_more_is_left_out_than_that_takes(
    seed: int, sharpness: float, enough: float
) -> None:
    rng = np.random.default_rng(seed)
    logs = -sharpness * rng.random(200)
    weights = rng.dirichlet(np.full(200, 5.0))
    share = bearable_share(logs, weights, enough)
    assert 0.0 <= share <= 1.0

    def left(part: float) -> float:
        return effective_number(weights * np.exp(part * logs))

    assert left(share) >= enough - 1e-9
    if share < 1.0:
        assert left(share + 1e-3) < enough, "a little more would have been too much"


def test_a_blunt_scan_is_used_in_full_and_one_sharp_peak_is_not_taken_at_its_word() -> None:
    weights = np.full(100, 0.01)
    assert bearable_share(np.zeros(100), weights, 50.0) == 1.0
    lucky = np.append(np.zeros(99), 30.0)
    share = bearable_share(lucky, weights, 50.0)
    assert share < 0.15
    assert bearable_share(lucky, weights, 1000.0) == pytest.approx(share, abs=1e-3), "half of 100"

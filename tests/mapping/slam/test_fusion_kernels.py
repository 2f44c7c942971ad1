import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.slam.fusion_kernels import STATES, correct, keep_rates, move, turn_between

GAP = 0.1


def readings(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    stamps = 1.0 + np.cumsum(rng.uniform(0.001, 0.09, count))
    return np.column_stack((stamps, rng.uniform(-2.0, 2.0, count)))


@given(
    seed=st.integers(0, 10_000), count=st.integers(2, 30), shares=st.tuples(*[st.floats(0, 1)] * 2)
)
def test_the_turn_is_the_area_under_the_line_through_the_readings(
    seed: int, count: int, shares: tuple[float, float]
) -> None:
    rates = readings(np.random.default_rng(seed), count)
    first, last = rates[0, 0] - 0.05, rates[-1, 0] + 0.05
    begin, end = sorted(first + np.array(shares) * (last - first))
    angle, squares, fastest, is_covered = turn_between(rates, begin, end, GAP)
    inside = rates[(rates[:, 0] > begin) & (rates[:, 0] < end), 0]
    knots = np.concatenate(([begin], inside, [end]))
    heights = np.interp(knots, rates[:, 0], rates[:, 1])  # holds the ends, as the kernel does
    assert is_covered
    assert angle == pytest.approx(np.trapezoid(heights, knots), abs=1e-12)
    assert squares == pytest.approx(np.sum(np.diff(knots) ** 2), abs=1e-12)
    if end > begin:
        assert fastest == pytest.approx(np.abs(heights).max())


@pytest.mark.parametrize(
    ("stamps", "begin", "end"),
    [
        ([], 0.0, 0.1),
        ([0.2], 0.05, 0.2),
        ([0.0], 0.0, 0.11),
        ([0.0, 0.11], 0.05, 0.06),
        ([0.0, 0.05, 0.2, 0.25], 0.0, 0.25),
    ],
    ids=["no reading", "late", "early", "around", "between"],
)
def test_a_gap_in_the_readings_leaves_the_turn_untold(
    stamps: list[float], begin: float, end: float
) -> None:
    rates = np.column_stack((stamps, np.ones(len(stamps)))).reshape(-1, 2)
    assert not turn_between(rates, begin, end, GAP)[3]


def test_readings_are_kept_from_the_last_before_the_newest_odometry_on() -> None:
    kept = np.array([[0.1, 1.0], [0.2, 2.0], [0.3, 3.0]])
    new = np.array(
        [[0.25, 9.0], [np.nan, 9.0], [0.4, np.inf], [0.4, np.nan], [0.4, 11.0], [0.5, 5.0]]
    )
    assert keep_rates(kept, new, 0.25, 10.0, 100).tolist() == [[0.2, 2.0], [0.3, 3.0], [0.5, 5.0]]
    assert keep_rates(kept, new, -np.inf, 10.0, 2).tolist() == [[0.3, 3.0], [0.5, 5.0]]


def random_covariance(rng: np.random.Generator) -> NDArray[np.float64]:
    root = rng.normal(size=(STATES, STATES))
    return np.asarray(root @ root.T)


@given(seed=st.integers(0, 10_000))
def test_the_covariance_moves_by_the_motion_s_numeric_derivative(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ahead, left, turn = rng.normal(size=3)
    gains = (float(rng.normal()), float(rng.normal()))
    state, covariance = rng.normal(size=STATES), random_covariance(rng)

    def moved(errors: NDArray[np.float64]) -> NDArray[np.float64]:
        """The true next state when the belief of it errs by ``errors``, by plain geometry."""
        x, y, yaw, bias, turn_scale, way_scale = state + errors
        more = gains[0] * errors[3] + gains[1] * errors[4]
        heading = yaw + 0.5 * more
        way = 1.0 - errors[5]
        x += way * (np.cos(heading) * ahead - np.sin(heading) * left)
        y += way * (np.sin(heading) * ahead + np.cos(heading) * left)
        return np.array([x, y, yaw + turn + more, bias, turn_scale, way_scale])

    step = 1e-6
    jacobian = np.column_stack(
        [(moved(step * unit) - moved(-step * unit)) / (2 * step) for unit in np.eye(STATES)]
    )
    wanted_state, wanted = moved(np.zeros(STATES)), jacobian @ covariance @ jacobian.T
    move(state, covariance, (ahead, left, turn), gains, (0.0, 0.0, 0.0, 0.0))
    assert state == pytest.approx(wanted_state)
    # central differences of sines with steps of 1e-6 err by less than 1e-9 of a value near 1
    assert covariance == pytest.approx(wanted, rel=1e-7, abs=1e-7)


def test_a_way_cut_into_pieces_is_as_uncertain_as_the_whole() -> None:
    def after(pieces: int) -> NDArray[np.float64]:
        state, covariance = np.zeros(STATES), np.zeros((STATES, STATES))
        for _ in range(pieces):
            variances = (1e-4 / pieces, 1e-2 / pieces, 0.0, 0.0)
            move(state, covariance, (2.0 / pieces, 0.0, 0.0), (0.0, 0.0), variances)
        return covariance

    assert after(40) == pytest.approx(after(1), abs=1e-12)


@given(seed=st.integers(0, 10_000))
def test_a_correction_is_the_conditional_gaussian(seed: int) -> None:
    """The oracle stacks state and measurement in one Gaussian and conditions on the second."""
    rng = np.random.default_rng(seed)
    covariance, state = random_covariance(rng), rng.normal(size=STATES)
    sensitivity = np.array([0.0, 0.0, 0.0, *rng.normal(size=3)])
    shared = np.array([*(0.1 * rng.normal(size=3)), 0.0, 0.0, 0.0])
    variance, innovation = 2.0, float(rng.normal())
    cross = covariance @ sensitivity + shared
    total = sensitivity @ covariance @ sensitivity + variance
    wanted_state = state + cross / total * innovation
    wanted = covariance - np.outer(cross, cross) / total
    assert correct(state, covariance, innovation, sensitivity, shared, variance, np.inf)
    assert state == pytest.approx(wanted_state)
    assert covariance == pytest.approx(wanted)


@pytest.mark.parametrize("innovation", [10.1, -10.1, np.nan, np.inf])
def test_a_measurement_beyond_the_gate_changes_nothing(innovation: float) -> None:
    state, covariance = np.zeros(STATES), np.zeros((STATES, STATES))
    nothing = np.zeros(STATES)
    assert not correct(state, covariance, innovation, nothing, nothing, 4.0, 5.0)
    assert not state.any()
    assert not covariance.any()

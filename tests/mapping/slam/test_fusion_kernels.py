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


def rate_at(rates: NDArray[np.float64], window: float, stamp: float) -> float:
    """The rate at a moment: constant within a reading's window, along a line between windows."""
    after = int(np.searchsorted(rates[:, 0], stamp))
    if after in (0, len(rates)):
        return float(rates[max(after - 1, 0), 1])
    (was_at, was), (is_at, is_now) = rates[after - 1], rates[after]
    opens = max(is_at - window, was_at)
    if stamp >= opens:
        return float(is_now)
    return float(was + (is_now - was) * (stamp - was_at) / (opens - was_at))


@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 30),
    shares=st.tuples(*[st.floats(0, 1)] * 2),
    window=st.sampled_from([0.0, 0.01, 0.05, 0.2]),
)
def test_the_turn_is_the_area_under_the_readings_windows_and_the_lines_between(
    seed: int, count: int, shares: tuple[float, float], window: float
) -> None:
    rates = readings(np.random.default_rng(seed), count)
    first, last = rates[0, 0] - 0.05, rates[-1, 0] + 0.05
    begin, end = sorted(first + np.array(shares) * (last - first))
    angle, squares, fastest, is_covered = turn_between(rates, begin, end, window, GAP)
    opens = np.maximum(rates[1:, 0] - window, rates[:-1, 0])
    inside = np.union1d(rates[:, 0], opens)
    knots = np.concatenate(([begin], inside[(inside > begin) & (inside < end)], [end]))
    steps = np.diff(knots)
    thirds = [
        [rate_at(rates, window, a + k / 3.0 * b) for k in (1, 2)]
        for a, b in zip(knots, steps, strict=False)
    ]
    heights = np.array(thirds)
    assert is_covered
    assert angle == pytest.approx(np.sum(heights.mean(axis=1) * steps), abs=1e-9)
    assert squares == pytest.approx(np.sum(steps**2), abs=1e-12)
    if steps.min() > 1e-6:
        ends = heights @ [[2.0, -1.0], [-1.0, 2.0]]  # along the line, to both ends of each piece
        assert fastest == pytest.approx(np.abs(ends).max(), abs=1e-6)


def test_readings_that_are_means_add_up_to_the_turn_however_the_robot_shook() -> None:
    rng = np.random.default_rng(1)
    yaws = np.cumsum(rng.normal(0.0, 0.02, 101))  # 10 ms apart
    rates = np.column_stack((np.arange(1, 101) / 100.0, np.diff(yaws) / 0.01))
    angle, *_ = turn_between(rates, 0.2, 0.9, 0.01, GAP)
    assert angle == pytest.approx(yaws[90] - yaws[20], abs=1e-12)


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
    assert not turn_between(rates, begin, end, 0.01, GAP)[3]


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

"""The fusion of odometry and gyroscope: headings after long drives, covariances, frames."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from envs.wheel_encoders import YawSource
from mapping.deskew import OdometryTrack
from mapping.errors import TestbedError
from mapping.geometry import between, compose, wrap_to_pi
from mapping.slam.fusion import FusedTrack
from mapping.slam.fusion_config import FusionConfig
from mapping.slam.fusion_filter import likely_bias
from tests.mapping.slam.drives import drive, patrol
from tests.mapping.slam.fusion_drives import follow, gyro, message, rms, yaw_error


@pytest.mark.parametrize("imu", ["typical", "drifting"])
def test_after_60_m_the_heading_errs_at_most_a_third_of_the_encoders_alone(imu: str) -> None:
    fused, alone = [], []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        run = drive(patrol(rng, 60.0), rng, imu=imu)
        first, last = run.odometry[0].pose_odom, run.odometry[-1].pose_odom
        fused.append(yaw_error(first, follow(FusedTrack(), run)[-1], run))
        alone.append(yaw_error(first, last, run))
    assert rms(fused) <= rms(alone) / 3.0
    # 0.25 degrees: the bias is known to 1e-5 rad/s, for 450 s
    assert rms(fused) <= np.radians(0.25)


def test_a_heading_from_a_drifting_imu_is_not_believed() -> None:
    fused, alone = [], []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        run = drive(patrol(rng, 30.0), rng, imu="drifting", yaw="imu")
        first, last = run.odometry[0].pose_odom, run.odometry[-1].pose_odom
        fused.append(yaw_error(first, follow(FusedTrack(), run)[-1], run))
        alone.append(yaw_error(first, last, run))
    assert rms(fused) <= rms(alone) / 10.0  # 3e-4 rad/s against 1e-5 rad/s


def test_motions_between_marks_err_as_much_as_their_covariance_says() -> None:
    nees = []
    for seed in range(12):
        rng = np.random.default_rng(100 + seed)
        run = drive(patrol(rng, 12.0), rng)
        track = FusedTrack()
        for k in range(0, len(run.odometry) - 100, 100):
            part = replace(
                run,
                odometry=run.odometry[k : k + 100],
                imu=run.imu[3 * k : 3 * k + 303],  # ODOMETRY_EVERY = 3 periods a message
            )
            start = track.newest
            end = follow(track, part)[-1]
            if start is not None:
                error = between(start, end) - between(run.poses[k - 1], run.poses[k + 99])
                error[2] = wrap_to_pi(error[2])
                nees.append(error @ np.linalg.solve(track.motion_covariance(), error))
            track.mark()
    assert len(nees) > 300
    # Three degrees of freedom have the mean 3 and, over 300 independent motions, a standard error
    # of 0.14; the scale errors, drawn once a run, and the rounding of ticks widen that.
    assert 2.0 < np.mean(nees) < 4.0


def test_turning_on_the_spot_it_finds_the_least_squares_solution() -> None:
    """Without scale errors the turn is linear in the bias: a batch solves for all at once."""
    rng = np.random.default_rng(3)
    config = FusionConfig(
        turn_scale=0.0,
        gyro_bias_walk=0.0,
        calibrated=0.0,
        gyro_window=0.0,
        heading_from="encoders",
    )
    count, dt = 40, 0.05
    true_rates = rng.uniform(0.4, 1.2, count + 1)
    turns = 0.5 * (true_rates[1:] + true_rates[:-1]) * dt
    stamps = np.arange(count + 1) * dt
    rates = true_rates + 2e-4 + config.gyro_noise * rng.normal(size=count + 1)
    wheels = np.concatenate(([0.0], np.cumsum(turns + 2e-4 * rng.normal(size=count))))
    track = FusedTrack(config)
    track.add(
        [message(t, (0, 0, wrap_to_pi(yaw))) for t, yaw in zip(stamps, wheels, strict=True)],
        [gyro(t, rate) for t, rate in zip(stamps, rates, strict=True)],
    )
    # unknowns: the bias, then every turn; two equations a turn, and the bias's prior
    gyro_turns = 0.5 * (rates[1:] + rates[:-1]) * dt
    wheel_turns = np.diff(wheels)
    gyro_sigma = np.full(count, config.gyro_noise * dt)
    wheel_sigma = np.sqrt(config.turn_per_turn**2 * np.abs(wheel_turns) + config.turn_step**2)
    design = np.zeros((2 * count + 1, count + 1))
    design[:count, 0], design[:count, 1:] = dt, np.eye(count)
    design[count:-1, 1:], design[-1, 0] = np.eye(count), 1.0
    weights = 1.0 / np.concatenate((gyro_sigma, wheel_sigma, [config.gyro_bias]))
    wanted = np.concatenate((gyro_turns, wheel_turns, [0.0]))
    solution = np.linalg.lstsq(design * weights[:, None], wanted * weights, rcond=None)[0]
    covariance = np.linalg.inv((design * weights[:, None]).T @ (design * weights[:, None]))
    yaw = np.concatenate(([0.0], np.ones(count)))
    assert track.newest is not None
    assert float(wrap_to_pi(track.newest[2] - yaw @ solution)) == pytest.approx(0.0, abs=1e-9)
    assert track.motion_covariance()[2, 2] == pytest.approx(yaw @ covariance @ yaw, rel=1e-6)
    assert track.gyro_bias[0] == pytest.approx(solution[0], rel=1e-6)
    assert track.gyro_bias[1] == pytest.approx(np.sqrt(covariance[0, 0]), rel=1e-6)


@given(
    measured=st.floats(-1e-3, 1e-3),
    sigma=st.floats(2e-6, 1e-3),
    calibrated=st.floats(0.0, 1.0),
)
def test_the_likely_bias_is_the_posterior_mean_of_both_kinds_of_gyroscopes(
    measured: float, sigma: float, calibrated: float
) -> None:
    config = FusionConfig(calibrated=calibrated)
    biases = np.sort(
        np.concatenate((np.linspace(-2e-3, 2e-3, 20_001), np.linspace(-9e-5, 9e-5, 20_001)))
    )
    prior = calibrated * norm.pdf(biases, 0.0, config.calibrated_bias)
    prior += (1.0 - calibrated) * norm.pdf(biases, 0.0, config.gyro_bias)
    posterior = prior * norm.pdf(measured, biases, sigma)
    wanted = np.trapezoid(biases * posterior, biases) / np.trapezoid(posterior, biases)
    variance = 1.0 / (sigma**-2 + config.gyro_bias**-2)  # of a filter that knows one kind
    likely = likely_bias(measured * variance / sigma**2, variance, config)
    assert likely == pytest.approx(wanted, rel=2e-3, abs=2e-9)


def test_before_any_rest_no_bias_is_likely() -> None:
    config = FusionConfig()
    assert likely_bias(0.0, config.gyro_bias**2, config) == 0.0


def test_a_second_of_rest_turns_a_well_calibrated_gyroscope_little_and_corrects_another() -> None:
    """Heading errors [rad] of 10 minutes of standing a second and turning on without an encoder."""
    good: list[float] = []
    bad: list[float] = []
    for seed in range(30):
        noise = 2e-4 * np.random.default_rng(seed).standard_normal(70)
        sigma = 2e-4 / np.sqrt(70)
        for bias, errors in ((7.5e-6, good), (3.1e-4, bad)):
            likely = likely_bias(bias + float(noise.mean()), sigma**2, FusionConfig())
            errors.append(600.0 * (likely - bias))
    measured_alone = 600.0 * 2e-4 / np.sqrt(70)
    assert rms(good) < 0.7 * measured_alone
    assert rms(bad) < 1.3 * measured_alone


@given(seed=st.integers(0, 10_000), period=st.sampled_from([0.033, 0.2, 1.5]))
def test_without_an_imu_the_track_is_the_odometry(seed: int, period: float) -> None:
    rng = np.random.default_rng(seed)
    stamps = period * np.arange(1, 20)
    poses = np.column_stack(
        (np.cumsum(rng.uniform(-0.05, 0.05, (19, 2)), axis=0), rng.uniform(-0.1, 0.1, 19))
    )
    messages = [
        message(t, pose, *rng.uniform(-0.2, 0.2, 2)) for t, pose in zip(stamps, poses, strict=True)
    ]
    fused, plain = FusedTrack(), OdometryTrack()
    fused.add(messages)
    plain.add(messages)
    moments = np.linspace(stamps[-4], stamps[-1] + 0.2, 30)
    assert fused.jumps == 0
    assert fused.poses_at(moments) == pytest.approx(plain.poses_at(moments), abs=1e-12)
    assert fused.newest_turn_rate == plain.newest_turn_rate
    assert np.linalg.eigvalsh(fused.motion_covariance()).min() > 0.0


def test_shifting_and_rotating_the_odometry_shifts_and_rotates_the_track() -> None:
    rng = np.random.default_rng(5)
    run = drive(patrol(rng, 5.0), rng)
    frame = np.array([3.0, -2.0, 2.5])
    moved = replace(
        run,
        odometry=[replace(m, pose_odom=compose(frame, m.pose_odom)) for m in run.odometry],
    )
    here, there = FusedTrack(), FusedTrack()
    follow(here, run)
    follow(there, moved)
    assert here.newest is not None
    assert there.newest == pytest.approx(compose(frame, here.newest), abs=1e-9)
    assert there.motion_covariance() == pytest.approx(here.motion_covariance(), rel=1e-6, abs=1e-12)


def test_the_covariance_counts_from_the_mark_in_its_frame() -> None:
    track = FusedTrack()
    track.add([message(0.0, (0, 0, np.pi / 2)), message(1.0, (0, 1, np.pi / 2))])
    track.mark()
    assert not track.motion_covariance().any()
    track.add([message(2.0, (0, 2, np.pi / 2))])
    covariance = track.motion_covariance()
    along = FusionConfig().way_per_way ** 2 + FusionConfig().way_scale ** 2
    turn = FusionConfig().turn_per_way ** 2
    assert covariance[0, 0] == pytest.approx(along)
    assert covariance[1, 1] == pytest.approx(turn / 3.0)  # a random walk of the heading, 1 m long
    assert covariance[2, 2] == pytest.approx(turn)


@pytest.mark.parametrize("yaw", ["encoders", "imu"])
def test_it_finds_out_where_the_heading_comes_from(yaw: YawSource) -> None:
    track = FusedTrack()
    rng = np.random.default_rng(8)
    follow(track, drive(np.zeros((100, 2)), rng, yaw=yaw))
    assert track.wheels_tell_turns == (yaw == "encoders")


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"gyro_noise": -1.0}, "gyro_noise: -1.0"),
        ({"way_per_way": np.nan}, "way_per_way: nan"),
        ({"max_speed": 0.0}, "max_speed: 0"),
        ({"heading_from": "stars"}, "heading_from: 'stars'; must be one of detect, encoders, imu"),
    ],
)
def test_settings_that_make_no_filter_are_refused(settings: dict[str, float], told: str) -> None:
    with pytest.raises(TestbedError, match=told):
        FusionConfig(**settings)  # type: ignore[arg-type]

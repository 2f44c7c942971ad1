from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from envs.wheel_encoders import YawSource
from mapping.deskew import OdometryTrack
from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose, wrap_to_pi
from mapping.messages import Imu, Odometry, Twist
from mapping.slam.fusion import MOST_RATES, FusedTrack
from mapping.slam.fusion_config import FusionConfig
from tests.mapping.slam.drives import Drive, drive, imu_message, patrol


def message(stamp: float, pose: Sequence[float], v: float = 0.0, w: float = 0.0) -> Odometry:
    return Odometry(
        stamp=stamp,
        pose_odom=np.array(pose, dtype=np.float64),
        twist=Twist(linear_x=v, angular_z=w),
    )


def gyro(stamp: float, rate: float) -> Imu:
    return imu_message(np.array([stamp, 0, 0, 0, 1, 0, 0, rate, 0, 0, 9.81]))


def ahead(metres: float, stamp: float) -> Odometry:
    return message(stamp, (metres, 0.0, 0.0), v=0.2)


def follow(track: FusedTrack, run: Drive, every: int = 3) -> Pose:
    """Feed a drive, ``every`` odometry messages at once; the poses after each time ``(n, 3)``."""
    poses, taken = [], 0
    stamps = np.array([message.stamp for message in run.imu])
    for first in range(0, len(run.odometry), every):
        messages = run.odometry[first : first + every]
        upto = int(np.searchsorted(stamps, messages[-1].stamp + 1e-9))
        track.add(messages, run.imu[taken:upto])
        taken = upto
        assert track.newest is not None
        poses.append(track.newest)
    return np.array(poses)


def yaw_error(start: Pose, end: Pose, run: Drive) -> float:
    """How far a believed turn from the first message to the last is off [rad]."""
    turn = between(start, end)[2] - between(run.poses[0], run.poses[-1])[2]
    return float(wrap_to_pi(turn))


def rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


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
    config = FusionConfig(turn_scale=0.0, gyro_bias_walk=0.0, heading_from="encoders")
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


def test_a_robot_at_rest_keeps_its_heading_while_its_imu_drifts() -> None:
    rng = np.random.default_rng(9)
    run = drive(np.zeros((30_000, 2)), rng, imu="drifting", yaw="imu")
    track = FusedTrack()
    follow(track, run)
    drifted = abs(run.odometry[-1].pose_odom[2] - run.odometry[0].pose_odom[2])
    assert drifted > 0.01
    assert track.newest is not None
    # what it turns before it is known to have settled, 0.3 s of the drift, and no more
    assert abs(track.newest[2] - run.odometry[0].pose_odom[2]) < 0.4 * drifted / 300.0


def test_a_slip_of_the_wheels_is_left_to_the_gyroscope() -> None:
    track = FusedTrack(FusionConfig(heading_from="encoders"))
    stamps = np.arange(0.0, 1.01, 0.05)
    slipped = [message(t, (0.2 * t, 0.0, 0.0 if t < 0.5 else 0.3), v=0.2) for t in stamps]
    track.add(slipped, [gyro(t, 0.0) for t in np.arange(0.0, 1.01, 0.01)])
    assert track.jumps == 0
    assert track.newest is not None
    assert track.newest[2] == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(("jump", "seconds"), [((5.0, 0.0, 0.0), 0.033), ((0.0, 0.0, 2.0), 0.033)])
@pytest.mark.parametrize("has_imu", [True, False])
def test_a_jump_is_not_believed(
    jump: tuple[float, float, float], seconds: float, has_imu: bool
) -> None:
    track, smooth = FusedTrack(), FusedTrack()
    stamps = seconds * np.arange(30)
    poses = [np.array([0.2 * t, 0.0, 0.0]) for t in stamps]
    jumped = [compose(jump, pose) if k >= 15 else pose for k, pose in enumerate(poses)]
    readings = [gyro(t, 0.0) for t in np.arange(0.0, stamps[-1] + 0.01, 0.01)] if has_imu else []
    smooth.add([message(t, p, v=0.2) for t, p in zip(stamps, poses, strict=True)], readings)
    track.add([message(t, p, v=0.2) for t, p in zip(stamps, jumped, strict=True)], readings)
    assert (smooth.jumps, track.jumps) == (0, 1)
    # on at 0.2 m/s for the one message, then by what the messages say of the motion
    assert track.newest == pytest.approx(smooth.newest, abs=1e-9)
    assert track.motion_covariance()[0, 0] > smooth.motion_covariance()[0, 0] + 1e-3
    assert np.linalg.eigvalsh(track.motion_covariance()).min() > 0.0


def test_seconds_between_messages_are_no_jump() -> None:
    """As in old logs, one message a scan: 2 s, 2 m and half a turn apart."""
    track = FusedTrack()
    track.add([message(2.0 * k, (2.0 * k, 0.0, np.pi * (k % 2))) for k in range(5)])
    assert track.jumps == 0
    assert track.newest is not None
    assert track.newest[0] == pytest.approx(8.0)
    poses = track.poses_at([4.0, 5.0, 8.1])
    assert poses is not None
    assert poses[:, 0] == pytest.approx([4.0, 5.0, 8.0])


def test_messages_that_are_broken_or_late_are_ignored() -> None:
    track = FusedTrack()
    broken = np.array([np.nan, 0.0, 0.0, 0.0, 1.0, 0, 0, np.nan, 0, 0, 0])
    track.add([ahead(0.0, 0.0), ahead(0.01, 0.05)], [gyro(0.0, 0.0), gyro(0.05, 0.0)])
    track.add(
        [
            message(0.04, (9, 9, 9)),
            message(0.05, (9, 9, 9)),
            message(0.06, (np.nan, 0, 0)),
            message(np.nan, (0, 0, 0)),
            message(0.06, (0, 0, 0), v=np.inf),
        ],
        [imu_message(broken), gyro(0.01, 3.0), gyro(0.06, np.inf), gyro(0.06, 1e6)],
    )
    track.add([ahead(0.02, 0.1)], [gyro(0.1, 0.0)])
    assert track.newest == pytest.approx([0.02, 0.0, 0.0])
    assert track.jumps == 0
    assert np.all(np.isfinite(track.motion_covariance()))


def test_before_any_odometry_there_is_no_pose() -> None:
    track = FusedTrack()
    track.add([], [gyro(0.01, 1.0)])
    assert track.newest is None
    assert track.newest_turn_rate == 0.0
    assert track.poses_at([0.0]) is None
    assert track.poses_at([np.nan]) is None


def test_readings_do_not_pile_up_while_no_odometry_comes() -> None:
    track = FusedTrack()
    for second in range(100):
        track.add([], [gyro(second + 0.01 * k, 0.0) for k in range(100)])
    assert len(track._rates) == MOST_RATES


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

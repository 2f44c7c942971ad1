"""The fusion with odometry that jumps, slips, stands still, breaks off or never comes."""

import numpy as np
import pytest

from mapping.geometry import compose
from mapping.slam.fusion import MOST_RATES, FusedTrack
from mapping.slam.fusion_config import FusionConfig
from tests.mapping.slam.drives import drive, imu_message
from tests.mapping.slam.fusion_drives import ahead, follow, gyro, message


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

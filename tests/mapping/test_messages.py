import numpy as np

from mapping.messages import Imu, LaserScan, Odometry, turn_rates


def observation() -> dict[str, np.ndarray]:
    ranges = np.linspace(0.1, 3.5, 360, dtype=np.float32)
    ranges[7] = 0.0
    return {
        "ranges": ranges,
        "scan_stamp": np.array([1.2]),
        "odometry": np.array([[1.0, 0.1, 0.2, 0.3, 0.2, -0.5], [1.1, 0.2, 0.3, 0.4, 0.1, 0.5]]),
        "imu": np.arange(22, dtype=np.float64).reshape(2, 11),
    }


def test_a_range_at_its_maximum_is_infinity_again_and_zero_stays_a_failure() -> None:
    scan = LaserScan.from_observation(observation())
    assert scan is not None
    assert np.isposinf(scan.ranges[-1])
    assert np.isfinite(scan.ranges[:-1]).all()
    assert scan.ranges[7] == 0.0
    assert observation()["ranges"][-1] == np.float32(3.5)


def test_before_the_first_scan_there_is_none() -> None:
    assert LaserScan.from_observation({**observation(), "scan_stamp": np.array([-1.0])}) is None


def test_beams_are_one_degree_and_one_eighteen_hundredth_of_a_second_apart() -> None:
    scan = LaserScan(stamp=2.0, ranges=np.zeros(360, np.float32))
    assert np.allclose(np.degrees(scan.angles), np.arange(360))
    assert np.isclose(scan.angle_max, np.radians(359))
    assert np.allclose(scan.beam_stamps, 2.0 + np.arange(360) / 1800.0)


def test_rows_become_messages_with_the_fields_of_ros() -> None:
    first, second = Odometry.from_observation(observation())
    assert (first.stamp, second.twist.angular_z) == (1.0, 0.5)
    assert first.pose_odom.tolist() == [0.1, 0.2, 0.3]
    assert first.twist.linear_x == 0.2
    imu = Imu.from_observation(observation())[1]
    assert imu.stamp == 11.0
    assert imu.orientation.tolist() == [12.0, 13.0, 14.0, 15.0]
    assert imu.angular_velocity.tolist() == [16.0, 17.0, 18.0]
    assert imu.linear_acceleration.tolist() == [19.0, 20.0, 21.0]


def test_turn_rates_are_those_of_the_messages_however_they_are_held() -> None:
    rows = np.arange(33.0).reshape(3, 11)
    lazy = Imu.from_observation({"imu": rows})
    assert turn_rates(lazy).tolist() == [[0.0, 7.0], [11.0, 18.0], [22.0, 29.0]]
    assert turn_rates(list(lazy)).tolist() == turn_rates(lazy).tolist()
    assert turn_rates([]).shape == (0, 2)

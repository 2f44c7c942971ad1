import numpy as np

from evaluation.kernels.warm_up import ROOM, sparse_log
from mapping.geometry import transform_points


def test_the_readings_of_the_sparse_log_end_on_the_walls_of_its_room() -> None:
    log = sparse_log()
    assert len(log.scans) == len(log.odometry) == 60
    for scan, message in zip(log.scans, log.odometry, strict=True):
        rays = np.column_stack((np.cos(scan.angles), np.sin(scan.angles)))
        ends = transform_points(message.pose_odom, scan.ranges[:, None] * rays)
        # ranges are float32: 4 m are told to half a micrometre
        assert np.allclose(np.max(np.abs(ends) / ROOM, axis=1), 1.0, atol=1e-6)

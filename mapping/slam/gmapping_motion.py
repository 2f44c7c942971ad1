"""GMapping's motion model: where the robot may be, given how its odometry says it moved."""

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, compose

SIDEWAYS = 0.3
"""What one axis's travel adds to the other's noise, as a share of ``srr`` (GMapping)."""


def sample_motion(
    poses_map: Pose,
    step: Pose,
    *,
    srr: float,
    srt: float,
    str_: float,
    stt: float,
    normals: NDArray[np.float64],
) -> Pose:
    """Move every particle by its own guess of what the odometry's step truly was.

    The noise's standard deviations grow linearly with the step: along an axis by ``srr`` of the
    travel along it, SIDEWAYS of that across, and ``str_`` per radian turned; of the yaw by ``stt``
    of the turn and ``srt`` per metre gone.

    Args:
        poses_map: ``(n, 3)``.
        step: The robot's new pose in the frame of its old one ``(3,)``.
        srr: Translation from translation [m/m].
        srt: Rotation from translation [rad/m].
        str_: Translation from rotation [m/rad].
        stt: Rotation from rotation [rad/rad].
        normals: Standard normal numbers ``(n, 3)``.

    Returns:
        The new poses ``(n, 3)``.
    """
    forward, aside, turn = np.abs(step)
    sigmas = np.array(
        [
            srr * forward + SIDEWAYS * srr * aside + str_ * turn,
            srr * aside + SIDEWAYS * srr * forward + str_ * turn,
            stt * turn + srt * np.hypot(forward, aside),
        ]
    )
    return compose(poses_map, step + sigmas * normals)

"""Numba kernels of the rolling lidar: the rays of one block, and the distances along them."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from envs.quaternion import mean_attitude, rotate

GRAZING = 0.01
"""Cosine to a surface's normal below which a ray glides along it, and its plane says nothing."""


@njit(cache=True)
def block_rays(
    base_states: NDArray[np.float64],
    offset: NDArray[np.float64],
    beams: NDArray[np.float64],
    directions: NDArray[np.float64],
    shifts: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Directions of the beams of one block, and how far each starts from the block's middle.

    The base moves from the first state to the second in the first half of the block and on to the
    third in the second half; beam ``i`` of ``n`` is taken at the share ``i / n`` of the block.

    Args:
        base_states: Position and unit quaternion (w, x, y, z) of base_link at the block's start,
            middle and end ``(3, 7)``, in the world.
        offset: The sensor in base_link ``(3,)`` [m]; its axes are base_link's.
        beams: Directions in the sensor's plane ``(n, 2)``, of length 1.
        directions: Gets the directions in the world ``(n, 3)``, of length 1.
        shifts: Gets where each beam starts, from the sensor in the middle state ``(n, 3)`` [m].

    Returns:
        Where the sensor is in the middle state ``(3,)`` [m], in the world.
    """
    mount = (offset[0], offset[1], offset[2])
    attitudes = [(s[3], s[4], s[5], s[6]) for s in base_states]
    arm = rotate(attitudes[1], mount)
    middle = np.array((base_states[1, 0] + arm[0], base_states[1, 1] + arm[1], 0.0))
    middle[2] = base_states[1, 2] + arm[2]
    for i in range(len(beams)):
        along = 2.0 * i / len(beams)
        half = int(along)
        share = along - half
        attitude = mean_attitude(attitudes[half], attitudes[half + 1], share)
        direction = rotate(attitude, (beams[i, 0], beams[i, 1], 0.0))
        arm = rotate(attitude, mount)
        for axis in range(3):
            before, after = base_states[half, axis], base_states[half + 1, axis]
            shifts[i, axis] = before + share * (after - before) + arm[axis] - middle[axis]
            directions[i, axis] = direction[axis]
    return middle


@njit(cache=True)
def shift_origins(
    distances: NDArray[np.float64],
    normals: NDArray[np.float64],
    directions: NDArray[np.float64],
    shifts: NDArray[np.float64],
) -> None:
    """Distances from each beam's own start, in place, where they were cast from a common one.

    Exact where the surface is flat; a beam that hit nothing becomes ``+inf``.

    Args:
        distances: Cast from the common origin ``(n,)`` [m]; negative where nothing was hit.
        normals: Unit normals of the surfaces hit ``(n, 3)``.
        directions: Unit directions of the beams ``(n, 3)``.
        shifts: Start of each beam, seen from the common origin ``(n, 3)`` [m].
    """
    for i in range(len(distances)):
        if distances[i] < 0.0:
            distances[i] = np.inf
            continue
        facing, nearer = 0.0, 0.0
        for axis in range(3):
            facing += normals[i, axis] * directions[i, axis]
            nearer += normals[i, axis] * shifts[i, axis]
        if abs(facing) > GRAZING:
            distances[i] = max(distances[i] - nearer / facing, 0.0)

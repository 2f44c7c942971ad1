"""Numba kernels that turn vectors by unit quaternions w, x, y, z, MuJoCo's order."""

from numba import njit

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


@njit(cache=True)
def rotate(quaternion: Quaternion, vector: Vector) -> Vector:
    """A vector given in a body, in the world that the body's attitude is given in."""
    w, x, y, z = quaternion
    a, b, c = vector
    # v + 2 w (u x v) + 2 u x (u x v), with u the vector part.
    p, q, r = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (
        a + w * p + y * r - z * q,
        b + w * q + z * p - x * r,
        c + w * r + x * q - y * p,
    )


@njit(cache=True)
def rotate_back(quaternion: Quaternion, vector: Vector) -> Vector:
    """A vector given in the world, in the body with this attitude."""
    w, x, y, z = quaternion
    turned: Vector = rotate((w, -x, -y, -z), vector)
    return turned


@njit(cache=True)
def mean_attitude(first: Quaternion, second: Quaternion, share: float) -> Quaternion:
    """The attitude at a share of the way between two near ones, to third order in their angle."""
    rest = 1.0 - share
    w = rest * first[0] + share * second[0]
    x = rest * first[1] + share * second[1]
    y = rest * first[2] + share * second[2]
    z = rest * first[3] + share * second[3]
    scale = (w * w + x * x + y * y + z * z) ** -0.5
    return scale * w, scale * x, scale * y, scale * z

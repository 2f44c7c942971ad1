"""Poses in the plane, SE(2): composing, inverting and comparing them.

A pose is a float64 array ``(x, y, yaw)`` in metres and radians, yaw counter-clockwise in
(-pi, pi] (REP-103). Every function takes one pose ``(3,)`` or many ``(n, 3)`` and broadcasts.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Pose = NDArray[np.float64]
"""One pose ``(3,)`` or a stack of poses ``(n, 3)``: x [m], y [m], yaw [rad]."""


def compose(a: ArrayLike, b: ArrayLike) -> Pose:
    """The pose ``b``, given in the frame of ``a``, in the frame that ``a`` is given in: a (+) b."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    if a.ndim == b.ndim == 1:
        return _compose_one(a, b)
    cos, sin = np.cos(a[..., 2]), np.sin(a[..., 2])
    return np.stack(
        (
            a[..., 0] + cos * b[..., 0] - sin * b[..., 1],
            a[..., 1] + sin * b[..., 0] + cos * b[..., 1],
            wrap_to_pi(a[..., 2] + b[..., 2]),
        ),
        axis=-1,
    )


def inverse(a: ArrayLike) -> Pose:
    """The pose that undoes ``a``: compose(a, inverse(a)) is the identity."""
    a = np.asarray(a, dtype=np.float64)
    if a.ndim == 1:
        return _inverse_one(a)
    cos, sin = np.cos(a[..., 2]), np.sin(a[..., 2])
    return np.stack(
        (
            -cos * a[..., 0] - sin * a[..., 1],
            sin * a[..., 0] - cos * a[..., 1],
            wrap_to_pi(-a[..., 2]),
        ),
        axis=-1,
    )


def between(a: ArrayLike, b: ArrayLike) -> Pose:
    """The pose of ``b`` seen from ``a``: compose(a, between(a, b)) is ``b``."""
    return compose(inverse(a), b)


def transform_points(pose: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    """Points ``(n, 2)`` given in the frame of ``pose``, in the frame that ``pose`` is given in."""
    pose, points = np.asarray(pose, dtype=np.float64), np.asarray(points, dtype=np.float64)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]) + pose[:2])


def wrap_to_pi(angle: ArrayLike) -> NDArray[np.float64]:
    """The same angle [rad] in (-pi, pi]; NaN stays NaN."""
    if isinstance(angle, float):  # a numpy scalar is one too
        return np.asarray(_wrap_one(angle))
    angle = np.asarray(angle, dtype=np.float64)
    return np.asarray(np.pi - np.mod(np.pi - angle, 2.0 * np.pi))


def circular_mean(angles: ArrayLike, weights: ArrayLike | None = None) -> float:
    """The mean direction [rad] of angles ``(n,)``; not the arithmetic mean, which fails at +-pi."""
    angles = np.asarray(angles, dtype=np.float64)
    each = np.ones_like(angles) if weights is None else np.asarray(weights, dtype=np.float64)
    return float(np.arctan2(np.sum(each * np.sin(angles)), np.sum(each * np.cos(angles))))


def _compose_one(a: Pose, b: Pose) -> Pose:
    """``compose`` of one pose with one, ten times faster than with arrays."""
    ax, ay, ayaw = a.tolist()
    bx, by, byaw = b.tolist()
    cos, sin = math.cos(ayaw), math.sin(ayaw)
    return np.array([ax + cos * bx - sin * by, ay + sin * bx + cos * by, _wrap_one(ayaw + byaw)])


def _inverse_one(a: Pose) -> Pose:
    """``inverse`` of one pose."""
    x, y, yaw = a.tolist()
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([-cos * x - sin * y, sin * x - cos * y, _wrap_one(-yaw)])


def _wrap_one(angle: float) -> float:
    """``wrap_to_pi`` of one angle."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)

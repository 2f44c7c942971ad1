"""A pose graph: poses in the plane, and measurements of where one lies seen from another."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose

_INDEFINITE = -1e-9
"""An eigenvalue of an information matrix may be this share of the largest below 0 by rounding."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoseGraph:
    """Vertices and edges as arrays; ids are any whole numbers, each vertex's its own."""

    ids: NDArray[np.int64]
    """Ids of the vertices ``(n,)``."""
    poses: Pose
    """Their poses ``(n, 3)``: a guess before optimisation, the answer after it."""
    edges: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    """Ids of the vertices from which and of which each measurement was made ``(m, 2)``."""
    relative_poses: Pose = field(default_factory=lambda: np.empty((0, 3)))
    """What was measured ``(m, 3)``: the second vertex seen from the first."""
    information: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 3, 3)))
    """Inverse covariances of the measurements ``(m, 3, 3)``, in x [m], y [m], yaw [rad]."""
    fixed: tuple[int, ...] = ()
    """Ids of the vertices that an optimiser must not move."""

    def __post_init__(self) -> None:
        """Refuse what is no pose graph."""
        count, measured = len(self.ids), len(self.edges)
        shapes = (self.poses.shape, self.relative_poses.shape, self.information.shape)
        if shapes != ((count, 3), (measured, 3), (measured, 3, 3)):
            raise TestbedError(
                f"pose graph: arrays of shapes {shapes}; must be (n, 3), (m, 3), (m, 3, 3) "
                f"for {count} vertices and {measured} edges"
            )
        if len(np.unique(self.ids)) != count:
            raise TestbedError("pose graph: two vertices have one id; each must have its own")
        missing = np.setdiff1d([*self.edges.ravel(), *self.fixed], self.ids)
        if missing.size:
            raise TestbedError(f"pose graph: no vertex {int(missing[0])}; edges and fixed need it")
        for name in ("poses", "relative_poses", "information"):
            if not np.all(np.isfinite(getattr(self, name))):
                raise TestbedError(f"pose graph: {name}: not finite; all numbers must be")
        self._check_information()

    def _check_information(self) -> None:
        """Refuse matrices that are no inverse covariances."""
        symmetric = np.array_equal(self.information, self.information.transpose(0, 2, 1))
        eigenvalues = np.linalg.eigvalsh(self.information)
        wrong = np.flatnonzero(eigenvalues[:, 0] < _INDEFINITE * np.abs(eigenvalues[:, 2]))
        if not symmetric or wrong.size:
            which = f" of edge {tuple(self.edges[wrong[0]].tolist())}" if wrong.size else ""
            raise TestbedError(
                f"pose graph: information{which}: must be symmetric and not negative definite"
            )

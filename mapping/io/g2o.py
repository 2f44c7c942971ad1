"""Turns pose graphs in the plane into g2o files, and back.

Lines are ``VERTEX_SE2 id x y yaw``, ``EDGE_SE2 from to dx dy dyaw`` with the upper triangle of the
information matrix, row by row, and ``FIX id`` (g2o, types/slam2d). Whatever else would change the
problem is refused: a graph without its landmarks is another graph.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi
from mapping.io.atomic import write_atomically
from mapping.pose_graph import PoseGraph

VERTEX, EDGE, FIX = "VERTEX_SE2", "EDGE_SE2", "FIX"
VERTEX_WORDS, EDGE_WORDS = 5, 12

REFUSED = {
    "VERTEX_SE3:QUAT": "a graph in space",
    "EDGE_SE3:QUAT": "a graph in space",
    "VERTEX_XY": "a landmark",
    "EDGE_SE2_XY": "a landmark",
    "VERTEX2": "a TORO graph, whose information is ordered otherwise",
    "EDGE2": "a TORO graph, whose information is ordered otherwise",
}
"""Tags that g2o's and TORO's tools write, and what they mean."""

SKIPPED_PREFIX = "PARAMS_"
"""Where sensors sit on the robot; poses and their edges do not refer to it."""

_UPPER = np.triu_indices(3)


def read_g2o(path: str | Path) -> PoseGraph:
    """Read a pose graph; comments (``#``), blank lines and ``PARAMS_...`` are skipped.

    Raises:
        TestbedError: The file cannot be read, a line is broken or of another kind, an edge names a
            vertex that is not there, or an information matrix is none.
    """
    path = Path(path)
    lines = _Lines()
    for number, line in enumerate(_text(path).splitlines(), start=1):
        words = line.split("#", 1)[0].split()
        if not words or words[0].startswith(SKIPPED_PREFIX):
            continue
        try:
            lines.take(words)
        except ValueError as error:
            raise TestbedError(f"{path}: line {number}: {line.strip()[:60]!r}: {error}") from None
    try:
        return lines.graph()
    except TestbedError as error:
        raise TestbedError(f"{path}: {error}") from None


def write_g2o(path: str | Path, graph: PoseGraph) -> None:
    """Write a pose graph, every number with the digits that bring it back.

    ``FIX`` lines come last: GTSAM's reader takes no edge after one.

    Raises:
        TestbedError: The file cannot be written.
    """
    lines = [
        f"{VERTEX} {vertex} {_words(pose)}\n"
        for vertex, pose in zip(graph.ids.tolist(), graph.poses.tolist(), strict=True)
    ]
    triangles = graph.information[:, _UPPER[0], _UPPER[1]].tolist()
    lines += [
        f"{EDGE} {first} {second} {_words(pose)} {_words(triangle)}\n"
        for (first, second), pose, triangle in zip(
            graph.edges.tolist(), graph.relative_poses.tolist(), triangles, strict=True
        )
    ]
    lines += [f"{FIX} {vertex}\n" for vertex in graph.fixed]
    write_atomically(path, lambda file: file.write("".join(lines).encode()))


@dataclass(slots=True)
class _Lines:
    """The lines of a file so far."""

    vertices: list[tuple[int, list[float]]] = field(default_factory=list)
    edges: list[tuple[int, int, list[float]]] = field(default_factory=list)
    fixed: list[int] = field(default_factory=list)

    def take(self, words: Sequence[str]) -> None:
        """Take a line's words; raises ValueError, which says what a line must be."""
        tag = words[0]
        if tag == VERTEX:
            _check(words, VERTEX_WORDS, f"{VERTEX} id x y yaw")
            self.vertices.append((int(words[1]), [float(word) for word in words[2:]]))
        elif tag == EDGE:
            _check(words, EDGE_WORDS, f"{EDGE} from to dx dy dyaw and six numbers of information")
            numbers = [float(word) for word in words[3:]]
            self.edges.append((int(words[1]), int(words[2]), numbers))
        elif tag == FIX:
            self.fixed += [int(word) for word in words[1:]]
        else:
            meaning = f" ({REFUSED[tag]})" if tag in REFUSED else ""
            raise ValueError(f"{tag}{meaning}; must be {VERTEX}, {EDGE} or {FIX}")

    def graph(self) -> PoseGraph:
        """The graph of all lines."""
        rows = np.array([row for *_, row in self.edges]).reshape(-1, 9)
        information = np.empty((len(rows), 3, 3))
        information[:, _UPPER[0], _UPPER[1]] = rows[:, 3:]
        information[:, _UPPER[1], _UPPER[0]] = rows[:, 3:]
        return PoseGraph(
            ids=np.array([vertex for vertex, _ in self.vertices], dtype=np.int64),
            poses=_wrapped(np.array([pose for _, pose in self.vertices]).reshape(-1, 3)),
            edges=np.array([edge[:2] for edge in self.edges], dtype=np.int64).reshape(-1, 2),
            relative_poses=_wrapped(rows[:, :3].copy()),
            information=information,
            fixed=tuple(self.fixed),
        )


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise TestbedError(f"{path}: cannot be read ({error}); must be a g2o file") from error


def _check(words: Sequence[str], count: int, allowed: str) -> None:
    if len(words) != count:
        raise ValueError(f"{len(words)} words; must be {count}: {allowed}")


def _wrapped(poses: Pose) -> Pose:
    """Poses with yaws in (-pi, pi]; those that lay there stay the same to the last digit."""
    outside = ~((poses[:, 2] > -np.pi) & (poses[:, 2] <= np.pi)) & np.isfinite(poses[:, 2])
    poses[outside, 2] = wrap_to_pi(poses[outside, 2])
    return poses


def _words(numbers: Sequence[float]) -> str:
    return " ".join(map(repr, numbers))

"""``burger optimize``: the poses of a g2o file that agree best with its measurements."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional

from evaluation.run_folder import run_folder
from mapping.errors import TestbedError
from mapping.graph_plot import save_graph_picture
from mapping.io.g2o import read_g2o, write_g2o
from mapping.pose_graph import PoseGraph
from mapping.slam.pose_graph_optimizer import chi2_of, optimize_pose_graph
from scripts.arguments import parse

GRAPH_FILE, PICTURE = "optimized.g2o", "graph.png"


@dataclass(frozen=True, kw_only=True)
class Optimize:
    """Optimise a pose graph: Levenberg-Marquardt, from the poses in the file."""

    file: Annotated[Path, Positional]
    """A g2o file of VERTEX_SE2 and EDGE_SE2; what FIX names is held, or the first vertex."""
    out: Path | None = None
    """Folder for optimized.g2o and graph.png; nothing is written without it."""


def run(arguments: list[str]) -> int:
    """Run the verb."""
    options = parse(Optimize, "optimize", arguments)
    file, out = options.file, options.out
    before = read_g2o(file)
    try:
        chi2_before = chi2_of(before)
        after, chi2_after = optimize_pose_graph(before)
    except TestbedError as error:
        raise TestbedError(f"{file}: {error}") from None
    print(
        f"{file.name}: {len(before.ids)} vertices, {len(before.edges)} edges, "
        f"chi2 {chi2_before:.2f} before, {chi2_after:.2f} after"
    )
    if out is not None:
        if (out / GRAPH_FILE).resolve() == file.resolve():
            raise TestbedError(f"--out {out}: holds {file.name} itself; must be another folder")
        with run_folder(out):
            _write(out, before, after, (chi2_before, chi2_after))
        print(f"{GRAPH_FILE} and {PICTURE} are in {out}/")
    return 0


def _write(out: Path, before: PoseGraph, after: PoseGraph, chi2: tuple[float, float]) -> None:
    write_g2o(out / GRAPH_FILE, after)
    titles = (f"before: chi2 {chi2[0]:.2f}", f"after: chi2 {chi2[1]:.2f}")
    save_graph_picture(out / PICTURE, before, after, titles)

"""``burger compare``: scores a map file against a floor plan or another map."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional

from evaluation.run_folder import run_folder, write_json
from evaluation.scores.comparison import Comparison, compare_map
from mapping.compare import MapScores
from mapping.plot import save_map_picture
from scripts.arguments import parse


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Score a map against the truth, without aligning it; --align tells its best fit as well."""

    map: Annotated[Path, Positional]
    """The map's YAML, as map_server writes it."""
    world: str | None = None
    """Truth: a built-in world by name, random:SEED, or a floor plan file."""
    truth: Path | None = None
    """Truth: another map's YAML."""
    align: bool = False
    """Also find the shift and turn that fit best, within 0.5 m and 10 degrees, and score that."""
    out: Path | None = None
    """Folder for scores.json and overlay.png; nothing is written without it."""


def run(arguments: list[str]) -> int:
    """Run the verb."""
    options = parse(Compare, "compare", arguments)
    comparison = compare_map(
        options.map, world=options.world, truth_path=options.truth, align=options.align
    )
    print(_table(comparison))
    if options.out is not None:
        with run_folder(options.out):
            _write(comparison, options.out, options.map.stem)
        print(f"scores.json and overlay.png are in {options.out}/")
    return 0


def _table(comparison: Comparison) -> str:
    columns = [("as it lies", comparison.scores)]
    if comparison.alignment is not None:
        columns.append(("aligned", comparison.alignment.scores))
    lines = [f"{'':<22}" + "".join(f"{name:>12}" for name, _ in columns)]
    for key in asdict(comparison.scores):
        lines.append(f"{key:<22}" + "".join(f"{_shown(scores, key):>12}" for _, scores in columns))
    if comparison.alignment is not None:
        x, y, yaw = comparison.alignment.pose
        lines.append(f"best fit: x {x:+.3f} m, y {y:+.3f} m, yaw {math.degrees(yaw):+.2f} deg")
    return "\n".join(lines)


def _shown(scores: MapScores, key: str) -> str:
    value = getattr(scores, key)
    return "-" if value is None else f"{value:.4f}"


def _write(comparison: Comparison, folder: Path, name: str) -> None:
    alignment = comparison.alignment
    f1 = comparison.scores.f1_5cm
    save_map_picture(
        folder / "overlay.png",
        comparison.map_file,
        truth=comparison.truth,
        title=f"{name}: F1(5 cm) {'-' if f1 is None else format(f1, '.3f')}",
    )
    write_json(
        folder / "scores.json",
        {
            "scores": asdict(comparison.scores),
            "alignment": None if alignment is None else asdict(alignment),
        },
    )

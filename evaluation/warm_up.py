"""Compiles the numba kernels by a tiny episode, so that no measured loop pays for it."""

from dataclasses import dataclass
from pathlib import Path

from envs.floor_plan import Cylinder, FloorPlan, Wall

PACKAGES = ("mapping", "nav", "envs")
TINY_ROOM = FloorPlan(
    name="tiny_room",
    start=(0.5, 0.5, 0.0),
    walls=(Wall(points=((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)), closed=True),),
    cylinders=(Cylinder(center=(2.0, 1.2), radius=0.3),),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class KernelCache:
    """Which kernel files have compiled code beside them."""

    compiled: int
    total: int

    @property
    def is_cold(self) -> bool:
        """Whether something must be compiled before the first run."""
        return self.compiled < self.total


def kernel_cache() -> KernelCache:
    """Count the kernel files and those whose compiled code is newer than they are."""
    root = Path(__file__).resolve().parents[1]
    sources = [
        source
        for package in PACKAGES
        for source in (root / package).rglob("*.py")
        if "@njit" in source.read_text(encoding="utf-8")
    ]
    compiled = sum(_is_compiled(source) for source in sources)
    return KernelCache(compiled=compiled, total=len(sources))


def compile_kernels() -> None:
    """Run a tiny episode with each mapper; numba keeps what it compiles for the next process."""
    from evaluation.episode import EpisodeConfig, run_episode
    from mapping.mappers import MAPPERS

    for mapper in MAPPERS:
        config = EpisodeConfig(mapper=mapper, odometry="truth", time_limit=20.0)
        run_episode(config, plan=TINY_ROOM)


def _is_compiled(source: Path) -> bool:
    changed = source.stat().st_mtime
    indices = (source.parent / "__pycache__").glob(f"{source.stem}.*.nbi")
    return any(index.stat().st_mtime >= changed for index in indices)

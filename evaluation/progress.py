"""Tells how an episode stands while it goes on: for those who watch, and for moving pictures."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import Observation
from nav.agent import MappingAgent
from nav.navigator import Plan


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How an episode stands, told once a simulated second."""

    time: float
    """Simulated time [s]."""
    coverage: float
    grid: OccupancyGrid
    pose_map: Pose
    observation: Observation | None = None
    """The messages of the newest control period."""
    plan: Plan = Plan()
    """What the navigator has in mind."""
    people_world: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    """Where people are ``(n, 2)`` [m]: the truth, for pictures only."""


def progress_of(
    measured: tuple[float, float],
    agent: MappingAgent,
    observation: Observation,
    info: dict[str, Any],
) -> Progress:
    """How it stands with an agent, after an environment's step.

    Args:
        measured: The simulated time [s], and the coverage then.
        agent: Who drives.
        observation: What the step brought.
        info: The truth with it.
    """
    return Progress(
        time=measured[0],
        coverage=measured[1],
        grid=agent.mapper.grid,
        pose_map=agent.mapper.pose_map,
        observation=observation,
        plan=agent.navigator.plan,
        people_world=info["pedestrians"],
    )

"""A mapper that draws its map anew again and again, turned about the start: so a loop closes."""

from collections.abc import Sequence

import gymnasium
import numpy as np
import pytest

from envs.worlds import load_world
from evaluation.episode import ENVIRONMENT
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.mappers import make_mapper
from mapping.messages import Imu, LaserScan, Odometry
from mapping.pose_history import PoseHistory
from nav.agent import MappingAgent
from nav.navigator import COMPLETE, RUNNING, Navigator
from nav.navigators import make_navigator

EVERY = 80
"""Control periods between two redraws: 8 s."""


class RestlessMapper:
    """Three maps of the same run, of which another one is shown every few seconds."""

    def __init__(self, start: tuple[float, float, float], turn: float) -> None:
        x, y, yaw = start
        self._mappers = [
            make_mapper("ogm", start_pose_map=(x, y, yaw + turned), resolution=0.02)
            for turned in (0.0, turn, -turn)
        ]
        self._calls = 0

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        for mapper in self._mappers:
            mapper.update(scan, odometry, imu)
        self._calls += 1
        self.grid.redraws = self._calls // EVERY

    @property
    def _shown(self) -> int:
        return self._calls // EVERY % len(self._mappers)

    @property
    def grid(self) -> OccupancyGrid:
        return self._mappers[self._shown].grid

    @property
    def pose_map(self) -> Pose:
        return self._mappers[self._shown].pose_map

    @property
    def updates(self) -> int:
        return self._mappers[0].updates

    @property
    def scans_dropped(self) -> int:
        return 0

    @property
    def trajectory(self) -> PoseHistory:
        return self._mappers[self._shown].trajectory

    def finish(self) -> None:
        """Nothing is put off."""


def drive(world: str, turn: float, navigator: Navigator, seconds: float) -> tuple[Pose, int]:
    """True poses ``(n, 3)`` until the navigator stops, and the contacts.

    The maps are turned by 0, ``turn`` and ``-turn`` [rad].
    """
    plan = load_world(world)
    agent = MappingAgent(RestlessMapper(plan.start, turn), navigator)
    environment = gymnasium.make(ENVIRONMENT, world=plan, odometry="truth", max_episode_steps=10**6)
    observation, info = environment.reset(seed=0)
    poses = []
    for _ in range(round(10 * seconds)):
        action = agent.act(observation)
        poses.append(info["pose_world"].copy())
        if navigator.status != RUNNING:
            break
        observation, _, _, _, info = environment.step(action)
    environment.close()
    return np.array(poses), int(info["contacts"])


@pytest.mark.parametrize(
    ("world", "turn"),
    [
        ("corridor_loop", 0.06),  # far walls move 0.7 m: on a stale costmap it never comes home
        ("narrow_door", 0.15),  # returns left where they were make it bump into the door
    ],
)
def test_the_explorer_finishes_and_comes_home_on_a_map_that_keeps_jumping(
    world: str, turn: float
) -> None:
    navigator = make_navigator("frontier")
    poses, contacts = drive(world, turn, navigator, 400.0)
    assert navigator.status == COMPLETE
    assert contacts == 0
    assert np.hypot(*(poses[-1] - poses[0])[:2]) < 0.15
    reached = poses[:, :2].max(axis=0) - poses[:, :2].min(axis=0)
    assert reached.max() > 2.0, "it explored"


def test_waypoints_are_reached_on_a_map_that_keeps_jumping() -> None:
    navigator = make_navigator("waypoints", [(1.2, 2.0), (1.2, 5.2), (3.0, 4.8), (2.2, 0.9)])
    poses, contacts = drive("lim_room", 0.06, navigator, 300.0)
    assert navigator.status == COMPLETE
    assert contacts == 0
    # each is reached where the map of the moment has it: within its 0.2 m and 0.06 rad at 5 m
    for place in ((1.2, 2.0), (1.2, 5.2), (3.0, 4.8)):
        assert np.hypot(*(poses[:, :2] - place).T).min() < 0.2 + 0.06 * 5.0

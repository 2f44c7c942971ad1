"""Records a drive once: its messages, its true poses, and the moments that figures refer to."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from envs.floor_plan import FloorPlan
from envs.worlds import load_world
from evaluation.episode import EpisodeConfig, drive_episode, make_environment, navigator_of
from evaluation.recording import Recording
from evaluation.thesis.taped_mapper import TapedMapper
from mapping.burger import LIDAR_POSE_BASE
from mapping.mappers import make_mapper
from mapping.sensor_log import SensorLog
from mapping.trajectory import Trajectory, path_length
from nav.agent import MappingAgent

TURNED_ROUND = 1.0
"""When the robot is this far from its farthest place again [m], it has turned round there."""

LAST_MESSAGES = 0.3
"""Odometry goes on for so long after a log's last scan begins [s]: its beams take 0.2 s."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drive:
    """What a recorded drive left: every mapper maps this same log."""

    config: EpisodeConfig
    plan: FloorPlan
    log: SensorLog
    ground_truth: Trajectory
    stop_reason: str
    contacts: int

    @property
    def length(self) -> float:
        """Way that the robot went [m]."""
        return path_length(self.ground_truth.poses)

    @property
    def end(self) -> float:
        """Time at the end [s]."""
        return float(self.ground_truth.stamps[-1])

    @property
    def farthest(self) -> float:
        """When the robot was as far from its start as it came [s]."""
        return float(self.ground_truth.stamps[np.argmax(self._away(0))])

    @property
    def turned(self) -> float:
        """When, after that, it had turned round and left that place [s]; else the end."""
        index = int(np.argmax(self._away(0)))
        left = np.flatnonzero(self._away(index)[index:] > TURNED_ROUND)
        return float(self.ground_truth.stamps[index + left[0]]) if len(left) else self.end

    def recording(self, until: float) -> Recording:
        """The log up to a time [s], as a replay takes it."""
        return Recording(
            log=self.log_between(0.0, until),
            ground_truth=self.ground_truth,
            world=self.config.world,
            plan=self.plan,
        )

    def log_between(self, first: float, last: float) -> SensorLog:
        """The scans that begin between two times [s], and all other messages up to the later."""
        end = last + LAST_MESSAGES
        return replace(
            self.log,
            scans=tuple(scan for scan in self.log.scans if first <= scan.stamp <= last),
            odometry=tuple(each for each in self.log.odometry if each.stamp <= end),
            imu=tuple(each for each in self.log.imu if each.stamp <= end),
        )

    def _away(self, index: int) -> NDArray[np.float64]:
        """Distance of every true pose ``(n,)`` to the one of an index [m]."""
        positions = self.ground_truth.poses[:, :2]
        return np.asarray(np.hypot(*(positions - positions[index]).T), dtype=np.float64)


def record_drive(config: EpisodeConfig) -> Drive:
    """Drive through a world and keep every message.

    Raises:
        TestbedError: The config names something that does not exist or cannot be used.
    """
    plan = load_world(config.world)
    mapper = TapedMapper(
        make_mapper(config.mapper, start_pose_map=plan.start, resolution=config.resolution)
    )
    environment = make_environment(config, plan)
    try:
        agent = MappingAgent(mapper, navigator_of(config, plan))
        episode = drive_episode(config, plan, agent, environment)
    finally:
        environment.close()
    return Drive(
        config=config,
        plan=plan,
        log=mapper.log(config.world, LIDAR_POSE_BASE),
        ground_truth=Trajectory(stamps=episode.track.stamps, poses=episode.track.pose_world),
        stop_reason=episode.stop_reason,
        contacts=episode.contacts,
    )

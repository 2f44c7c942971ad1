"""The loop of an episode: an agent drives an environment, turn by turn, until something ends it."""

from collections.abc import Callable
from time import perf_counter
from typing import Any

import gymnasium

from evaluation.held_interrupt import held_interrupt
from evaluation.progress import Progress, progress_of
from evaluation.recorder import Recorder
from evaluation.track import Track
from mapping.burger import LIDAR_RANGE_MAX, MAX_LINEAR_SPEED
from mapping.coverage import CoverageMeter
from mapping.messages import ODOMETRY_COLUMNS
from nav.agent import MappingAgent
from nav.navigator import RUNNING

TIME_LIMIT, TOPPLED, INTERRUPTED, ERROR = "time_limit", "toppled", "interrupted", "error"
"""What ends an episode besides its navigator."""


class EpisodeLoop:
    """Runs one episode and keeps what is noted on the way, whatever ends it.

    Args:
        agent: Maps and drives.
        environment: ``envs:TurtleBot3Burger-v0``.
        meter: Measures coverage, once a simulated second.
        on_progress: Called once a simulated second.
        recorder: Notes the messages of every control period.

    Attributes:
        track: True, estimated and odometry's poses, one a turn.
        coverages: Time [s] and coverage, in order.
        stop_reason: Why it ended: what the navigator says, or one of those above.
        error: What ended it, if ``stop_reason`` is ``"error"``.
        info: The environment's newest ``info``.
        time: Simulated time at the end [s].
        wall_time: Wall time of it [s], without telling of its progress.
    """

    def __init__(
        self,
        agent: MappingAgent,
        environment: gymnasium.Env[Any, Any],
        meter: CoverageMeter,
        on_progress: Callable[[Progress], None] | None = None,
        recorder: Recorder | None = None,
    ) -> None:
        self.track = Track()
        self.coverages: list[tuple[float, float]] = []
        self.stop_reason = RUNNING
        self.error: Exception | None = None
        self.wall_time = 0.0
        self._agent, self._environment, self._meter = agent, environment, meter
        self._on_progress, self._recorder = on_progress, recorder
        self._next_report, self._telling = 0.0, 0.0

    def run(self, seed: int) -> None:
        """Run to the end and finish the map.

        Ctrl-C and errors end the episode early; before its first turn they are raised.
        """
        self._observation, self.info = self._environment.reset(seed=seed)
        started = perf_counter()
        try:
            with held_interrupt() as check_interrupt:
                while self.stop_reason == RUNNING:
                    check_interrupt()
                    self._turn()
        except KeyboardInterrupt:
            self._end_early(INTERRUPTED)
        except Exception as error:
            self._end_early(ERROR, error)
        try:
            self._agent.mapper.finish()
        except Exception as error:
            self._end_early(ERROR, self.error or error)
        self.wall_time = perf_counter() - started - self._telling

    @property
    def time(self) -> float:
        """Simulated time of the newest observation [s]."""
        return float(self._observation["time"][0])

    def _end_early(self, reason: str, error: Exception | None = None) -> None:
        """Note what ended the episode; called where that was caught."""
        if len(self.track) == 0:
            raise  # there is nothing to keep yet
        self.stop_reason, self.error = reason, error

    def _turn(self) -> None:
        """Map and decide, note it all, and drive for a control period."""
        agent, observation = self._agent, self._observation
        action = agent.act(observation)
        if self._recorder is not None:
            self._recorder.note(observation, action, agent.mapper.pose_map, agent.mapper.grid)
        self._note_track()
        self.stop_reason = agent.navigator.status
        if self.time >= self._next_report or self.stop_reason != RUNNING:
            self._next_report = self.time + 1.0
            self._report()
        if self.stop_reason == RUNNING:
            self._observation, _, toppled, truncated, self.info = self._environment.step(action)
            if toppled or truncated:
                self.stop_reason = TOPPLED if toppled else TIME_LIMIT

    def _note_track(self) -> None:
        newest = self._observation["odometry"][-1]
        pose_odom = newest[ODOMETRY_COLUMNS.index("x") : ODOMETRY_COLUMNS.index("yaw") + 1]
        self.track.note(self.time, self._agent.mapper.pose_map, self.info["pose_world"], pose_odom)

    def _report(self) -> None:
        """Measure coverage where it may have changed, and tell of it."""
        grid = self._agent.mapper.grid
        self.coverages.append((self.time, self._meter.measure(grid, self._lately_seen())))
        if self._on_progress is not None:
            told = perf_counter()
            self._on_progress(
                progress_of(self.coverages[-1], self._agent, self._observation, self.info)
            )
            self._telling += perf_counter() - told

    def _lately_seen(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top [m] of what the last simulated second may have changed."""
        x, y, _ = self._agent.mapper.pose_map
        reach = LIDAR_RANGE_MAX + 2.0 * MAX_LINEAR_SPEED
        return float(x - reach), float(x + reach), float(y - reach), float(y + reach)

"""The Gymnasium environment of a Burger with its raw sensors."""

import dataclasses
import math
from pathlib import Path
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from envs.burger_constants import CONTROL_PERIOD, IMU_RATE, ODOMETRY_RATE
from envs.camera import checked_camera
from envs.floor_plan import MAX_COORDINATE, FloorPlan
from envs.imu import ACCEL_RANGE, GYRO_RANGE, ImuConfig
from envs.lidar_noise import LidarConfig
from envs.presets import preset
from envs.sensor_batch import SensorBatch
from envs.simulation import Simulation
from envs.wheel_encoders import ODOMETRY_PRESETS, OdometryConfig, YawSource
from envs.worlds import load_world
from mapping.burger import (
    LIDAR_BEAMS,
    LIDAR_RANGE_MAX,
    LIDAR_SCAN_TIME,
    MAX_ANGULAR_SPEED,
    MAX_LINEAR_SPEED,
)
from mapping.errors import TestbedError

ODOMETRY_ROWS = round(CONTROL_PERIOD * ODOMETRY_RATE)
"""Odometry messages of one step."""

IMU_ROWS = round(CONTROL_PERIOD * IMU_RATE)
"""IMU messages of one step."""

_FOREVER = 1e9
"""A bound on time [s] that no episode reaches: 30 years."""

_ANY_SPEED = 1e3
"""A bound on speeds [m/s, rad/s] that no robot of 1 kg reaches; bounds must be finite."""

Observation = dict[str, NDArray[Any]]
Action = NDArray[np.float32]


class BurgerEnv(gym.Env[Observation, Action]):  # type: ignore[misc]  # mypy skips gymnasium
    """A TurtleBot3 Burger that drives through a floor plan: raw sensors in, velocity commands out.

    One step is one control period of 0.1 s (50 physics steps of 2 ms). Its observation carries
    every message that arrived in it. The truth travels in ``info`` only.

    ## Action space

    ``Box([-0.22, -2.84], [0.22, 2.84], (2,), float32)``, as /cmd_vel, in physical units. What lies
    outside is clamped; then each wheel is clamped to 61 rpm as the firmware does (0.211 m/s,
    2.63 rad/s). The motors follow with a lag of 0.05 s.

    | index | meaning | unit |
    |---|---|---|
    | 0 | forward speed ``linear.x`` | m/s |
    | 1 | turn rate ``angular.z``, counter-clockwise positive | rad/s |

    ## Observation space

    A ``Dict``. ``LaserScan``, ``Odometry`` and ``Imu`` of ``mapping.messages`` read it
    (``from_observation``).

    | key | type | meaning |
    |---|---|---|
    | ``time`` | (1,) float64 | time since the start [s] |
    | ``scan_stamp`` | (1,) float64 | time of the first beam of the newest whole scan [s] |
    | ``ranges`` | (360,) float32 | that scan [m], 1 degree apart, counter-clockwise from ahead |
    | ``odometry`` | (3, 6) float64 | ``ODOMETRY_COLUMNS``, 30 Hz, from where the robot started |
    | ``imu`` | (10, 11) float64 | ``IMU_COLUMNS`` of imu_link, 100 Hz |

    In ``ranges``, 3.5 is nothing within range and 0.0 a failed beam (with ``no_return="zero"`` both
    are 0.0). The scan is rolling: beam i was taken at ``scan_stamp + i / 1800``, from where the
    robot then was. The columns of ``odometry`` are stamp, x, y, yaw, linear_x, angular_z; those of
    ``imu`` stamp, orientation x, y, z, w, angular velocity x, y, z, linear acceleration x, y, z.

    A scan takes 0.2 s, so every other step repeats the scan of the step before; its stamp tells.

    ## Reward, termination, truncation

    The reward is always 0.0: this environment is the robot, tasks wrap it. It terminates when the
    robot has toppled (leans by more than 60 degrees; people's feet can knock it over, and nothing
    sets it up again), but not in a crash; ``TimeLimit`` truncates after ``max_episode_steps`` (30
    minutes by default).

    ## Info

    | key | type | meaning |
    |---|---|---|
    | ``pose_world`` | (3,) float64 | true pose x, y, yaw of base_footprint [m, m, rad] |
    | ``velocity_base`` | (2,) float64 | true forward speed and turn rate [m/s, rad/s] |
    | ``contacts`` | int | how often the robot ran into something, people among it |
    | ``contacts_by_people`` | int | how often people ran into the robot |
    | ``pedestrians`` | (n, 2) float64 | where the n people are, x, y in the world [m] |

    A contact is a part of the robot beginning to touch something but the floor. It counts in
    ``contacts`` if that stands still, or is a person whom the robot moved towards faster than 0.02
    m/s at the place where they first touched; else it counts in ``contacts_by_people``. So does
    what people push the robot into, until half a second after they let go of it, or after it drives
    on if it came to rest.

    ## Start

    The robot stands at the plan's start pose, settled on its wheels, and stays there for 0.2 s
    while the lidar turns once, so that the first observation has a whole scan (and ``time`` 0.2).
    Sensors draw new errors of their own at every reset, and random people new loops.
    ``reset(options=...)`` takes:

    | option | meaning |
    |---|---|
    | ``start`` | pose (x, y, yaw) in the world for this episode, where the robot has room |
    | ``world`` | another world from now on: a name, a file or a ``FloorPlan`` |

    Args:
        world: Name of a built-in world, a file that ``envs.worlds.load_world`` reads, or a plan.
        people: How many people walk there on random loops, besides those of the plan.
        lidar: ``datasheet``, ``worst_case``, ``measured``, ``dropouts``, ``ideal``, or a
            ``LidarConfig``.
        odometry: ``typical``, ``poor``, ``ideal``, ``truth``, or an ``OdometryConfig``.
        odometry_yaw: ``encoders`` or ``imu``: what the heading in odometry comes from; None leaves
            it to ``odometry``.
        imu: ``typical``, ``drifting``, ``ideal``, or an ``ImuConfig``.
        render_mode: ``rgb_array`` or None; for ``human``, ``gymnasium.make`` shows these
            pictures in a window (needs pygame).
        camera: What ``render`` looks through: ``chase``, ``portrait`` or ``top``.

    Raises:
        TestbedError: A name, a file or a figure is not usable.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "render_modes": ["rgb_array"],
        "render_fps": round(1.0 / CONTROL_PERIOD),
    }

    def __init__(
        self,
        world: str | Path | FloorPlan = "turtlebot3_world",
        *,
        people: int = 0,
        lidar: str | LidarConfig = "datasheet",
        odometry: str | OdometryConfig = "typical",
        odometry_yaw: YawSource | None = None,
        imu: str | ImuConfig = "typical",
        render_mode: str | None = None,
        camera: str = "chase",
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise TestbedError(f"render_mode: {render_mode!r}; must be 'rgb_array' or None")
        odometry = preset("odometry", odometry, ODOMETRY_PRESETS)
        if odometry_yaw is not None:
            odometry = dataclasses.replace(odometry, yaw_source=odometry_yaw)
        self.render_mode = render_mode
        self.action_space = _action_space()
        self.observation_space = _observation_space()
        self._camera = checked_camera(camera)
        self._people = people
        self._lidar, self._odometry, self._imu = lidar, odometry, imu
        self._simulation = self._simulate(world)

    @property
    def plan(self) -> FloorPlan:
        """The floor plan that the robot drives in: the truth, for scoring."""
        return self._simulation.plan

    @property
    def scene_state(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """MuJoCo's ``qpos`` and ``mocap_pos`` of this moment: the truth, for drawing."""
        data = self._simulation.data
        return data.qpos, data.mocap_pos

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode; see the class for ``options``."""
        super().reset(seed=seed)
        options = dict(options or {})
        world, start = options.pop("world", None), options.pop("start", None)
        if options:
            raise TestbedError(f"reset option: {min(options)!r}; must be 'start' or 'world'")
        if world is not None:
            self._simulation.close()
            self._simulation = self._simulate(world)
        if start is not None:
            start = _checked_start(self.plan, start)
        self._simulation.reset(start, self.np_random)
        return self._observe(self._simulation.advance(LIDAR_SCAN_TIME)), self._info()

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive for one control period."""
        if np.shape(action) != (2,):
            raise TestbedError(f"action: shape {np.shape(action)}; must be (2,)")
        self._simulation.command(float(action[0]), float(action[1]))
        observation = self._observe(self._simulation.advance())
        return observation, 0.0, self._simulation.has_toppled, False, self._info()

    def carry_off(self, pose: tuple[float, float, float]) -> None:
        """Put the robot down elsewhere without its sensors noticing; see ``Simulation``.

        Raises:
            TestbedError: It has no room there.
        """
        self._simulation.carry_off(_checked_start(self.plan, pose))

    def render(self) -> NDArray[np.uint8] | None:
        """The picture of this moment ``(480, 640, 3)``, or None without ``render_mode``."""
        return self._simulation.render(self._camera) if self.render_mode else None

    def close(self) -> None:
        """Give the OpenGL context back."""
        self._simulation.close()

    def _simulate(self, world: str | Path | FloorPlan) -> Simulation:
        """A simulation of a world with this environment's sensors."""
        plan = world if isinstance(world, FloorPlan) else load_world(world)
        return Simulation(
            plan,
            people=self._people,
            lidar=self._lidar,
            odometry=self._odometry,
            imu=self._imu,
        )

    def _observe(self, batch: SensorBatch) -> Observation:
        """The observation after a batch of messages; the newest scan stays until the next."""
        if batch.ranges is not None:
            self._ranges = np.minimum(batch.ranges, np.float32(LIDAR_RANGE_MAX))
            self._scan_stamp = batch.scan_stamp
        return {
            "time": np.array([self._simulation.time]),
            "scan_stamp": np.array([self._scan_stamp]),
            "ranges": self._ranges.copy(),
            "odometry": batch.odometry[-ODOMETRY_ROWS:].copy(),
            "imu": batch.imu[-IMU_ROWS:].copy(),
        }

    def _info(self) -> dict[str, Any]:
        """The truth."""
        return {
            "pose_world": self._simulation.pose_world,
            "velocity_base": np.array(self._simulation.velocity_base),
            "contacts": self._simulation.contacts,
            "contacts_by_people": self._simulation.contacts_by_people,
            "pedestrians": self._simulation.pedestrians,
        }


def _action_space() -> spaces.Box:
    """Velocity commands."""
    limits = np.array([MAX_LINEAR_SPEED, MAX_ANGULAR_SPEED], dtype=np.float32)
    return spaces.Box(-limits, limits, dtype=np.float32)


def _observation_space() -> spaces.Dict:
    """The messages of one step, all bounds finite."""
    odometry = np.array([_FOREVER, MAX_COORDINATE, MAX_COORDINATE, np.pi, _ANY_SPEED, _ANY_SPEED])
    imu = np.array([_FOREVER, *[1.0] * 4, *[GYRO_RANGE] * 3, *[ACCEL_RANGE] * 3])
    return spaces.Dict(
        {
            "time": spaces.Box(0.0, _FOREVER, (1,), np.float64),
            "scan_stamp": spaces.Box(-1.0, _FOREVER, (1,), np.float64),
            "ranges": spaces.Box(0.0, LIDAR_RANGE_MAX, (LIDAR_BEAMS,), np.float32),
            "odometry": _rows(odometry, ODOMETRY_ROWS),
            "imu": _rows(imu, IMU_ROWS),
        }
    )


def _rows(limits: NDArray[np.float64], rows: int) -> spaces.Box:
    """Rows of figures, each between plus and minus its limit."""
    high = np.tile(limits, (rows, 1))
    return spaces.Box(-high, high, dtype=np.float64)


def _checked_start(plan: FloorPlan, start: Any) -> tuple[float, float, float]:
    """A start pose from the options, or one line that says what is wrong with it."""
    try:
        x, y, yaw = (float(value) for value in start)
    except (TypeError, ValueError) as error:
        raise TestbedError(f"start: {start!r}; must be three numbers (x, y, yaw)") from error
    left, right, bottom, top = plan.bounds
    if math.isfinite(x + y) and not (left <= x <= right and bottom <= y <= top):
        raise TestbedError(
            f"start: ({x:g}, {y:g}) is off the plan; must be x {left:g} to {right:g}, "
            f"y {bottom:g} to {top:g}"
        )
    return dataclasses.replace(plan, start=(x, y, yaw)).start

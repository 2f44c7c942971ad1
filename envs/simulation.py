"""Turns velocity commands into the messages of a Burger that drives through a floor plan."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

import mujoco
import numpy as np
from numpy.typing import NDArray

from envs.burger_constants import (
    COMMAND_TIMEOUT,
    CONTROL_PERIOD,
    IMU_RATE,
    STEPS_PER_SECOND,
    TIMESTEP,
)
from envs.camera import SceneCamera
from envs.drive import wheel_speeds
from envs.floor_plan import FloorPlan
from envs.imu import IMU_PRESETS, ImuConfig, InertialUnit, yaw_of
from envs.lidar import BLOCK_STEPS, Lidar
from envs.lidar_noise import LIDAR_PRESETS, LidarConfig
from envs.scene import FLOOR, build_scene, place, planar_pose, planar_velocity
from envs.schedule import IMU_STEPS, is_odometry_step, next_event
from envs.wheel_encoders import (
    ODOMETRY_PRESETS,
    OdometryConfig,
    OdometryRow,
    WheelEncoders,
)
from mapping.burger import LIDAR_SCAN_TIME
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.messages import ODOMETRY_COLUMNS

SETTLE_STEPS = STEPS_PER_SECOND // 2
"""Steps in which the robot comes to rest on its tyres before time starts."""

_TIMEOUT_STEPS = round(COMMAND_TIMEOUT * STEPS_PER_SECOND)
_BLOCK_STATES = BLOCK_STEPS // IMU_STEPS + 1
"""States that the lidar needs to know how the base moved during a block."""

_APART_STEPS = STEPS_PER_SECOND // 2
"""How long a robot part and a thing must be apart before they can touch anew [steps]: 0.5 s."""

Config = TypeVar("Config")


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorBatch:
    """The messages of a stretch of time, oldest first."""

    odometry: NDArray[np.float64]
    """Rows ``(n, 6)``, columns messages.ODOMETRY_COLUMNS."""
    imu: NDArray[np.float64]
    """Rows ``(m, 11)``, columns messages.IMU_COLUMNS."""
    scan_stamp: float | None
    """Time of the first beam of the newest whole scan that ended in this stretch [s], if any."""
    ranges: NDArray[np.float32] | None
    """Its ranges ``(360,)`` [m]: ``+inf`` (or 0.0) is no return, 0.0 a failed beam."""


class Simulation:
    """A Burger in a floor plan, stepped by 2 ms, with its sensors.

    Args:
        plan: Where it drives.
        lidar: Name of a preset of ``lidar_noise`` or a configuration.
        odometry: Name of a preset of ``wheel_encoders`` or a configuration.
        imu: Name of a preset of ``imu`` or a configuration.
        rng: Seed or generator; each sensor gets a generator of its own, spawned from it.

    Raises:
        TestbedError: A preset does not exist.
    """

    def __init__(
        self,
        plan: FloorPlan,
        *,
        lidar: str | LidarConfig = "datasheet",
        odometry: str | OdometryConfig = "typical",
        imu: str | ImuConfig = "typical",
        rng: int | np.random.Generator | None = None,
    ) -> None:
        self.plan = plan
        self.model = build_scene(plan)
        self.data = mujoco.MjData(self.model)
        self._lidar = Lidar(self.model, preset("lidar", lidar, LIDAR_PRESETS))
        self._encoders = WheelEncoders(preset("odometry", odometry, ODOMETRY_PRESETS))
        self._imu = InertialUnit(preset("imu", imu, IMU_PRESETS))
        self._camera = SceneCamera(plan)
        self._floor = self.model.geom(FLOOR).id
        self._rng = np.random.default_rng(rng)
        self.reset()

    @property
    def time(self) -> float:
        """Time since the reset [s]."""
        return self._step * TIMESTEP

    @property
    def pose_world(self) -> Pose:
        """True pose ``(3,)`` of base_footprint in the world."""
        return planar_pose(self.data.qpos)

    @property
    def velocity_base(self) -> tuple[float, float]:
        """True forward speed [m/s] and turn rate [rad/s] of base_footprint."""
        return planar_velocity(self.data.qpos, self.data.qvel)

    @property
    def contacts(self) -> int:
        """How often a part of the robot began to touch something that is not the floor.

        Looked at every 10 ms. Each pair of a robot part and a thing counts for itself, and counts
        again when it had been apart for half a second: a push against a wall chatters.
        """
        return self._contacts

    def reset(
        self,
        start: tuple[float, float, float] | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        """Put the robot at rest at a pose in the world (the plan's start), with new sensors.

        It settles on its wheels; then time, odometry and contacts start from zero.
        """
        self._rng = self._rng if rng is None else rng
        place(self.model, self.data, np.array(self.plan.start if start is None else start))
        mujoco.mj_step(self.model, self.data, nstep=SETTLE_STEPS)
        self._step, self._command_step = 0, 0
        self._contacts = 0
        self._touched: dict[tuple[int, int], int] = {}
        self._positions = [self.data.qpos[:7].copy()]
        self._velocities = [self.data.qvel[:6].copy()]
        lidar_rng, encoders_rng, imu_rng = self._rng.spawn(3)
        self._lidar.reset(lidar_rng)
        self._encoders.reset(encoders_rng, _wheel_angles(self.data.qpos), self.pose_world)
        self._imu.reset(imu_rng)
        self._imu_yaw = 0.0

    def command(self, linear: float, angular: float) -> None:
        """Drive at these speeds [m/s, rad/s] from now on, for 0.5 s at most.

        Raises:
            TestbedError: A speed is not finite.
        """
        self.data.ctrl[:] = wheel_speeds(linear, angular)
        self._command_step = self._step

    def advance(self, dt: float = CONTROL_PERIOD) -> SensorBatch:
        """Let time pass [s] and return the messages that came in it."""
        begin, end = self._step, self._step + round(dt * STEPS_PER_SECOND)
        if end <= begin:
            raise TestbedError(f"dt: {dt} s; must be at least one step of {TIMESTEP} s")
        self._positions = self._positions[-_BLOCK_STATES:]
        self._velocities = self._velocities[-1:]
        self._wheels: list[tuple[int, NDArray[np.float64], NDArray[np.float64]]] = []
        self._scan: tuple[float, NDArray[np.float32]] | None = None
        while self._step < end:
            event = min(next_event(self._step), end)
            mujoco.mj_step(self.model, self.data, nstep=event - self._step)
            self._step = event
            self._observe()
        return self._collect(begin)

    def render(
        self, camera: str = "chase", width: int = 640, height: int = 480
    ) -> NDArray[np.uint8]:
        """A picture ``(height, width, 3)`` from ``chase``, ``portrait`` or ``top``.

        Raises:
            TestbedError: There is no such camera, the size is not drawable, or there is no OpenGL.
        """
        return self._camera.picture(self.data.qpos, camera, width, height)

    def close(self) -> None:
        """Give the OpenGL context back; may be called again."""
        self._camera.close()

    def _observe(self) -> None:
        """Read what is due at this step."""
        if self._step - self._command_step >= _TIMEOUT_STEPS:
            self.data.ctrl[:] = 0.0
        self._count_contacts()
        if self._step % IMU_STEPS == 0:
            self._positions.append(self.data.qpos[:7].copy())
            self._velocities.append(self.data.qvel[:6].copy())
        if self._step % BLOCK_STEPS == 0:
            ranges = self._lidar.cast_block(self.data, np.array(self._positions[-_BLOCK_STATES:]))
            if ranges is not None:
                self._scan = (self.time - LIDAR_SCAN_TIME, ranges)
        if is_odometry_step(self._step):
            self._wheels.append((self._step, self.data.qpos[:9].copy(), self.data.qvel[:6].copy()))

    def _count_contacts(self) -> None:
        """Count the pairs of robot part and thing that touch now and did not lately."""
        for first, second in self.data.contact.geom.tolist():
            if self._floor in (first, second):
                continue
            last = self._touched.get((first, second), -_APART_STEPS - 1)
            self._contacts += self._step - last > _APART_STEPS
            self._touched[first, second] = self._step

    def _collect(self, begin: int) -> SensorBatch:
        """Make messages of what was read since step ``begin``."""
        first = begin // IMU_STEPS + 1
        last = self._step // IMU_STEPS
        stamps = np.arange(first, last + 1) / IMU_RATE
        states = last - first + 2
        imu = self._imu.read(
            stamps, np.array(self._positions[-states:]), np.array(self._velocities[-states:])
        )
        odometry = np.empty((len(self._wheels), len(ODOMETRY_COLUMNS)))
        for i, (step, qpos, qvel) in enumerate(self._wheels):
            newest = step // IMU_STEPS - first
            yaw = yaw_of(imu[newest]) if newest >= 0 else self._imu_yaw
            odometry[i] = self._read_odometry(step * TIMESTEP, qpos, qvel, yaw)
        self._imu_yaw = yaw_of(imu[-1]) if len(imu) else self._imu_yaw
        stamp, ranges = self._scan or (None, None)
        return SensorBatch(odometry=odometry, imu=imu, scan_stamp=stamp, ranges=ranges)

    def _read_odometry(
        self, stamp: float, qpos: NDArray[np.float64], qvel: NDArray[np.float64], imu_yaw: float
    ) -> OdometryRow:
        """The odometry message of a moment."""
        if self._encoders.config.truth:
            return self._encoders.read_truth(stamp, planar_pose(qpos), planar_velocity(qpos, qvel))
        return self._encoders.read(stamp, _wheel_angles(qpos), imu_yaw)


def preset(field: str, choice: str | Config, presets: Mapping[str, Config]) -> Config:
    """The configuration that a name stands for; a configuration stands for itself.

    Raises:
        TestbedError: There is no preset of that name.
    """
    if not isinstance(choice, str):
        return choice
    if choice not in presets:
        raise TestbedError(f"{field}: {choice!r}; must be one of {', '.join(presets)}")
    return presets[choice]


def _wheel_angles(qpos: NDArray[np.float64]) -> tuple[float, float]:
    """Angles of the left and the right wheel [rad]."""
    left, right = qpos[7:9].tolist()
    return left, right

"""Turns velocity commands into the messages of a Burger that drives through a floor plan."""

import math
from typing import Any

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
from envs.contact_counter import ContactCounter
from envs.drive import wheel_speeds
from envs.floor_plan import FloorPlan
from envs.imu import FIRST_ROW, IMU_PRESETS, ImuConfig, InertialUnit, yaw_after
from envs.lidar import BLOCK_STEPS, Lidar
from envs.lidar_noise import LIDAR_PRESETS, LidarConfig
from envs.presets import preset
from envs.random_pedestrians import check_people, random_pedestrians
from envs.scene import build_scene, lean_of, place, planar_pose, planar_velocity
from envs.schedule import IMU_STEPS, is_odometry_step, next_event
from envs.sensor_batch import SensorBatch
from envs.stage_clock import stop_stage_clock
from envs.walkers import Walkers
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

TOPPLED = math.radians(60.0)
"""A robot that leans so far has fallen over and does not get up [rad]; driving leans it by 2 deg at
most."""

_TIMEOUT_STEPS = round(COMMAND_TIMEOUT * STEPS_PER_SECOND)
_BLOCK_STATES = BLOCK_STEPS // IMU_STEPS + 1
"""States that the lidar needs to know how the base moved during a block."""


class Simulation:
    """A Burger in a floor plan, stepped by 2 ms, with its sensors.

    Args:
        plan: Where it drives, and who walks there.
        people: How many more people walk there, on random loops that each reset draws anew.
        lidar: Name of a preset of ``lidar_noise`` or a configuration.
        odometry: Name of a preset of ``wheel_encoders`` or a configuration.
        imu: Name of a preset of ``imu`` or a configuration.
        rng: Seed or generator; each sensor gets a generator of its own, spawned from it.

    Raises:
        TestbedError: A preset does not exist, or there is no room for so many people.
    """

    def __init__(
        self,
        plan: FloorPlan,
        *,
        people: int = 0,
        lidar: str | LidarConfig = "datasheet",
        odometry: str | OdometryConfig = "typical",
        imu: str | ImuConfig = "typical",
        rng: int | np.random.Generator | None = None,
    ) -> None:
        self.plan = plan
        check_people(people)
        self._people = people
        walking = len(plan.pedestrians) + people
        self.model = build_scene(plan, people=walking)
        self.data = mujoco.MjData(self.model)
        self._qpos, self._qvel = self.data.qpos, self.data.qvel  # made once: this is asked often
        stop_stage_clock()
        self._walkers = Walkers(self.model, walking)
        self._contacts = ContactCounter(self.model, self._walkers.geoms)
        self._lidar = Lidar(self.model, preset("lidar", lidar, LIDAR_PRESETS))
        self._encoders = WheelEncoders(preset("odometry", odometry, ODOMETRY_PRESETS))
        self._imu = InertialUnit(preset("imu", imu, IMU_PRESETS))
        self._camera = SceneCamera(plan, walking)
        self._rng = np.random.default_rng(rng)
        self.reset()

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Become a copy: its views look at its own data."""
        self.__dict__.update(state)
        self._qpos, self._qvel = self.data.qpos, self.data.qvel

    @property
    def time(self) -> float:
        """Time since the reset [s]."""
        return self._step * TIMESTEP

    @property
    def pose_world(self) -> Pose:
        """True pose ``(3,)`` of base_footprint in the world."""
        return planar_pose(self._qpos)

    @property
    def velocity_base(self) -> tuple[float, float]:
        """True forward speed [m/s] and turn rate [rad/s] of base_footprint."""
        return planar_velocity(self._qpos, self._qvel)

    @property
    def contacts(self) -> int:
        """How often the robot ran into something that is not the floor, people among it.

        Looked at every 10 ms, and every 2 ms with people near; ``ContactCounter`` tells how.
        """
        return self._contacts.own

    @property
    def contacts_by_people(self) -> int:
        """How often a person ran into the robot, which stood or moved away."""
        return self._contacts.by_people

    @property
    def has_toppled(self) -> bool:
        """Whether the robot has fallen over, as people's feet may make it."""
        return lean_of(self._qpos) > TOPPLED

    @property
    def pedestrians(self) -> NDArray[np.float64]:
        """Where the people are ``(n, 2)`` [m], in the world: the plan's, then the random ones."""
        return self._walkers.positions(self.time)

    def reset(
        self,
        start: tuple[float, float, float] | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        """Put the robot at rest at a pose in the world (the plan's start), with new sensors.

        It settles on its wheels while nobody walks; then time, odometry and contacts start from
        zero.
        """
        self._rng = self._rng if rng is None else rng
        start = self.plan.start if start is None else start
        place(self.model, self.data, np.array(start))
        self._step, self._command_step = 0, 0
        self._let_people_walk(start)
        mujoco.mj_step(self.model, self.data, nstep=SETTLE_STEPS)
        self._contacts.reset()
        self._positions = [self._qpos[:7].copy()]
        self._velocities = [self._qvel[:6].copy()]
        lidar_rng, encoders_rng, imu_rng = self._rng.spawn(3)
        self._lidar.reset(lidar_rng)
        self._encoders.reset(encoders_rng, _wheel_angles(self._qpos), self.pose_world)
        self._imu.reset(imu_rng)
        self._newest_imu = FIRST_ROW

    def carry_off(self, pose: tuple[float, float, float]) -> None:
        """Put the robot down at rest at another pose in the world: the kidnapped robot.

        Time, odometry and IMU go on as if nothing had been: neither wheels nor gyroscope notice.
        """
        wheel_angles = self._qpos[7:9].copy()
        place(self.model, self.data, np.array(pose))
        self._qpos[7:9] = wheel_angles
        if len(self._walkers):
            self._walkers.stand_up(self.data, self.time)
        mujoco.mj_step(self.model, self.data, nstep=SETTLE_STEPS)
        self._positions = [self._qpos[:7].copy()]
        self._velocities = [self._qvel[:6].copy()]

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
            if len(self._walkers):
                self._step_among_people(event)
            else:
                mujoco.mj_step(self.model, self.data, nstep=event - self._step)
                self._step = event
                self._contacts.count(self.data, self._step, self._qpos, self._qvel)
            self._observe()
        return self._collect(begin)

    def render(
        self, camera: str = "chase", width: int = 640, height: int = 480
    ) -> NDArray[np.uint8]:
        """A picture ``(height, width, 3)`` from ``chase``, ``portrait`` or ``top``.

        Raises:
            TestbedError: There is no such camera, the size is not drawable, or there is no OpenGL.
        """
        return self._camera.picture(self._qpos, camera, width, height, self.data.mocap_pos)

    def close(self) -> None:
        """Give the OpenGL context back; may be called again."""
        self._camera.close()

    def _let_people_walk(self, start: tuple[float, float, float]) -> None:
        """Put everybody where they are at time 0; random people get new loops."""
        people = self.plan.pedestrians
        if self._people > 0:
            (rng,) = self._rng.spawn(1)
            people += random_pedestrians(self.plan, self._people, rng, start=start)
        self._walkers.reset(people)
        if people:
            self._walkers.stand_up(self.data, 0.0)

    def _step_among_people(self, event: int) -> None:
        """Step up to an event, the legs moving with every step when one is near the robot."""
        while self._step < event:
            near = self._walkers.move(self.data, self.time)
            steps = 1 if near else event - self._step
            position, velocity = self._qpos[:2].copy(), self._qvel[:6].copy()
            mujoco.mj_step(self.model, self.data, nstep=steps)
            self._step += steps
            self._contacts.count(self.data, self._step, position, velocity)

    def _observe(self) -> None:
        """Read what is due at this step."""
        if self._step - self._command_step >= _TIMEOUT_STEPS:
            self.data.ctrl[:] = 0.0
        if self._step % IMU_STEPS == 0:
            self._positions.append(self._qpos[:7].copy())
            self._velocities.append(self._qvel[:6].copy())
        if self._step % BLOCK_STEPS == 0:
            base_states = np.array(self._positions[-_BLOCK_STATES:])
            ranges = self._lidar.cast_block(self.data, base_states, self._feet_of_block())
            if ranges is not None:
                self._scan = (self.time - LIDAR_SCAN_TIME, ranges)
        if is_odometry_step(self._step):
            self._wheels.append((self._step, self._qpos[:9].copy(), self._qvel[:6].copy()))

    def _feet_of_block(self) -> NDArray[np.float64] | None:
        """Where the legs were at the times of the block's states ``(3, m, 2)`` [m], if any."""
        if not len(self._walkers):
            return None
        first = self._step - BLOCK_STEPS
        return self._walkers.feet(
            [step * TIMESTEP for step in range(first, self._step + 1, IMU_STEPS)]
        )

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
            told = imu[newest] if newest >= 0 else self._newest_imu
            yaw = yaw_after(told, (step % IMU_STEPS) * TIMESTEP)
            odometry[i] = self._read_odometry(step * TIMESTEP, qpos, qvel, yaw)
        self._newest_imu = imu[-1] if len(imu) else self._newest_imu
        stamp, ranges = self._scan or (None, None)
        return SensorBatch(odometry=odometry, imu=imu, scan_stamp=stamp, ranges=ranges)

    def _read_odometry(
        self, stamp: float, qpos: NDArray[np.float64], qvel: NDArray[np.float64], imu_yaw: float
    ) -> OdometryRow:
        """The odometry message of a moment."""
        if self._encoders.config.truth:
            return self._encoders.read_truth(stamp, planar_pose(qpos), planar_velocity(qpos, qvel))
        return self._encoders.read(stamp, _wheel_angles(qpos), imu_yaw)


def _wheel_angles(qpos: NDArray[np.float64]) -> tuple[float, float]:
    """Angles of the left and the right wheel [rad]."""
    left, right = qpos[7:9].tolist()
    return left, right

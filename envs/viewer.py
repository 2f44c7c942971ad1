"""Shows an environment in MuJoCo's own viewer while it is stepped."""

import os
import sys
import warnings
from typing import Any

import gymnasium
import mujoco

from envs.burger_env import Action, BurgerEnv, Observation
from envs.scene import LEG_GROUP, build_scene
from mapping.errors import TestbedError

_DISTANCE, _AZIMUTH_DEG, _ELEVATION_DEG = 5.0, 90.0, -60.0
"""From where the window looks at first: north is up, and 4 m of floor can be seen."""


class ViewedEnv(gymnasium.Wrapper[Observation, Action, Observation, Action]):  # type: ignore[misc]  # mypy skips gymnasium
    """An ``envs:TurtleBot3Burger-v0`` with a window: the robot, the world, the people.

    The window shows the dressed twin of the scene, as pictures do. It can be turned and zoomed with
    the mouse, changes nothing, and may be closed while the episode goes on.

    Raises:
        TestbedError: There is no display, or no window can be opened on it.
    """

    def __init__(self, environment: gymnasium.Env[Observation, Action]) -> None:
        super().__init__(environment)
        check_display()
        from mujoco import viewer  # loads the window library

        burger = environment.unwrapped
        assert isinstance(burger, BurgerEnv)
        self._burger = burger
        people = len(burger.scene_state[1]) // 2  # two legs each
        model = build_scene(burger.plan, people=people, dressed=True)
        self._data = mujoco.MjData(model)
        try:
            self._viewer = viewer.launch_passive(
                model, self._data, show_left_ui=False, show_right_ui=False
            )
        except RuntimeError as error:  # macOS wants the program to be started by mjpython
            raise TestbedError(f"--viewer: {error}") from error
        self._model = model
        with self._viewer.lock():
            self._viewer.opt.geomgroup[LEG_GROUP] = 1  # MuJoCo hides the groups from 3 on
            _follow_robot(self._viewer.cam, model)

    def reset(self, **options: Any) -> tuple[Observation, dict[str, Any]]:
        """Reset, and show where the robot then stands."""
        answer: tuple[Observation, dict[str, Any]] = self.env.reset(**options)
        self._show()
        return answer

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Step, and show the end of it."""
        answer: tuple[Observation, float, bool, bool, dict[str, Any]] = self.env.step(action)
        self._show()
        return answer

    def close(self) -> None:
        """Close the window as well."""
        self._viewer.close()
        self.env.close()

    def _show(self) -> None:
        if not self._viewer.is_running():
            return
        with self._viewer.lock():
            self._data.qpos[:], self._data.mocap_pos[:] = self._burger.scene_state
            mujoco.mj_forward(self._model, self._data)
        self._viewer.sync()


def _follow_robot(camera: mujoco.MjvCamera, model: mujoco.MjModel) -> None:
    """Look at the robot from behind and above, over walls of a metre, wherever it goes."""
    camera.type = mujoco.mjtCamera.mjCAMERA_TRACKING
    camera.trackbodyid = model.body("base_link").id
    camera.distance, camera.azimuth, camera.elevation = _DISTANCE, _AZIMUTH_DEG, _ELEVATION_DEG


def check_display() -> None:
    """Refuse to open a window where none can be: MuJoCo would wait for it for ever.

    Raises:
        TestbedError: There is no display, or it cannot be reached.
    """
    named = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not named:
        raise TestbedError("--viewer: there is no display (DISPLAY is not set); leave it out")
    import glfw  # MuJoCo's window library

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the answer says it
        opened = glfw.init()
    if not opened:
        raise TestbedError(f"--viewer: display {named!r} cannot be opened; leave --viewer out")

"""Turns the state of a simulation into pictures."""

import os
import sys
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from envs.floor_plan import FloorPlan
from envs.scene import LEG_GROUP, build_scene
from mapping.errors import TestbedError

_MAX_GEOMS = 10_000
"""Room for what one picture shows: solids, some 50 parts of the robot, the floor."""


CAMERAS = ("chase", "portrait", "top")
"""The cameras of every scene."""


class SceneCamera:
    """Draws the dressed twin of a scene; the physics model is spared the robot's visible parts.

    Needs OpenGL: a display, EGL or OSMesa. ``MUJOCO_GL`` chooses among them as MuJoCo has it; where
    it is not set and Linux has no display, EGL is taken. MuJoCo's own Renderer would look for a
    window there, whatever is set after its import. Nothing is opened before the first picture.
    """

    def __init__(self, plan: FloorPlan, people: int | None = None) -> None:
        self._plan = plan
        self._people = people
        self._model: mujoco.MjModel | None = None
        self._size: tuple[int, int] | None = None

    def picture(
        self,
        qpos: NDArray[np.float64],
        camera: str,
        width: int,
        height: int,
        mocap_pos: NDArray[np.float64] | None = None,
    ) -> NDArray[np.uint8]:
        """A picture ``(height, width, 3)``, RGB.

        Args:
            qpos: Joint positions of the physics model.
            camera: ``chase`` behind the robot, ``portrait`` before it, ``top`` over the whole plan.
            width: Columns of the picture, 1920 at most.
            height: Rows of the picture, 1440 at most.
            mocap_pos: Where the moved bodies are, people's legs; None leaves them at the origin.

        Raises:
            TestbedError: There is no such camera, the size is not drawable, or there is no OpenGL.
        """
        if self._model is None:
            self._model = build_scene(self._plan, people=self._people, dressed=True)
            self._data = mujoco.MjData(self._model)
            self._scene = mujoco.MjvScene(self._model, _MAX_GEOMS)
        view = _view(self._model, camera, width, height)
        self._open(width, height)
        self._data.qpos[:] = qpos
        if mocap_pos is not None:
            self._data.mocap_pos[:] = mocap_pos
        mujoco.mj_forward(self._model, self._data)
        options, all_kinds = mujoco.MjvOption(), mujoco.mjtCatBit.mjCAT_ALL.value
        options.geomgroup[LEG_GROUP] = 1  # MuJoCo hides the groups from 3 on
        mujoco.mjv_updateScene(self._model, self._data, options, None, view, all_kinds, self._scene)
        frame, pixels = mujoco.MjrRect(0, 0, width, height), np.empty((height, width, 3), np.uint8)
        mujoco.mjr_render(frame, self._scene, self._drawer)
        mujoco.mjr_readPixels(pixels, None, frame, self._drawer)
        return pixels[::-1].copy()  # OpenGL's first row is the lowest

    def __reduce__(self) -> tuple[type["SceneCamera"], tuple[FloorPlan, int | None]]:
        """A copy opens an OpenGL context of its own when it draws first: none can be copied."""
        return SceneCamera, (self._plan, self._people)

    def close(self) -> None:
        """Give the OpenGL context back; may be called again, and pictures may follow."""
        if self._size is not None:
            self._size = None
            self._context.make_current()
            self._drawer.free()
            self._context.free()

    def _open(self, width: int, height: int) -> None:
        """Make an OpenGL context for this size, or say in one line how to get one."""
        if self._size != (width, height):
            self.close()
            try:
                self._context = _opengl(width, height)
                self._context.make_current()
                self._drawer = mujoco.MjrContext(
                    self._model, mujoco.mjtFontScale.mjFONTSCALE_100.value
                )
            except (mujoco.FatalError, ImportError, RuntimeError, AttributeError) as error:
                raise TestbedError(
                    "render: no OpenGL here; install libEGL (or libOSMesa) and set MUJOCO_GL=egl "
                    "(or osmesa) before Python starts"
                ) from error
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._drawer)
            self._size = (width, height)
        self._context.make_current()


def checked_camera(name: str) -> str:
    """The name of a camera that scenes have.

    Raises:
        TestbedError: It is none.
    """
    if name not in CAMERAS:
        raise TestbedError(f"camera: {name!r}; must be one of {', '.join(CAMERAS)}")
    return name


def _view(model: mujoco.MjModel, camera: str, width: int, height: int) -> mujoco.MjvCamera:
    """The view through a camera; refuses ones that are not there and sizes that do not fit."""
    most = model.vis.global_
    if not (1 <= width <= most.offwidth and 1 <= height <= most.offheight):
        raise TestbedError(
            f"picture size: {width} x {height}; must be from 1 x 1 to "
            f"{most.offwidth} x {most.offheight}"
        )
    view = mujoco.MjvCamera()
    view.type = mujoco.mjtCamera.mjCAMERA_FIXED
    view.fixedcamid = model.camera(checked_camera(camera)).id
    return view


def _opengl(width: int, height: int) -> Any:
    """An OpenGL context: what MUJOCO_GL chose at MuJoCo's import, or EGL without a display."""
    shown = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not shown and not os.environ.get("MUJOCO_GL"):
        from mujoco.egl import GLContext
    else:
        from mujoco import GLContext
    return GLContext(width, height)

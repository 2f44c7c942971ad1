"""Pictures show the robot and the plan; where there is no OpenGL, the error says what to do."""

import copy
import pickle
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from envs.camera import SceneCamera
from envs.floor_plan import Box, FloorPlan
from envs.scene import build_scene
from mapping.errors import TestbedError

PLAN = FloorPlan(
    name="plan", start=(0.0, 0.0, 0.0), boxes=(Box(center=(1.0, 0.5), size=(0.5, 0.5)),)
)


@pytest.fixture(scope="module")
def qpos() -> np.ndarray:
    return build_scene(PLAN).qpos0


@pytest.fixture(scope="module")
def camera(qpos: np.ndarray) -> SceneCamera:
    made = SceneCamera(PLAN)
    try:
        made.picture(qpos, "top", 32, 24)
    except TestbedError as error:
        pytest.skip(str(error))
    return made


@pytest.mark.parametrize("name", ["chase", "portrait", "top"])
def test_every_camera_shows_something(camera: SceneCamera, qpos: np.ndarray, name: str) -> None:
    picture = camera.picture(qpos, name, 160, 120)
    assert picture.shape == (120, 160, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 5.0  # not one colour


def test_the_camera_ahead_of_the_robot_sees_its_black_tyres(
    camera: SceneCamera, qpos: np.ndarray
) -> None:
    picture = camera.picture(qpos, "portrait", 160, 120)
    assert (picture.max(axis=2) < 60).mean() > 0.05


def test_it_can_be_closed_twice_and_draw_again(camera: SceneCamera, qpos: np.ndarray) -> None:
    before = camera.picture(qpos, "top", 80, 60)
    camera.close()
    camera.close()
    np.testing.assert_array_equal(camera.picture(qpos, "top", 80, 60), before)


def test_a_camera_that_is_not_there_is_refused(qpos: np.ndarray) -> None:
    with pytest.raises(TestbedError, match=r"camera: 'side'; must be one of chase, portrait, top"):
        SceneCamera(PLAN).picture(qpos, "side", 80, 60)


@pytest.mark.parametrize("size", [(0, 10), (10, 5000)])
def test_a_size_that_cannot_be_drawn_is_refused(qpos: np.ndarray, size: tuple[int, int]) -> None:
    with pytest.raises(TestbedError, match=r"picture size: .*from 1 x 1 to 1920 x 1440"):
        SceneCamera(PLAN).picture(qpos, "top", *size)


def test_without_opengl_the_error_names_the_cure(
    qpos: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_context(*_: object) -> None:
        raise mujoco.FatalError("an OpenGL platform library has not been loaded")

    monkeypatch.setattr(mujoco, "MjrContext", no_context)
    with pytest.raises(TestbedError, match=r"render: no OpenGL .*MUJOCO_GL=egl"):
        SceneCamera(PLAN).picture(qpos, "top", 80, 60)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda made: pickle.loads(pickle.dumps(made))])
def test_a_copy_of_a_camera_that_has_drawn_draws_the_same(
    camera: SceneCamera, qpos: np.ndarray, copied: Callable[[SceneCamera], SceneCamera]
) -> None:
    picture = camera.picture(qpos, "chase", 32, 24)
    twin = copied(camera)
    assert np.array_equal(twin.picture(qpos, "chase", 32, 24), picture)
    twin.close()
    assert np.array_equal(camera.picture(qpos, "chase", 32, 24), picture)

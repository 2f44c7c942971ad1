"""A floor plan as a MuJoCo model: the same shapes, in the right groups, touching the robot only."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_plan import Box, Cylinder, FloorPlan, Polygon, Wall
from envs.scene import (
    FLOOR,
    FLOOR_GROUP,
    SOLID_GROUP,
    VISUAL_GROUP,
    build_scene,
    place,
    planar_pose,
    planar_velocity,
)
from envs.solids import Disc

PLAN = FloorPlan(
    name="a bit of everything",
    start=(0.5, -1.0, 0.7),
    walls=(Wall(points=((-3.0, -2.0), (3.0, -2.0), (3.0, 2.5), (-2.0, 2.0)), closed=True),),
    boxes=(Box(center=(1.0, 1.0), size=(0.5, 0.8), yaw=0.3),),
    cylinders=(Cylinder(center=(-1.0, 0.0), radius=0.15),),
    polygons=(Polygon(vertices=((0.0, 0.0), (0.5, 0.0), (0.2, 0.6))),),
)


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return build_scene(PLAN)


def corners(model: mujoco.MjModel, data: mujoco.MjData, name: str) -> np.ndarray:
    """The corners ``(n, 2)`` of a box's or a mesh's ground plan, in no order."""
    geom = model.geom(name)
    turned, place = data.geom(name).xmat.reshape(3, 3), data.geom(name).xpos
    if geom.type[0] == mujoco.mjtGeom.mjGEOM_BOX:
        points = geom.size * [(sx, sy, 1) for sx in (-1, 1) for sy in (-1, 1)]
    else:
        mesh = model.mesh(geom.dataid[0])
        points = model.mesh_vert[mesh.vertadr[0] : mesh.vertadr[0] + mesh.vertnum[0]]
    world = place + points @ turned.T
    return np.unique(np.round(world[:, :2], 6), axis=0)


def test_every_solid_is_one_geom_of_the_same_shape(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for index, solid in enumerate(PLAN.solids()):
        name = f"solid_{index}"
        if isinstance(solid, Disc):
            np.testing.assert_allclose(data.geom(name).xpos[:2], solid.center)
            np.testing.assert_allclose(model.geom(name).size[0], solid.radius)
            continue
        expected = solid.vertices[np.lexsort(solid.vertices.T[::-1])]
        # MuJoCo keeps the corners of a mesh in single precision: 1e-6 m.
        np.testing.assert_allclose(corners(model, data, name), expected, atol=2e-6)


def test_rectangles_are_boxes_and_other_prisms_meshes(model: mujoco.MjModel) -> None:
    kinds = [model.geom(f"solid_{i}").type[0] for i in range(len(PLAN.solids()))]
    box, mesh = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_MESH
    cylinder = mujoco.mjtGeom.mjGEOM_CYLINDER
    assert kinds == [mesh] * 4 + [box, cylinder, mesh]


def test_solids_reach_from_the_floor_to_their_height(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for index, solid in enumerate(PLAN.solids()):
        geom = model.geom(f"solid_{index}")
        turned = data.geom(geom.id).xmat.reshape(3, 3)
        middle = (data.geom(geom.id).xpos + turned @ model.geom_aabb[geom.id, :3])[2]
        half = (np.abs(turned) @ model.geom_aabb[geom.id, 3:])[2]
        assert middle - half == pytest.approx(0.0, abs=1e-6)
        assert middle + half == pytest.approx(solid.height, abs=1e-6)


def test_only_robot_and_world_can_touch_and_only_solids_are_seen(model: mujoco.MjModel) -> None:
    for i in range(model.ngeom):
        geom = model.geom(i)
        in_world = geom.bodyid[0] == 0
        assert (geom.contype[0], geom.conaffinity[0]) == ((0, 1) if in_world else (1, 0))
        assert (geom.group[0] == SOLID_GROUP) == geom.name.startswith("solid_")
        assert geom.rgba[3] == 1.0 or not in_world  # rays pass through what is transparent
    assert model.geom(FLOOR).group[0] == FLOOR_GROUP


def test_the_dressed_twin_has_the_same_state_and_mass(model: mujoco.MjModel) -> None:
    dressed = build_scene(PLAN, dressed=True)
    assert (dressed.nq, dressed.nv, dressed.na) == (model.nq, model.nv, model.na)
    np.testing.assert_allclose(dressed.body_mass, model.body_mass)
    np.testing.assert_allclose(dressed.body_inertia, model.body_inertia)
    assert (dressed.geom_group == VISUAL_GROUP).sum() > 40
    assert not (model.geom_group == VISUAL_GROUP).any()


def test_the_robot_stands_at_the_start(model: mujoco.MjModel) -> None:
    np.testing.assert_allclose(planar_pose(model.qpos0), PLAN.start, atol=1e-12)


@settings(deadline=None, max_examples=50)
@given(
    x=st.floats(-100.0, 100.0),
    y=st.floats(-100.0, 100.0),
    yaw=st.floats(-3.14, 3.14),
    forward=st.floats(-1.0, 1.0),
)
def test_a_pose_that_is_placed_is_read_back(
    model: mujoco.MjModel, x: float, y: float, yaw: float, forward: float
) -> None:
    data = mujoco.MjData(model)
    place(model, data, np.array((x, y, yaw)))
    np.testing.assert_allclose(planar_pose(data.qpos), (x, y, yaw), atol=1e-9)
    data.qvel[:2] = forward * math.cos(yaw), forward * math.sin(yaw)
    data.qvel[5] = 0.5
    np.testing.assert_allclose(planar_velocity(data.qpos, data.qvel), (forward, 0.5), atol=1e-9)


@pytest.mark.parametrize("shift", [0.0, 1.0])
def test_a_prism_far_from_the_origin_keeps_its_place(shift: float) -> None:
    """A mesh is stored about its own middle: 5 km away single precision would lose 0.5 mm."""
    far = 5000.0 * shift
    triangle = ((far + 1.0, 1.0), (far + 2.0, 1.0), (far + 1.0, 2.0))
    model = build_scene(
        FloorPlan(name="far", start=(far, 0.0, 0.0), polygons=(Polygon(vertices=triangle),))
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hit = np.empty(1, dtype=np.int32)
    reach = mujoco.mj_ray(
        model,
        data,
        (far, 1.25, 0.2),
        (1.0, 0.0, 0.0),
        np.array([1, 0, 0, 0, 0, 0], np.uint8),
        1,
        -1,
        hit,
    )
    assert reach == pytest.approx(1.0, abs=1e-6)

"""Turns a floor plan into a MuJoCo model: the Burger, the floor, what stands there and who walks.

Geom groups tell the lidar what it can see: ``SOLID_GROUP``, and ``LEG_GROUP``, which it casts
itself; the floor and the robot have groups of their own. Contacts arise between the robot and the
world only, never among robot parts.
"""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

import assets
from envs.burger_constants import BASE_LINK_HEIGHT
from envs.floor_plan import FloorPlan
from envs.pedestrians import LEG_HEIGHT, LEG_RADIUS
from envs.solids import Disc, Prism, Solid
from mapping.errors import TestbedError
from mapping.geometry import Pose

SOLID_GROUP, FLOOR_GROUP, VISUAL_GROUP, COLLISION_GROUP, LEG_GROUP = 0, 1, 2, 3, 4
"""Geom groups; burger.xml has those of the robot, visible and colliding."""

FLOOR = "floor"
"""Name of the floor's geom."""

_TOUCHES_ROBOT = {"contype": 0, "conaffinity": 1}
"""Meets contype 1, which only the robot's collision geoms have (burger.xml)."""

_OVER_TYRES = 2
"""Contact priority of legs: above the tyres' 1 (burger.xml), whose grip would drag."""

_LEG_CONTACT_TIME = 0.1
"""Time constant of contacts with legs [s] [assumption: who feels a robot at his foot gives way].

Measured over 96 walks at 0.5 to 1.2 m/s across a standing robot: it is shoved by 6 cm on average
and 19 cm at most and never tips over; with MuJoCo's 0.02 s, as with a kick, 52 times."""

_RIGHT_ANGLE_TOLERANCE = 1e-9
"""Cosine up to which a corner counts as square: 1e-9 of 10 m is far below any drawing."""

_WALL_COLOR, _FURNITURE_COLOR, _PILLAR_COLOR, _LEG_COLOR = (
    (0.86, 0.84, 0.79, 1.0),
    (0.66, 0.49, 0.33, 1.0),
    (0.36, 0.50, 0.62, 1.0),
    (0.20, 0.24, 0.36, 1.0),
)
_WALL_HEIGHT = 1.0
"""Prisms from this height [m] on are painted as walls, lower ones as furniture."""

_TOP_FOV_DEG, _TOP_ASPECT, _TOP_MARGIN = 20.0, 4.0 / 3.0, 1.1
"""The camera above: a narrow view, so that walls hide little; for 4 : 3 pictures; with a rim."""


def build_scene(
    plan: FloorPlan, *, people: int | None = None, dressed: bool = False
) -> mujoco.MjModel:
    """The compiled model of a floor plan with the robot in it.

    Args:
        plan: What stands on the floor, and the start pose.
        people: How many people walk there; None for those of the plan. Their legs are bodies to be
            moved (``walkers``), and stand at the origin until they are.
        dressed: Whether the robot has its visible parts. Physics and lidar do not need them, and
            without them a step takes a fifth less time; pictures are drawn from a dressed twin,
            which has the same state.

    Raises:
        TestbedError: MuJoCo cannot build the plan.
    """
    spec = mujoco.MjSpec.from_string(assets.ROOT.joinpath("burger", "burger.xml").read_text())
    if not dressed:
        for geom in [geom for geom in spec.geoms if geom.group == VISUAL_GROUP]:
            spec.delete(geom)
    _add_floor(spec)
    for index, solid in enumerate(plan.solids()):
        _add_solid(spec, f"solid_{index}", solid)
    for person in range(len(plan.pedestrians) if people is None else people):
        _add_legs(spec, person)
    _add_view(spec, plan)
    spec.compiler.fusestatic = True  # caster and lidar become part of base_link: quicker steps
    robot = spec.body("base_link")
    robot.pos, robot.quat = _base_link_pose(plan.start)
    try:
        return spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise TestbedError(f"floor plan {plan.name}: MuJoCo cannot build it: {reason}") from error


def leg_name(person: int, side: int) -> str:
    """Name of the body and the geom of a person's left (0) or right (1) leg."""
    return f"leg_{person}_{side}"


def place(model: mujoco.MjModel, data: mujoco.MjData, pose: Pose) -> None:
    """Reset the state, with the robot at rest at a pose of base_footprint ``(3,)`` in the world."""
    mujoco.mj_resetData(model, data)
    data.qpos[:3], data.qpos[3:7] = _base_link_pose(pose)
    mujoco.mj_forward(model, data)


def planar_pose(qpos: NDArray[np.float64]) -> Pose:
    """The pose ``(3,)`` of base_footprint in the world: base_link's place and heading, levelled.

    Args:
        qpos: Position x, y, z and quaternion w, x, y, z of base_link; ``(7,)`` or longer.
    """
    x, y, _, w, i, j, k = qpos[:7].tolist()
    yaw = math.atan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k))
    return np.array((x, y, yaw))


def lean_of(qpos: NDArray[np.float64]) -> float:
    """How far base_link leans from upright [rad], 0 to pi; ``qpos`` as for ``planar_pose``."""
    i, j = qpos[4:6].tolist()
    return 2.0 * math.asin(min(math.hypot(i, j), 1.0))


def planar_velocity(qpos: NDArray[np.float64], qvel: NDArray[np.float64]) -> tuple[float, float]:
    """Forward speed [m/s] and turn rate [rad/s] of base_footprint.

    Args:
        qpos: As for ``planar_pose``.
        qvel: Linear velocity in the world and angular in base_link; ``(6,)`` or longer.
    """
    yaw = float(planar_pose(qpos)[2])
    return math.cos(yaw) * float(qvel[0]) + math.sin(yaw) * float(qvel[1]), float(qvel[5])


def _base_link_pose(
    pose: Pose | tuple[float, float, float],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position and quaternion (w, x, y, z) of base_link of a robot standing level."""
    x, y, yaw = (float(value) for value in pose)
    half = 0.5 * yaw
    return np.array((x, y, BASE_LINK_HEIGHT)), np.array((math.cos(half), 0.0, 0.0, math.sin(half)))


def _add_floor(spec: mujoco.MjSpec) -> None:
    """An endless floor with squares of 1 m, under a pale sky."""
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.80, 0.87, 0.94),
        rgb2=(0.97, 0.98, 1.0),
        width=64,
        height=64,
    )
    spec.add_texture(
        name=FLOOR,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=(0.60, 0.64, 0.68),
        rgb2=(0.66, 0.70, 0.74),
        width=256,
        height=256,
    )
    material = spec.add_material(name=FLOOR, texrepeat=(0.5, 0.5), texuniform=True)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = FLOOR
    spec.worldbody.add_geom(
        name=FLOOR,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=(0.0, 0.0, 1.0),
        material=FLOOR,
        group=FLOOR_GROUP,
        **_TOUCHES_ROBOT,
    )


def _add_solid(spec: mujoco.MjSpec, name: str, solid: Solid) -> None:
    """One geom: a cylinder, a box where the prism is a rectangle, else a convex mesh."""
    half_height = 0.5 * solid.height
    common = {"name": name, "group": SOLID_GROUP, **_TOUCHES_ROBOT}
    if isinstance(solid, Disc):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            pos=(*solid.center, half_height),
            size=(solid.radius, half_height, 0.0),
            rgba=_PILLAR_COLOR,
            **common,
        )
        return
    common["rgba"] = _WALL_COLOR if solid.height >= _WALL_HEIGHT else _FURNITURE_COLOR
    center = solid.vertices.mean(axis=0)
    if _is_rectangle(solid.vertices):
        along, across = np.diff(solid.vertices[:3], axis=0)
        half_yaw = 0.5 * math.atan2(along[1], along[0])
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=(*center, half_height),
            quat=(math.cos(half_yaw), 0.0, 0.0, math.sin(half_yaw)),
            size=(0.5 * math.hypot(*along), 0.5 * math.hypot(*across), half_height),
            **common,
        )
        return
    _add_mesh(spec, name, Prism(vertices=solid.vertices - center, height=solid.height))
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, pos=(*center, 0.0), **common
    )


def _is_rectangle(vertices: NDArray[np.float64]) -> bool:
    """Whether corners ``(n, 2)`` in order are those of a rectangle."""
    if len(vertices) != 4:
        return False
    edges = np.roll(vertices, -1, axis=0) - vertices
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    cosines = np.sum(edges * np.roll(edges, -1, axis=0), axis=1)
    return bool(np.all(np.abs(cosines) < _RIGHT_ANGLE_TOLERANCE))


def _add_mesh(spec: mujoco.MjSpec, name: str, prism: Prism) -> None:
    """The corners of a prism, of which MuJoCo makes the convex hull."""
    corners = [(x, y, z) for z in (0.0, prism.height) for x, y in prism.vertices.tolist()]
    spec.add_mesh(name=name, uservert=np.ravel(corners))


def _add_legs(spec: mujoco.MjSpec, person: int) -> None:
    """Two upright cylinders that are moved, and push a robot aside.

    They do not rub: how fast they go is unknown to MuJoCo, which takes a moved body to stand.
    """
    for side in (0, 1):
        name = leg_name(person, side)
        body = spec.worldbody.add_body(name=name, mocap=True, pos=(0.0, 0.0, 0.5 * LEG_HEIGHT))
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=(LEG_RADIUS, 0.5 * LEG_HEIGHT, 0.0),
            group=LEG_GROUP,
            rgba=_LEG_COLOR,
            condim=1,
            priority=_OVER_TYRES,
            solref=(_LEG_CONTACT_TIME, 1.0),
            **_TOUCHES_ROBOT,
        )


def _add_view(spec: mujoco.MjSpec, plan: FloorPlan) -> None:
    """A sun, and a camera above that sees the whole plan."""
    spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=(0.0, 0.0, 5.0),
        dir=(0.35, 0.25, -0.9),
        diffuse=(0.42, 0.42, 0.40),
        specular=(0.1, 0.1, 0.1),
        castshadow=True,
    )
    left, right, bottom, top = plan.bounds
    half_view = 0.5 * _TOP_MARGIN * max(top - bottom, (right - left) / _TOP_ASPECT)
    above = half_view / math.tan(math.radians(0.5 * _TOP_FOV_DEG))
    tallest = max(solid.height for solid in plan.solids())
    spec.worldbody.add_camera(
        name="top",
        pos=(0.5 * (left + right), 0.5 * (bottom + top), tallest + above),
        fovy=_TOP_FOV_DEG,
    )

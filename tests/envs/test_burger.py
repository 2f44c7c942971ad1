"""The robot's MJCF says what envs.burger_constants says, and looks like one."""

import mujoco
import numpy as np
import pytest

import assets
from envs import burger_constants as burger
from envs.scene import COLLISION_GROUP, VISUAL_GROUP
from mapping.burger import LIDAR_POSE_BASE


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(assets.ROOT.joinpath("burger", "burger.xml").read_text())


def rest(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def full_inertia(model: mujoco.MjModel, body: str) -> np.ndarray:
    """The tensor in the body's own axes, from MuJoCo's principal one."""
    quat, turned = model.body(body).iquat, np.empty(9)
    mujoco.mju_quat2Mat(turned, quat)
    axes = turned.reshape(3, 3)
    return axes @ np.diag(model.body(body).inertia) @ axes.T


def test_masses_are_those_of_the_urdf_and_add_up_to_one_kilogram(model: mujoco.MjModel) -> None:
    masses = {
        "base_link": burger.BASE_MASS,
        "wheel_left_link": burger.WHEEL_MASS,
        "wheel_right_link": burger.WHEEL_MASS,
        "caster_back_link": burger.CASTER_MASS,
        "base_scan": burger.LIDAR_MASS,
    }
    for body, mass in masses.items():
        assert model.body(body).mass[0] == pytest.approx(mass, rel=1e-9), body
    assert model.body_mass.sum() == pytest.approx(burger.TOTAL_MASS, rel=1e-9)
    assert round(burger.TOTAL_MASS, 2) == 1.00


def test_inertias_are_the_urdfs_and_placeholders_are_recomputed(model: mujoco.MjModel) -> None:
    xx, yy, zz, xy, xz, yz = burger.BASE_INERTIA
    base = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    np.testing.assert_allclose(full_inertia(model, "base_link"), base, atol=1e-9)
    for body, inertia in {
        "wheel_left_link": burger.WHEEL_INERTIA,
        "wheel_right_link": burger.WHEEL_INERTIA,
        "caster_back_link": burger.CASTER_INERTIA,
        "base_scan": burger.LIDAR_INERTIA,
    }.items():
        np.testing.assert_allclose(
            full_inertia(model, body), np.diag(inertia), rtol=1e-9, atol=1e-12, err_msg=body
        )


def test_frames_are_where_the_urdf_has_them(model: mujoco.MjModel) -> None:
    data, up = rest(model), np.array((0.0, 0.0, burger.BASE_LINK_HEIGHT))
    half = 0.5 * burger.WHEEL_SEPARATION
    for frame, place in {
        data.body("base_link").xpos.tobytes(): (0.0, 0.0, 0.0),
        data.body("wheel_left_link").xpos.tobytes(): (0.0, half, burger.WHEEL_HEIGHT),
        data.body("wheel_right_link").xpos.tobytes(): (0.0, -half, burger.WHEEL_HEIGHT),
        data.body("caster_back_link").xpos.tobytes(): burger.CASTER_POSITION,
        data.site("base_scan").xpos.tobytes(): burger.LIDAR_POSITION,
        data.site("imu_link").xpos.tobytes(): burger.IMU_POSITION,
    }.items():
        np.testing.assert_allclose(np.frombuffer(frame), up + place, atol=1e-12)
    np.testing.assert_allclose(model.body("base_link").ipos, burger.BASE_CENTER_OF_MASS)
    assert burger.LIDAR_POSITION[:2] == LIDAR_POSE_BASE[:2]
    assert LIDAR_POSE_BASE[2] == 0.0


def test_shapes_that_collide_are_those_of_the_urdf(model: mujoco.MjModel) -> None:
    np.testing.assert_allclose(2.0 * model.geom("base").size, burger.BASE_BOX_SIZE)
    np.testing.assert_allclose(model.geom("base").pos, burger.BASE_BOX_CENTER)
    for name in ("wheel_left", "wheel_right"):
        radius, half_width, upright = model.geom(name).size
        assert radius == upright == burger.WHEEL_RADIUS
        assert 2.0 * half_width == burger.WHEEL_WIDTH
        assert model.geom(name).friction[0] == burger.TYRE_FRICTION
        assert model.geom(name).solref[0] == burger.CONTACT_TIME
    assert model.geom("caster").size[0] == pytest.approx(burger.CASTER_RADIUS)
    assert model.geom("caster").condim[0] == 1
    assert model.geom("caster").solref[0] == burger.CONTACT_TIME
    np.testing.assert_allclose(
        model.geom("lidar").size[:2], (burger.LIDAR_RADIUS, 0.5 * burger.LIDAR_LENGTH)
    )
    np.testing.assert_allclose(model.geom("lidar").pos, burger.LIDAR_CENTER)


def test_what_one_sees_never_collides_and_what_collides_is_hidden_from_the_lidar(
    model: mujoco.MjModel,
) -> None:
    for i in range(model.ngeom):
        geom = model.geom(i)
        assert geom.group[0] in (VISUAL_GROUP, COLLISION_GROUP)
        assert geom.conaffinity[0] == 0
        assert geom.contype[0] == (1 if geom.group[0] == COLLISION_GROUP else 0)


def test_motors_step_and_limits_are_the_firmwares(model: mujoco.MjModel) -> None:
    assert model.opt.timestep == burger.TIMESTEP
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    for name in ("wheel_left", "wheel_right"):
        motor = model.actuator(name)
        # burger.xml gives the limit to a thousandth of a rad/s.
        np.testing.assert_allclose(
            motor.ctrlrange, (-burger.MAX_WHEEL_SPEED, burger.MAX_WHEEL_SPEED), atol=5e-4
        )
        np.testing.assert_allclose(motor.forcerange, (-burger.MOTOR_TORQUE, burger.MOTOR_TORQUE))
        assert motor.gainprm[0] == burger.MOTOR_GAIN
        assert motor.biasprm[2] == -burger.MOTOR_GAIN
        assert motor.dynprm[0] == burger.MOTOR_TIME_CONSTANT
        assert model.joint(name).armature[0] == burger.MOTOR_ARMATURE


def test_the_robot_is_as_large_as_a_burger(model: mujoco.MjModel) -> None:
    """ROBOTIS e-manual: 138 x 178 x 192 mm; plates and tyres are drawn to the millimetre."""
    data = rest(model)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in np.flatnonzero(model.geom_group == VISUAL_GROUP):
        turned = data.geom_xmat[i].reshape(3, 3)
        center = data.geom_xpos[i] + turned @ model.geom_aabb[i, :3]
        reach = np.abs(turned) @ model.geom_aabb[i, 3:]
        low, high = np.minimum(low, center - reach), np.maximum(high, center + reach)
    # The plates' slanting strips and the spokes stand over in their bounding boxes only.
    np.testing.assert_allclose(high - low, (0.138, 0.178, 0.192), atol=0.004)
    assert low[2] == pytest.approx(0.0, abs=1e-9)

"""The figures of the TurtleBot3 Burger that the simulation needs, each with its source.

What mapping and navigation also need stands in ``mapping.burger``. ``assets/burger/burger.xml``
repeats the figures of the body, as MJCF must; a test compares the two.

Sources: URDF = turtlebot3_burger.urdf of ROBOTIS-GIT/turtlebot3@da785b7; SDF = turtlebot3_burger
model.sdf of ROBOTIS-GIT/turtlebot3_simulations@eb50ff8 (branch humble where said); firmware =
ROBOTIS-GIT/OpenCR@68ec75d; XL430 = ROBOTIS e-manual, XL430-W250.
"""

import math

from mapping.burger import LIDAR_POSE_BASE

# Time

TIMESTEP = 0.002
"""Physics step [s]; 5 ms once gave a wrong arc."""

STEPS_PER_SECOND = round(1.0 / TIMESTEP)
"""Physics steps in a second."""

CONTROL_PERIOD = 0.1
"""Time of one environment step [s]: Nav2 commands the Burger at 10 Hz (turtlebot3 burger.yaml)."""

ODOMETRY_RATE = 30
"""Odometry messages a second (firmware, turtlebot3_core_config.h)."""

IMU_RATE = 100
"""IMU messages a second; the firmware samples at 200 Hz, and two samples make one here."""

COMMAND_TIMEOUT = 0.5
"""Age at which a command stops the robot [s] (firmware, turtlebot3_core_config.h)."""

# Base

BASE_LINK_HEIGHT = 0.010
"""base_link above base_footprint, that is above the floor [m] (URDF)."""

BASE_MASS = 0.82573504
"""Mass of plates, boards, motors and battery [kg] (URDF)."""

BASE_CENTER_OF_MASS = (-0.032, 0.0, 0.070)
"""In base_link [m] (SDF, branch humble). The URDF's zero would balance the robot on its axle."""

BASE_INERTIA = (
    2.2124416e-3,
    2.1193702e-3,
    2.0064271e-3,
    -1.2294101e-5,
    3.4938785e-5,
    -5.0120904e-6,
)
"""xx, yy, zz, xy, xz, yz about the centre of mass [kg m2] (URDF)."""

BASE_BOX_SIZE = (0.140, 0.140, 0.143)
"""Collision box [m] (URDF)."""

BASE_BOX_CENTER = (-0.032, 0.0, 0.070)
"""Its centre in base_link [m] (URDF)."""

# Wheels

WHEEL_RADIUS = 0.033
"""Radius [m] (URDF; firmware, turtlebot3_burger.h)."""

WHEEL_WIDTH = 0.018
"""Width of a tyre [m] (URDF)."""

WHEEL_SEPARATION = 0.160
"""Distance between the wheels' middles [m] (URDF; firmware, turtlebot3_burger.h)."""

WHEEL_HEIGHT = 0.023
"""Axle above base_link [m] (URDF)."""

WHEEL_MASS = 0.02849894
"""Mass of one wheel [kg] (URDF)."""

WHEEL_INERTIA = (1.1175580e-5, 2.0712558e-5, 1.1192413e-5)
"""xx, yy (about the axle), zz [kg m2] (URDF, whose wheel frame calls the axle z)."""

TYRE_FRICTION = 1.0
"""Friction of rubber on a hard floor [assumption; ROBOTIS's own 0.1 and 1e5 are placeholders]."""

CONTACT_TIME = 0.005
"""Time constant of wheel and caster contacts [s], the stiffest that 2 ms steps carry well.

With MuJoCo's default of 0.02 s the tyres sink 0.37 mm and roll 0.9 % short; with this, 0.03 mm.
"""

CONTACT_CREEP = 4e-4
"""Share of the wheels' way that is lost on the floor all the same, straight or turning.

Measured with this model from rest to rest: 4.2e-4 in 2 m at 0.1 m/s, 4.1e-4 in spins at 1.0 and
2.5 rad/s. At 0.2 m/s each start and stop costs 0.3 mm more. Odometry counts it, so that "ideal"
encoders are.
"""

# Caster

CASTER_POSITION = (-0.081, 0.0, -0.004)
"""Centre of the ball in base_link [m] (URDF)."""

CASTER_RADIUS = BASE_LINK_HEIGHT + CASTER_POSITION[2]
"""Radius of the ball [m]: it touches the floor when the robot stands level, as all frames of the
URDF have it. The SDF's 5 mm leave a gap of 1 mm, through which the robot would lean back by 0.7
degrees and carry its lidar 2 mm behind where ``LIDAR_POSE_BASE`` says."""

CASTER_MASS = 0.005
"""Mass [kg] (URDF)."""

CASTER_INERTIA = (0.4 * CASTER_MASS * CASTER_RADIUS**2,) * 3
"""Of a solid ball [kg m2]; the URDF's 0.001 is a placeholder, 50 times a wheel's."""

# Lidar and IMU

LIDAR_POSITION = (LIDAR_POSE_BASE[0], LIDAR_POSE_BASE[1], 0.172)
"""base_scan in base_link [m] (URDF)."""

LIDAR_MASS = 0.114
"""Mass [kg] (URDF)."""

LIDAR_RADIUS = 0.055
"""Radius of the collision cylinder [m] (URDF)."""

LIDAR_LENGTH = 0.0315
"""Height of the collision cylinder [m] (URDF)."""

LIDAR_CENTER = (0.015, 0.0, -0.0065)
"""Centre of the collision cylinder in base_scan [m] (URDF)."""

LIDAR_INERTIA = (
    LIDAR_MASS * (3.0 * LIDAR_RADIUS**2 + LIDAR_LENGTH**2) / 12.0,
    LIDAR_MASS * (3.0 * LIDAR_RADIUS**2 + LIDAR_LENGTH**2) / 12.0,
    LIDAR_MASS * LIDAR_RADIUS**2 / 2.0,
)
"""Of a solid cylinder [kg m2]; the URDF's 0.001 is a placeholder."""

IMU_POSITION = (-0.032, 0.0, 0.068)
"""imu_link in base_link [m] (URDF)."""

# Motors

MAX_WHEEL_SPEED = 61.0 * 2.0 * math.pi / 60.0
"""Fastest wheel [rad/s]: 61 rpm, to which the firmware clamps each wheel: 0.211 m/s, 2.63 rad/s."""

ENCODER_TICKS = 4096
"""Ticks of one wheel turn (XL430; firmware TICK2RAD 0.001533981)."""

MOTOR_TORQUE = 1.5
"""Stall torque [N m] (XL430 at 12 V: 1.5)."""

MOTOR_GAIN = 1.0
"""Torque for a speed error [N m s/rad]: 0.02 % off in a steady spin; 0.05 would be 2.7 % off."""

MOTOR_TIME_CONSTANT = 0.05
"""Lag of the motor's speed behind its command [s] [assumption].

The firmware asks for no acceleration profile, so speed steps. This lag is the shortest at which
the tyres keep their grip from rest (0.22 m/s / 0.05 s = 4.4 m/s2 of the 6 m/s2 that they can pass
on); without it every start would lose 7 mm.
"""

MOTOR_ARMATURE = 1e-3
"""Inertia of rotor and 258.5 : 1 gear at the wheel [kg m2] [assumption; without it: unstable]."""

TOTAL_MASS = BASE_MASS + 2.0 * WHEEL_MASS + CASTER_MASS + LIDAR_MASS
"""Mass of the whole robot [kg]."""

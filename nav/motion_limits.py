"""How fast the robot may go and how quickly it may change its mind."""

from dataclasses import dataclass

from mapping.errors import TestbedError
from mapping.messages import Twist


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionLimits:
    """Speeds and accelerations a navigator keeps to."""

    max_linear: float = 0.21
    """[m/s]; the wheels saturate at 61 rpm, 0.2108 m/s (OpenCR turtlebot3_burger.h@68ec75d)."""
    max_angular: float = 2.4
    """[rad/s]; nine tenths of what the wheels can turn a standing robot with, 2.64 rad/s."""
    linear_acceleration: float = 0.8
    """[m/s2]; a third of Nav2's dwa_local_planner_params_burger.yaml, to keep slip small."""
    angular_acceleration: float = 10.0
    """[rad/s2]."""
    period: float = 0.1
    """Control period [s]."""

    def __post_init__(self) -> None:
        """Refuse limits under which nothing moves."""
        for name in (
            "max_linear",
            "max_angular",
            "linear_acceleration",
            "angular_acceleration",
            "period",
        ):
            if not getattr(self, name) > 0.0:
                raise TestbedError(f"{name}: {getattr(self, name)}; must be above 0")

    def approach(self, wanted: Twist, last: Twist) -> Twist:
        """The twist nearest to ``wanted`` that can follow ``last`` within one period.

        Slowing down is not limited: a robot that must stop may stop. From one direction to the
        other it stands for a period: thrown from full speed into the other it rocks on its wheels,
        and feels like one that somebody has run into.
        """
        linear = _clamp(wanted.linear_x, -self.max_linear, self.max_linear)
        if linear * last.linear_x < 0.0:
            linear = 0.0
        angular = _clamp(wanted.angular_z, -self.max_angular, self.max_angular)
        return Twist(
            linear_x=_ramp(linear, last.linear_x, self.linear_acceleration * self.period),
            angular_z=_ramp(angular, last.angular_z, self.angular_acceleration * self.period),
        )


def _ramp(wanted: float, last: float, step: float) -> float:
    if abs(wanted) <= abs(last) and wanted * last >= 0.0:
        return wanted
    start = last if wanted * last >= 0.0 else 0.0
    return _clamp(wanted, start - step, start + step)


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)

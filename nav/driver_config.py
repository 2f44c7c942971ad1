"""The driver's settings: those of its parts, and when it stops trying."""

from dataclasses import dataclass

from nav.headway import HeadwayConfig
from nav.movers import MoversConfig
from nav.path_follower import FollowerConfig
from nav.recovery import RecoveryConfig
from nav.safety import SafetyConfig
from nav.yielding import YieldingConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class DriverConfig:
    """The parts that drive, and their patience."""

    follower: FollowerConfig = FollowerConfig()
    safety: SafetyConfig = SafetyConfig()
    movers: MoversConfig = MoversConfig()
    yielding: YieldingConfig = YieldingConfig()
    headway: HeadwayConfig = HeadwayConfig()
    recovery: RecoveryConfig = RecoveryConfig()
    first_look: float = 2.0
    """Time to stand and look before the first decision [s]: a mapper may want several scans, and
    the bias of the gyroscope, which turns the whole map, is measured by standing. Over 24 units it
    was known to 14e-6 rad/s after 1 s (rms; once 46e-6), to 8e-6 after 2 s, to 7e-6 after 3 s."""
    obstacle_reach: float = 1.2
    """Returns up to this far are held against the path [m]."""
    path_clearance: float = 0.10
    """A return this close to the path ahead blocks it [m]."""
    facing_time: float = 30.0
    """The robot drives forwards only for so long after something was seen to move [s]: whoever runs
    into its back, where it is going, tips it over its front, which no caster holds."""
    recoveries_in_a_row: int = 10
    """Recoveries without getting on in between after which the robot is stuck: enough to try a
    frontier in three ways, three recoveries each."""
    got_on: float = 1.0
    """Distance from the last recovery's place at which the robot has got on [m]."""

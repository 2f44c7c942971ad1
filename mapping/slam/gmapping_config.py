"""The settings of the mapper ``gmapping``, under the names that slam_gmapping's users know."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite, isnan

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.odometry_mapper import checked_pose

POSITIVE = (
    "max_range", "sigma", "lstep", "astep", "lsigma", "ogain", "delta", "llsamplestep",
    "lasamplestep", "max_speed",
)  # fmt: skip
NOT_NEGATIVE = (
    "clear_range", "minimumScore", "srr", "srt", "str", "stt", "linearUpdate", "angularUpdate",
    "update_interval", "map_update_interval", "llsamplerange", "lasamplerange",
)  # fmt: skip
SHARES = ("resampleThreshold", "occ_thresh")
WHOLE = {
    "particles": (1, 10_000),
    "kernelSize": (0, 14),
    "iterations": (0, 50),
    "lskip": (0, 10_000),
    "throttle_scans": (1, 1_000_000),
    "seed": (0, 2**63 - 1),
}
"""Fields that are whole numbers, and what is allowed; a row of the kernel must fit into a word."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GmappingConfig:
    """Settings of the particle filter.

    Names and defaults are slam_gmapping's, except where a field tells otherwise. ``sigma`` and
    ``lsigma`` are what their documentation says, standard deviations, so that a beam whose end is
    off by d scores exp(-d^2 / (2 sigma^2)); the classic program divides d^2 by the field itself and
    so matches with 0.158 m and weighs with 0.194 m. To do as it does, set ``sigma=0.158`` and
    ``lsigma=0.194``. On the Intel Research Lab's log the classic widths leave an error of 0.042 m
    over the hand-checked relations, true deviations one of 0.027 m, both at ROS's other settings.

    The thesis's update periods: ``update_interval=2.0`` processes at most one scan in 2 s (0.5 Hz),
    ``update_interval=0.5`` one in 0.5 s (2 Hz); with ``linearUpdate=0, angularUpdate=0`` exactly
    that many. Scans between are dropped.
    """

    max_range: float = LIDAR_RANGE_MAX
    """Readings beyond it are no return [m]: GMapping's maxRange."""
    lidar_pose_base: tuple[float, float, float] = LIDAR_POSE_BASE
    """The lidar's pose in base_footprint."""
    maxUrange: float | None = None
    """Readings beyond it only clear space, up to it [m]. None: all of ``max_range`` is used, as in
    slam_gmapping; TurtleBot3's own settings have 3.0."""
    clear_range: float = 3.0
    """How far a beam without a return clears space, at most ``maxUrange`` [m]; 0: such beams tell
    nothing. GMapping knows no such field: on a Burger with its own settings it clears 3.0 m."""
    sigma: float = 0.05
    """Standard deviation of a beam's end in matching [m]."""
    kernelSize: int = 1
    """Cells searched to each side of a beam's end for the thing it hit."""
    lstep: float = 0.05
    """First step of the hill climbing [m]."""
    astep: float = 0.05
    """First turn of the hill climbing [rad]."""
    iterations: int = 5
    """How often the steps are halved."""
    lsigma: float = 0.075
    """Standard deviation of a beam's end in the particles' weights [m]."""
    ogain: float = 3.0
    """The log likelihood of a scan is divided by ``ogain * particles``: beams are not independent,
    and sharper weights would leave one particle alone."""
    lskip: int = 0
    """Beams left out after each one matched; maps are drawn with all of them."""
    minimumScore: float = 0.0
    """A match that does not score more, of 1 per beam, is not believed: the particle stays where
    the odometry led it. TurtleBot3's own settings have 50."""
    srr: float = 0.1
    """Odometry noise: translation from translation [m/m]."""
    srt: float = 0.2
    """Rotation from translation [rad/m]."""
    str: float = 0.1
    """Translation from rotation [m/rad]."""
    stt: float = 0.2
    """Rotation from rotation [rad/rad]."""
    linearUpdate: float = 0.2
    """A scan is processed when the robot went this far since the last one [m]. ROS has 1.0; on the
    Intel log that leaves 0.027 m where 0.2 leaves 0.026 m, and a Burger would drive for 5 s without
    a new map."""
    angularUpdate: float = 0.5
    """Or when it turned this far [rad], added up both ways."""
    temporalUpdate: float = -1.0
    """Or when the last one is older than this [s]; negative: never."""
    resampleThreshold: float = 0.5
    """Particles are resampled when the effective share of them falls below this."""
    particles: int = 30
    """How many; a whole map each, in shared tiles."""
    delta: float = 0.05
    """Edge of a cell of the maps [m]."""
    sample_proposal: bool = False
    """Whether particles are drawn from a Gaussian around their match, as in the paper (III-B). The
    classic program puts them on the match itself and lets the next motion spread them; on the Intel
    log the Gaussian leaves 0.033 m where the match leaves 0.025 m, both with ``linearUpdate=0.5``,
    and an update takes a third longer."""
    llsamplerange: float = 0.01
    """How far around the match the likelihood is sampled for that Gaussian [m]."""
    llsamplestep: float = 0.01
    """The step of that [m]."""
    lasamplerange: float = 0.005
    """How far around it is sampled [rad]."""
    lasamplestep: float = 0.005
    """The step of that [rad]."""
    occ_thresh: float = 0.25
    """A cell is occupied when more than this share of the beams that saw it ended in it."""
    map_update_interval: float = 0.0
    """The published grid is drawn at most this often [s]; ROS has 5, TurtleBot3 2. An explorer
    wants to see at once what was processed."""
    throttle_scans: int = 1
    """Of so many scans one is looked at."""
    update_interval: float = 0.0
    """At most one scan in this time [s] is processed, whatever the gates say."""
    max_speed: float = 2.0
    """An odometry that claims to have gone faster [m/s] has jumped: it is read on from where the
    robot was before. Not a field of GMapping, which follows the jump."""
    seed: int = 0
    """Of the particles' random numbers."""

    def __post_init__(self) -> None:
        """Refuse figures that make no mapper."""
        for name in POSITIVE:
            _check(name, getattr(self, name), lambda v: isfinite(v) and v > 0.0, "above 0")
        for name in NOT_NEGATIVE:
            _check(name, getattr(self, name), lambda v: isfinite(v) and v >= 0.0, "0 or more")
        for name in SHARES:
            _check(name, getattr(self, name), lambda v: 0.0 <= v <= 1.0, "between 0 and 1")
        for name, (least, most) in WHOLE.items():
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
                raise TestbedError(f"{name}: {value!r}; must be a whole number, {least} to {most}")
        if self.maxUrange is not None:
            _check("maxUrange", self.maxUrange, lambda v: isfinite(v) and v > 0.0, "above 0")
        _check("temporalUpdate", self.temporalUpdate, lambda v: not isnan(v), "no NaN")
        checked_pose("lidar_pose_base", self.lidar_pose_base)


def _check(name: str, value: float, allowed: Callable[[float], bool], words: str) -> None:
    """Raise one clear error when a value is none that is allowed."""
    try:
        good = allowed(value)
    except TypeError:
        good = False
    if not good:
        raise TestbedError(f"{name}: {value!r}; must be a number, {words}")

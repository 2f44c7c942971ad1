"""What defines a page of the thesis's figures: the seed and the two drives that all maps are of."""

from dataclasses import dataclass, field

from evaluation.episode import EpisodeConfig
from mapping.errors import TestbedError

DRIVING_MAPPER = "graph"
"""Who the navigator trusts while a drive is recorded. The thesis's robot was steered by a program
that drove by the scan; here a map that stays right keeps it on its way, and no figure is its."""

MOST_TIME = 600.0
"""Simulated time after which a drive ends in any case [s]; they take 50 s and 220 s."""

ROOM_TOUR = "1.0,0.95 1.1,2.0 1.1,3.2 1.9,4.5 2.6,5.1 2.95,4.2 2.85,2.8 2.7,1.4"
"""Past the trash can, up on one side of the table and down on the other. It turns little: half a
turn costs encoders about 3 degrees, and an explorer that looks about turns often."""


def hallway_drive(seed: int = 0, time_limit: float = MOST_TIME) -> EpisodeConfig:
    """Along the hallway to its far end and back (thesis fig. 5.1 and, continued, 5.11)."""
    return EpisodeConfig(
        world="lim_hallway",
        mapper=DRIVING_MAPPER,
        navigator="waypoints",
        waypoints="along_the_hallway",
        odometry_yaw="encoders",
        seed=seed,
        time_limit=time_limit,
    )


def room_drive(seed: int = 0, time_limit: float = MOST_TIME) -> EpisodeConfig:
    """Round the room from its fixed start (thesis fig. 5.4)."""
    return EpisodeConfig(
        world="lim_room",
        mapper=DRIVING_MAPPER,
        navigator="waypoints",
        waypoints=ROOM_TOUR,
        odometry_yaw="encoders",
        seed=seed,
        time_limit=time_limit,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ThesisConfig:
    """Everything that defines the page; the same config gives the same page."""

    hallway: EpisodeConfig = field(default_factory=hallway_drive)
    room: EpisodeConfig = field(default_factory=room_drive)

    def __post_init__(self) -> None:
        """Refuse drives that belong to two pages."""
        if self.hallway.seed != self.room.seed:
            raise TestbedError(
                f"seeds: {self.hallway.seed} and {self.room.seed}; must be the same in both drives"
            )

    @property
    def seed(self) -> int:
        """Seed of every random number."""
        return self.hallway.seed

    @classmethod
    def of_seed(cls, seed: int) -> "ThesisConfig":
        """The page of a seed.

        Raises:
            TestbedError: The seed is negative.
        """
        return cls(hallway=hallway_drive(seed), room=room_drive(seed))

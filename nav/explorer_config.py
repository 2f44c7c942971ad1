"""The explorer's settings: those of its parts, and its own patience."""

from dataclasses import dataclass

from mapping.burger import LIDAR_RANGE_MAX
from nav.costmap import CostmapConfig
from nav.decision import DecisionConfig
from nav.driver_config import DriverConfig
from nav.former_walls import FormerWallsConfig
from nav.frontier import FrontierConfig
from nav.put_off import PutOffConfig
from nav.viewpoint import ViewpointConfig
from nav.visited_places import VisitedPlacesConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplorerConfig:
    """The explorer's parts and its own patience."""

    costmap: CostmapConfig = CostmapConfig()
    frontier: FrontierConfig = FrontierConfig()
    viewpoint: ViewpointConfig = ViewpointConfig()
    opening: FrontierConfig = FrontierConfig(min_cells=2, beside_walls=True)
    """What counts as a narrow opening in a wall: a door of 0.3 m, seen at a grazing angle, may be
    two planning cells wide between its posts."""
    opening_view: ViewpointConfig = ViewpointConfig(
        always_worth=0.4, through_holes=True, square_on=0.5
    )
    """What makes one worth the way: behind it may lie a room, though little of it shows."""
    former_walls: FormerWallsConfig = FormerWallsConfig()
    visited_places: VisitedPlacesConfig = VisitedPlacesConfig()
    put_off: PutOffConfig = PutOffConfig()
    decision: DecisionConfig = DecisionConfig()
    driver: DriverConfig = DriverConfig()
    decide_every: float = 4.0
    """Longest time between two decisions while exploring [s]."""
    replan_home_every: float = 8.0
    """Longest time between two plans of the way home [s]."""
    glance_every: float = 1.0
    """How often the goal's worth is looked at while driving [s]."""
    phantom_share: float = 0.6
    """Share of the promised gain that, still promised on arrival, makes the promise a phantom."""
    worth_left: float = 0.35
    """Share of the promised gain below which a goal is left for a better one."""
    mapped_reach: float = LIDAR_RANGE_MAX + 0.3
    """How far from itself the robot may change the map [m]: the lidar's range, and what a scan and
    a drawn wall add to it."""
    arrived: float = 0.12
    """Distance to a viewpoint at which it is reached [m]."""
    home_tolerance: float = 0.08
    """Distance to the start at which the robot is home [m]."""
    home_within: float = 0.2
    """Where the start itself is closer to a wall than a path may be, the robot goes to the nearest
    place up to so far from it [m]."""
    cut_off: float = 0.02
    """With less than this share of the known floor in reach, the robot's own place is in doubt."""
    recoveries_per_goal: int = 2
    """Recoveries on the way to a frontier, or home, after which the gap that stopped the robot is
    closed, and the frontier given up for now."""
    memory_shift: float = 0.15
    """When redrawn maps have moved the robot this far in all [m], former walls and visited places
    are forgotten: they are believed to lie within 0.2 m of where they were."""

"""The data of the testbed: the robot's MJCF, floor plans and scenarios, found by name as files."""

from importlib.resources import files
from importlib.resources.abc import Traversable

ROOT: Traversable = files(__name__)

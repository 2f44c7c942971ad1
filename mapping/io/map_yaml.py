"""Reads the yaml of a map_server map and checks every field of it."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from mapping.errors import TestbedError

MODES = ("trinary", "scale", "raw")
"""How map_server turns greys into states (map_server wiki, section 3.2)."""

_MAX_YAW = 1e-9
"""A yaw [rad] below this is rounding, not a rotated map."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapYaml:
    """The fields of a map_server yaml, checked."""

    path: Path
    """The yaml itself."""
    image: Path
    """The image it names, relative names taken from the yaml's folder."""
    resolution: float
    """Edge of a cell [m]."""
    origin: tuple[float, float]
    """Lower-left corner of the lower-left pixel [m]."""
    mode: str
    negate: bool
    """Whether white is occupied."""
    occupied_thresh: float
    free_thresh: float


def read_map_yaml(path: Path) -> MapYaml:
    """Read and check a map_server yaml; ``mode`` and ``negate`` may be missing, nothing else.

    Raises:
        TestbedError: The file is missing or is no yaml mapping, or a field is missing or wrong.
    """
    fields = _Fields(path, _load(path))
    occupied_thresh = fields.number("occupied_thresh", "a number from 0 to 1", 0.0, 1.0)
    free_thresh = fields.number("free_thresh", "a number from 0 to 1", 0.0, 1.0)
    if free_thresh >= occupied_thresh:
        fields.refuse("free_thresh", f"less than occupied_thresh ({occupied_thresh})")
    resolution = fields.number("resolution", "a finite number of metres above 0", 0.0, math.inf)
    if resolution == 0.0:
        fields.refuse("resolution", "a finite number of metres above 0")
    return MapYaml(
        path=path,
        image=_image(fields),
        resolution=resolution,
        origin=_origin(fields),
        mode=_mode(fields),
        negate=_negate(fields),
        occupied_thresh=occupied_thresh,
        free_thresh=free_thresh,
    )


class _Fields:
    """The mapping of a yaml together with the file's name, for errors that tell both."""

    def __init__(self, path: Path, values: dict[str, Any]) -> None:
        self.path, self.values = path, values

    def refuse(self, name: str, allowed: str) -> None:
        """Raise the error of a wrong or missing field."""
        found = repr(self.values[name]) if name in self.values else "missing"
        raise TestbedError(f"{self.path}: {name}: {found}; must be {allowed}")

    def number(self, name: str, allowed: str, lowest: float, highest: float) -> float:
        """A finite number in a range, read as yaml-cpp reads it: ``5e-2`` is one, true is not."""
        value = _as_number(self.values.get(name))
        if value is None or not lowest <= value <= highest:
            self.refuse(name, allowed)
        return float(value or 0.0)


def _load(path: Path) -> dict[str, Any]:
    """The yaml's mapping, or one clear error."""
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise TestbedError(f"{path}: no such file; must be a map_server yaml") from None
    except OSError as error:
        raise TestbedError(f"{path}: cannot be read ({error.strerror})") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())
        raise TestbedError(f"{path}: not yaml ({reason}); must be a map_server yaml") from error
    if not isinstance(values, dict):
        raise TestbedError(f"{path}: no mapping of fields; must be a map_server yaml")
    return values


def _as_number(value: object) -> float | None:
    """A finite float, or None; yaml 1.1 leaves ``5e-2`` a string, which map_server accepts."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def _image(fields: _Fields) -> Path:
    name = fields.values.get("image")
    if not isinstance(name, str) or not name:
        fields.refuse("image", "the name of a pgm or png")
    return fields.path.parent / str(name)


def _origin(fields: _Fields) -> tuple[float, float]:
    """The origin's x and y [m]; every grid here is aligned with its frame, so yaw must be 0."""
    value = fields.values.get("origin")
    numbers = [_as_number(entry) for entry in value] if isinstance(value, list) else []
    if len(numbers) != 3 or None in numbers:
        fields.refuse("origin", "three finite numbers [x, y, yaw]")
    x, y, yaw = (number or 0.0 for number in numbers)
    if abs(yaw) > _MAX_YAW:
        fields.refuse("origin", "unrotated (yaw 0): rotate the image and set yaw to 0")
    return x, y


def _mode(fields: _Fields) -> str:
    mode = fields.values.get("mode", MODES[0])
    if mode not in MODES:
        fields.refuse("mode", f"one of {', '.join(MODES)}")
    return str(mode)


def _negate(fields: _Fields) -> bool:
    negate = fields.values.get("negate", 0)
    if not isinstance(negate, bool | int) or negate not in (0, 1):
        fields.refuse("negate", "0 or 1")
    return bool(negate)

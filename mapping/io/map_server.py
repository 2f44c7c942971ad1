"""Turns occupancy maps into the yaml + image pairs of ROS's map_server, and back.

Reading follows nav2_map_server's map_io.cpp@000b462 pixel by pixel. Writing uses the thresholds of
the ROS 1 map_saver: with Nav2's own default of 0.25 the grey of unknown cells (205) loads as free.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.atomic import write_atomically
from mapping.io.map_yaml import MapYaml, read_map_yaml

UNKNOWN_PIXEL, FREE_PIXEL, OCCUPIED_PIXEL = 205, 254, 0
"""Greys of the three states (map_server's map_saver, nav2 map_io.cpp@000b462)."""

OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196
"""Thresholds written to every yaml (ROS 1 map_saver); 0.196 keeps grey 205, 0.19608, unknown."""

MARGIN_CELLS = 10
"""Unknown cells kept around what is known, so that a picture shows where knowledge ends."""

_WHITE_8, _WHITE_16 = 255.0, 65535.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapFile:
    """A map as it lies in a file: states only, no log odds."""

    resolution: float
    """Edge of a cell [m]."""
    origin: tuple[float, float]
    """Lower-left corner of cell (0, 0) in the map frame [m]."""
    states: NDArray[np.int8]
    """UNKNOWN, FREE or OCCUPIED ``[row = y, col = x]``, row 0 at the origin."""
    occupancy: NDArray[np.int8] | None = None
    """Probability in percent, -1 unknown, of a map in mode scale or raw; None in mode trinary."""


def read_map(path: str | Path) -> MapFile:
    """Read a map_server yaml and its image (pgm, png and whatever else Pillow reads).

    In modes scale and raw, ``occupancy`` is what Nav2 would publish; ``states`` calls a cell
    occupied at 100 and free at 0 in mode scale, and beyond the two thresholds in mode raw.

    Raises:
        TestbedError: A file is missing or broken, or a field is not what map_server allows.
    """
    meta = read_map_yaml(Path(path))
    shade, alpha = _read_shade(meta)
    occupied_share = shade if meta.negate else 1.0 - shade
    if meta.mode == "trinary":
        states, occupancy = _trinary(occupied_share, meta), None
    elif meta.mode == "scale":
        occupancy = _scale(occupied_share, alpha, meta)
        states = _thresholded(occupancy, 0, 100)
    else:
        occupancy = _raw(shade)
        states = _thresholded(occupancy, 100.0 * meta.free_thresh, 100.0 * meta.occupied_thresh)
    return MapFile(
        resolution=meta.resolution, origin=meta.origin, states=states, occupancy=occupancy
    )


def write_map(
    path: str | Path, grid: OccupancyGrid | MapFile, *, margin_cells: int = MARGIN_CELLS
) -> Path:
    """Write ``NAME.pgm`` and ``NAME.yaml``, cropped to the known cells plus a margin.

    A map of which nothing is known becomes a patch of unknown cells at its origin. The image is
    written first, so that a yaml never names an image that is not there.

    Args:
        path: ``NAME`` or ``NAME.yaml``; both files lie in its folder.
        grid: The map; its states are what is written.
        margin_cells: Unknown cells kept on every side of the known ones.

    Returns:
        The path of the yaml.

    Raises:
        TestbedError: The folder cannot be written.
    """
    path = Path(path)
    stem = path.with_suffix("") if path.suffix in (".yaml", ".yml", ".pgm") else path
    image_path = stem.parent / f"{stem.name}.pgm"
    yaml_path = stem.parent / f"{stem.name}.yaml"
    states = grid.states if isinstance(grid, MapFile) else grid.states()
    cropped, row, column = _crop(states, margin_cells)
    x = float(grid.origin[0] + column * grid.resolution)
    y = float(grid.origin[1] + row * grid.resolution)
    text = _yaml_text(image_path.name, grid.resolution, (x, y))
    image = Image.fromarray(_pixels(cropped))
    write_atomically(image_path, lambda file: image.save(file, format="PPM"))
    write_atomically(yaml_path, lambda file: file.write(text.encode()))
    return yaml_path


def _yaml_text(image: str, resolution: float, origin: tuple[float, float]) -> str:
    """The yaml beside an image, in the order in which map_saver writes its fields."""
    fields = {
        "image": image,
        "mode": "trinary",
        "resolution": float(resolution),
        "origin": [*origin, 0.0],
        "negate": 0,
        "occupied_thresh": OCCUPIED_THRESH,
        "free_thresh": FREE_THRESH,
    }
    return str(yaml.safe_dump(fields, sort_keys=False))


def _read_shade(meta: MapYaml) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Brightness 0..1 of every pixel, and its alpha 0..1 if it has any, row 0 at the bottom.

    In mode trinary alpha counts as a fourth colour channel, as map_io.cpp has it.
    """
    try:
        with Image.open(meta.image) as image:
            image.load()
            alpha = None
            if image.has_transparency_data:
                rgba = np.asarray(image.convert("RGBA"), dtype=np.float64) / _WHITE_8
                colours, alpha = rgba[..., :3], rgba[..., 3]
            elif image.mode.startswith("I"):
                colours = np.asarray(image, dtype=np.float64)[..., np.newaxis] / _WHITE_16
            elif image.mode in ("1", "L"):
                grey = np.asarray(image.convert("L"), dtype=np.float64)
                colours = grey[..., np.newaxis] / _WHITE_8
            else:
                colours = np.asarray(image.convert("RGB"), dtype=np.float64) / _WHITE_8
    except FileNotFoundError:
        raise TestbedError(
            f"{meta.path}: image: {meta.image}: no such file; must be an image beside the yaml"
        ) from None
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise TestbedError(
            f"{meta.path}: image: {meta.image}: cannot be read ({error}); must be a pgm or png"
        ) from error
    if alpha is not None and meta.mode == "trinary":
        colours = np.concatenate((colours, alpha[..., np.newaxis]), axis=-1)
    shade = colours.mean(axis=-1)
    return np.flipud(shade), None if alpha is None else np.flipud(alpha)


def _trinary(occupied_share: NDArray[np.float64], meta: MapYaml) -> NDArray[np.int8]:
    """Occupied above the one threshold, free below the other, else unknown."""
    return _thresholded(occupied_share, meta.free_thresh, meta.occupied_thresh, strict=True)


def _scale(
    occupied_share: NDArray[np.float64], alpha: NDArray[np.float64] | None, meta: MapYaml
) -> NDArray[np.int8]:
    """0..100 percent between the thresholds; unknown where a pixel is not opaque."""
    span = meta.occupied_thresh - meta.free_thresh
    percent = np.clip(np.rint((occupied_share - meta.free_thresh) / span * 100.0), 0.0, 100.0)
    if alpha is not None:
        percent[alpha < 1.0] = UNKNOWN
    return percent.astype(np.int8)


def _raw(shade: NDArray[np.float64]) -> NDArray[np.int8]:
    """The grey itself is the percentage; greys above 100 are unknown. ``negate`` plays no part."""
    percent = np.floor(shade * _WHITE_8 + 0.5)
    percent[percent > OCCUPIED] = UNKNOWN
    return percent.astype(np.int8)


def _thresholded(
    values: NDArray[np.float64] | NDArray[np.int8],
    free_upto: float,
    occupied_from: float,
    *,
    strict: bool = False,
) -> NDArray[np.int8]:
    """States by two thresholds, which themselves count unless ``strict``; below 0 is unknown."""
    states = np.full(values.shape, UNKNOWN, dtype=np.int8)
    free = values < free_upto if strict else values <= free_upto
    occupied = values > occupied_from if strict else values >= occupied_from
    states[free & (values >= 0)] = FREE
    states[occupied] = OCCUPIED
    return states


def _crop(states: NDArray[np.int8], margin: int) -> tuple[NDArray[np.int8], int, int]:
    """The known part with ``margin`` unknown cells around, and the (row, column) of its corner."""
    known = states != UNKNOWN
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if rows.size == 0:
        side = max(1, 2 * margin)
        return np.full((side, side), UNKNOWN, dtype=np.int8), 0, 0
    part = states[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    cropped = np.pad(part, margin, constant_values=UNKNOWN)
    return cropped, int(rows[0]) - margin, int(columns[0]) - margin


def _pixels(states: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Greys of an image, whose first row is the top."""
    pixels = np.full(states.shape, UNKNOWN_PIXEL, dtype=np.uint8)
    pixels[states == FREE] = FREE_PIXEL
    pixels[states == OCCUPIED] = OCCUPIED_PIXEL
    return np.ascontiguousarray(np.flipud(pixels))

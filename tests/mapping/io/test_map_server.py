from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from PIL import Image

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN, GridConfig, OccupancyGrid
from mapping.io.map_server import MapFile, read_map, write_map

STATES = arrays(
    np.int8,
    st.tuples(st.integers(1, 8), st.integers(1, 8)),
    elements=st.sampled_from([UNKNOWN, FREE, OCCUPIED]),
)
FIELDS = {
    "image": "map.pgm",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def independent_reader(path: Path) -> tuple[dict[str, object], NDArray[np.int8]]:
    """What map_server does, from its documentation alone: bytes of a P5 file, loops."""
    meta = yaml.safe_load(path.read_text())
    magic, width, height, _, pixels = (path.parent / meta["image"]).read_bytes().split(maxsplit=4)
    columns, rows = int(width), int(height)
    assert magic == b"P5"
    states = np.full((rows, columns), -1, dtype=np.int8)
    for y in range(rows):
        for x in range(columns):
            occupied = (255 - pixels[(rows - 1 - y) * columns + x]) / 255
            if occupied > meta["occupied_thresh"]:
                states[y, x] = 100
            elif occupied < meta["free_thresh"]:
                states[y, x] = 0
    return meta, states


def save(folder: Path, pixels: object, fields: dict[str, object] | None = None) -> Path:
    """An image and its yaml with some fields changed, or left out where None."""
    Image.fromarray(np.asarray(pixels)).save(folder / str((fields or {}).get("image", "map.pgm")))
    values = {k: v for k, v in {**FIELDS, **(fields or {})}.items() if v is not None}
    (folder / "map.yaml").write_text(yaml.safe_dump(values))
    return folder / "map.yaml"


@given(states=STATES, margin=st.integers(0, 3))
@settings(max_examples=40, deadline=None)
def test_what_is_written_an_independent_reader_reads(
    tmp_path_factory: pytest.TempPathFactory, states: NDArray[np.int8], margin: int
) -> None:
    folder = tmp_path_factory.mktemp("map")
    written = MapFile(resolution=0.05, origin=(-1.0, 2.0), states=states)
    path = write_map(folder / "map", written, margin_cells=margin)
    meta, read = independent_reader(path)
    ours = read_map(path)
    assert np.array_equal(ours.states, read)
    assert (meta["origin"], meta["resolution"]) == ([*ours.origin, 0.0], ours.resolution)
    known = np.argwhere(states != UNKNOWN)
    row, column = known.min(axis=0) - margin if len(known) else (0, 0)
    assert ours.origin == pytest.approx((-1.0 + column * 0.05, 2.0 + row * 0.05))
    expected = {(r - row, c - column): states[r, c] for r, c in known}
    assert {(r, c): read[r, c] for r, c in np.argwhere(read != UNKNOWN)} == expected


def test_unknown_cells_stay_unknown_with_the_thresholds_that_are_written(tmp_path: Path) -> None:
    states = np.array([[UNKNOWN, FREE, OCCUPIED]], dtype=np.int8)
    path = write_map(tmp_path / "map.yaml", MapFile(resolution=1.0, origin=(0, 0), states=states))
    meta = yaml.safe_load(path.read_text())
    assert (meta["occupied_thresh"], meta["free_thresh"]) == (0.65, 0.196)
    assert np.all(read_map(path).states[0] == UNKNOWN)


def test_a_grid_is_written_with_its_first_row_at_the_bottom(tmp_path: Path) -> None:
    grid = OccupancyGrid(GridConfig(resolution=0.1, origin=(0.0, 0.0), rows=3, columns=2))
    grid.log_odds[:] = -5.0
    grid.log_odds[0, 1] = 5.0
    path = write_map(tmp_path / "map", grid, margin_cells=0)
    pixels = np.asarray(Image.open(path.with_suffix(".pgm")))
    assert pixels.tolist() == [[254, 254], [254, 254], [254, 0]]


def test_a_map_of_nothing_is_a_patch_of_unknown_cells(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map", OccupancyGrid())
    assert np.all(read_map(path).states == UNKNOWN)


def test_plain_and_binary_pgm_and_png_are_the_same_map(tmp_path: Path) -> None:
    pixels = np.array([[0, 205, 254], [254, 100, 0]], dtype=np.uint8)
    binary = read_map(save(tmp_path, pixels)).states
    (tmp_path / "map.pgm").write_text("P2\n# by hand\n3 2\n255\n0 205 254\n254 100 0\n")
    assert np.array_equal(read_map(tmp_path / "map.yaml").states, binary)
    png = read_map(save(tmp_path, pixels, {"image": "map.png"})).states
    assert np.array_equal(png, binary)
    assert binary.tolist() == [[FREE, UNKNOWN, OCCUPIED], [OCCUPIED, UNKNOWN, FREE]]


def test_negate_makes_white_occupied(tmp_path: Path) -> None:
    pixels = np.array([[0, 255]], dtype=np.uint8)
    assert read_map(save(tmp_path, pixels, {"negate": 1})).states.tolist() == [[FREE, OCCUPIED]]


def test_mode_scale_spreads_greys_between_the_thresholds(tmp_path: Path) -> None:
    greys = np.array([[0, 255, 128]], dtype=np.uint8)
    read = read_map(save(tmp_path, greys, {"mode": "scale"}))
    share = (127 / 255 - 0.196) / (0.65 - 0.196)  # map_io.cpp, by hand
    assert read.occupancy is not None
    assert read.occupancy.tolist() == [[100, 0, round(100 * share)]]
    assert read.states.tolist() == [[OCCUPIED, FREE, UNKNOWN]]


def test_mode_scale_calls_what_is_not_opaque_unknown(tmp_path: Path) -> None:
    pixels = np.array([[[0, 255], [255, 255], [0, 0]]], dtype=np.uint8)
    read = read_map(save(tmp_path, pixels, {"mode": "scale", "image": "map.png"}))
    assert read.states.tolist() == [[OCCUPIED, FREE, UNKNOWN]]


def test_mode_trinary_averages_alpha_with_the_colours_as_nav2_does(tmp_path: Path) -> None:
    pixels = np.array([[[0, 0, 0, 255], [255, 255, 255, 0]]], dtype=np.uint8)
    read = read_map(save(tmp_path, pixels, {"image": "map.png"}))
    # shades 255/4/255 = 0.25 and 3/4: occupied shares 0.75 > 0.65, and 0.25 between thresholds
    assert read.states.tolist() == [[OCCUPIED, UNKNOWN]]


def test_mode_raw_takes_greys_as_percent(tmp_path: Path) -> None:
    pixels = np.array([[0, 19, 20, 64, 65, 100, 101, 255]], dtype=np.uint8)
    read = read_map(save(tmp_path, pixels, {"mode": "raw"}))
    assert read.occupancy is not None
    assert read.occupancy.tolist() == [[0, 19, 20, 64, 65, 100, -1, -1]]
    unknown = [UNKNOWN, UNKNOWN]
    assert read.states.tolist() == [[FREE, FREE, *unknown, OCCUPIED, OCCUPIED, *unknown]]


def test_greys_of_sixteen_bits_are_read(tmp_path: Path) -> None:
    pixels = np.array([[0, 65535]], dtype=np.uint16)
    states = read_map(save(tmp_path, pixels, {"image": "map.png"})).states
    assert states.tolist() == [[OCCUPIED, FREE]]


def test_numbers_without_a_point_are_numbers_as_in_ros(tmp_path: Path) -> None:
    path = save(tmp_path, np.zeros((1, 1), np.uint8))
    path.write_text(path.read_text().replace("resolution: 0.05", "resolution: 5e-2"))
    assert read_map(path).resolution == 0.05


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("resolution", 0),
        ("resolution", -0.05),
        ("resolution", "fine"),
        ("resolution", float("nan")),
        ("resolution", True),
        ("resolution", None),
        ("origin", [0.0, 0.0]),
        ("origin", [0.0, float("inf"), 0.0]),
        ("origin", "here"),
        ("origin", [0.0, 0.0, 0.5]),
        ("origin", None),
        ("negate", 2),
        ("negate", "no"),
        ("occupied_thresh", 1.5),
        ("occupied_thresh", None),
        ("free_thresh", 0.65),
        ("free_thresh", "low"),
        ("mode", "binary"),
        ("image", "other.pgm"),
        ("image", None),
    ],
)
def test_a_wrong_field_is_told_in_one_line(tmp_path: Path, field: str, value: object) -> None:
    path = save(tmp_path, np.zeros((1, 1), np.uint8))
    values = {**FIELDS, field: value}
    values = {name: each for name, each in values.items() if each is not None}
    path.write_text(yaml.safe_dump(values))
    with pytest.raises(TestbedError) as error:
        read_map(path)
    message = str(error.value)
    assert "\n" not in message
    assert message.startswith(f"{path}: {field}: ")
    assert "must be" in message


@pytest.mark.parametrize("text", ["", "- a\n- b", "image: [", "just words", "\x00"])
def test_a_yaml_that_is_none_is_told_in_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(TestbedError, match=r"map\.yaml") as error:
        read_map(tmp_path / "map.yaml")
    assert "\n" not in str(error.value)


def test_missing_files_and_broken_images_are_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match=r"none\.yaml: no such file"):
        read_map(tmp_path / "none.yaml")
    path = save(tmp_path, np.zeros((1, 1), np.uint8))
    (tmp_path / "map.pgm").write_bytes(b"P5\n9 9\n255\nabc")
    with pytest.raises(TestbedError, match="cannot be read"):
        read_map(path)

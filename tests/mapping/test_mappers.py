import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.grid import GridConfig
from mapping.mappers import MAPPERS, make_mapper
from tests.mapping.arena import scan_at, standing
from tests.mapping.test_ogm import still


@pytest.mark.parametrize("name", MAPPERS)
@pytest.mark.parametrize("resolution", [None, 0.05])
def test_every_mapper_maps_a_scan(name: str, resolution: float | None) -> None:
    mapper = make_mapper(name, start_pose_map=(4.0, 5.0, 1.0), resolution=resolution)
    assert mapper.pose_map == pytest.approx([4.0, 5.0, 1.0])
    mapper.update(scan_at(0.0, standing()), still(0.0))
    assert mapper.updates == 1
    default = 0.05 if name == "gmapping" else 0.01  # GMapping's delta
    assert mapper.grid.resolution == (resolution or default)
    assert mapper.grid.log_odds[tuple(mapper.grid.world_to_cell([4.0, 5.0]))] < 0.0


@pytest.mark.parametrize("name", MAPPERS)
def test_cells_lie_whole_cells_from_the_origin_of_the_map(name: str) -> None:
    origin = make_mapper(name, start_pose_map=(1.2345, -0.777, 0.0)).grid.origin / 0.01
    assert np.allclose(origin, np.round(origin), atol=1e-6)


def test_a_grid_of_ones_own_is_used() -> None:
    grid = GridConfig(resolution=0.1, rows=20, columns=30, grows=False)
    assert make_mapper("ogm", grid=grid).grid.shape == (20, 30)


def test_settings_reach_the_mapper() -> None:
    mapper = make_mapper("occgridmapp", resolution=0.05, settings={"turn_gate": None})
    assert mapper.grid.shape == (1000, 1000)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"name": "gmap"}, "graph, gmapping"),
        ({"name": "ogm", "settings": {"hits": 1.0}}, "hits"),
        ({"name": "ogm", "resolution": 0.0}, "resolution"),
        ({"name": "occgridmapp", "resolution": float("nan")}, "resolution"),
        ({"name": "ogm", "start_pose_map": (0.0, float("nan"), 0.0)}, "start_pose_map"),
        ({"name": "ogm", "start_pose_map": "here"}, "start_pose_map"),
        ({"name": "ogm", "resolution": 0.1, "grid": GridConfig()}, "resolution"),
    ],
)
def test_what_makes_no_mapper_is_told(arguments: dict[str, object], reason: str) -> None:
    with pytest.raises(TestbedError, match=reason):
        make_mapper(**arguments)  # type: ignore[arg-type]

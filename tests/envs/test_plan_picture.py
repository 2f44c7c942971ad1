import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from envs.floor_plan import Box, FloorPlan
from envs.pedestrians import positions_at
from envs.plan_picture import draw_plan
from envs.worlds import load_world


def drawn(plan):
    figure = Figure(figsize=(6.0, 5.0))
    axes = figure.subplots()
    draw_plan(plan, axes)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return axes, np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def shade_at(axes, pixels, x, y):
    across, up = axes.transData.transform((x, y))
    return pixels[pixels.shape[0] - 1 - round(up), round(across)].sum()


def test_walls_are_dark_floor_is_light_and_figures_are_told():
    axes, pixels = drawn(load_world("lim_room"))
    wall, thing, floor = (
        shade_at(axes, pixels, *point) for point in ((-0.05, 1.0), (4.2, 2.0), (2.5, 4.5))
    )
    assert wall < thing < floor
    assert axes.get_title() == "lim_room: 24.86 m² of floor, 27 solids"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")
    assert axes.get_aspect() == 1.0


def test_the_robot_is_drawn_where_it_starts():
    plan = load_world("lim_room")
    axes, pixels = drawn(plan)
    across, up = axes.transData.transform(plan.start[:2])
    red, _, blue = pixels[pixels.shape[0] - 1 - round(up), round(across)]
    assert red > blue + 100


def test_people_are_drawn_blue_where_they_are_at_time_0():
    plan = load_world("pedestrian_hall")
    axes, pixels = drawn(plan)
    for place in positions_at(plan.pedestrians, 0.0):
        across, up = axes.transData.transform(place)
        red, _, blue = pixels[pixels.shape[0] - 1 - round(up), round(across)]
        assert int(blue) > int(red) + 100


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (30.0, 30.0, 0.0)])
def test_a_plan_that_encloses_nothing_says_so(start):
    plan = FloorPlan(name="p", start=start, boxes=(Box(center=(5.0, 5.0), size=(1.0, 1.0)),))
    axes, _ = drawn(plan)
    assert "floor not enclosed" in axes.get_title()

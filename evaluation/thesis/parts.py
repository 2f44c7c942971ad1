"""Which part of the thesis is found where in this project, and by which command it runs."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

HEADINGS = ("part of the thesis", "what", "module", "command")


@dataclass(frozen=True, slots=True, kw_only=True)
class ThesisPart:
    """A part of the thesis and its place here."""

    part: str
    """Chapter, section, figure or appendix."""
    what: str
    module: str
    """File or folder, from the root of the project."""
    command: str
    """A command line without the name of the program; empty where there is none."""

    @property
    def shown_command(self) -> str:
        """The command line as it is typed; a dash where there is none."""
        return f"burger {self.command}" if self.command else "-"


def _part(part: str, what: str, module: str, command: str = "") -> ThesisPart:
    return ThesisPart(part=part, what=what, module=module, command=command)


MAP = "--map runs/lim_room/map.yaml --world lim_room"
"""A map to be found on: what ``make explore`` leaves."""

PARTS = (
    _part("2.2", "TurtleBot3 Burger: sizes, wheels, limits", "envs/burger_constants.py"),
    _part("2.2", "LDS-01: noise, failures, steps of 1 mm", "envs/lidar_noise.py"),
    _part("2.3, fig. 2.11", "/scan, /odom, /imu, /cmd_vel", "mapping/messages.py"),
    _part("2.3, fig. 2.12", "driving by hand from a keyboard", "scripts/drive.py", "drive"),
    _part("3.2, table 3.1", "Bayes filter, its worked example", "mapping/filters/bayes.py"),
    _part("3.3.1, table 3.2", "Kalman filter", "mapping/filters/kalman.py"),
    _part("3.3.2, table 3.3", "information filter", "mapping/filters/information.py"),
    _part(
        "3.3.3, table 3.4",
        "extended Kalman filter",
        "mapping/filters/extended_kalman.py",
        f"localize {MAP} --filter ekf --start known",
    ),
    _part("3.3.3", "extended information filter", "mapping/filters/extended_information.py"),
    _part(
        "3.4.1, table 3.5",
        "particle filter, kidnapped robot",
        "mapping/filters/particle.py",
        f"localize {MAP} --filter particle --kidnap 30",
    ),
    _part(
        "3.4.2, table 3.6",
        "histogram filter, fixed and adaptive cells",
        "mapping/filters/histogram.py",
        f"localize {MAP} --filter histogram",
    ),
    _part("3.4.3, 4.1", "occupancy grid in log odds", "mapping/grid.py"),
    _part("4.1", "inverse sensor model, lo1 and lo0", "mapping/sensor_model.py", "calibrate"),
    _part("4.2", "encoders and odometry at 30 Hz", "envs/wheel_encoders.py"),
    _part(
        "4.3, appendix B",
        "OccGridMapp",
        "mapping/occ_grid_mapp.py",
        "explore --mapper occgridmapp --odometry-yaw encoders",
    ),
    _part("4.3.5, fig. 4.6", "Bresenham's line through the cells", "mapping/ray_trace.py"),
    _part(
        "4.3.6, fig. 4.3",
        "plots in cells, start heading up",
        "mapping/thesis_plot.py",
        "thesis",
    ),
    _part(
        "5.1",
        "autonomous go and stop, mapping meanwhile",
        "nav/explorer.py",
        "drive --mapper occgridmapp",
    ),
    _part("5.1", "people vanish from the map", "mapping/ogm.py", "explore --mapper ogm --people 3"),
    _part(
        "5.1, fig. 5.1 to 5.5",
        "hallway and room",
        "evaluation/thesis/figures_mapping.py",
        "thesis",
    ),
    _part(
        "5.1, table 5.2",
        "gap filling",
        "mapping/gap_filling.py",
        "explore --mapper occgridmapp --gap-filling thesis",
    ),
    _part(
        "5.2, fig. 5.6",
        "GMapping",
        "mapping/slam/gmapping.py",
        "explore --mapper gmapping",
    ),
    _part(
        "5.2, fig. 5.6 to 5.8, table 5.3",
        "GMapping at two rates, beside OccGridMapp",
        "evaluation/thesis/figures_gmapping.py",
        "thesis",
    ),
    _part(
        "5.3, table 5.4",
        "no update while turning",
        "mapping/occ_grid_mapp.py",
        "replay --log RUN --mapper occgridmapp --set turn_gate=none",
    ),
    _part(
        "5.3, fig. 5.9 to 5.11",
        "the turn, and the hallway drawn twice",
        "evaluation/thesis/figures_odometry.py",
        "thesis",
    ),
    _part(
        "5.3, future work",
        "better gap filling",
        "mapping/gap_filling.py",
        "explore --gap-filling better",
    ),
    _part(
        "5.3, future work",
        "odometry corrected by scans and gyroscope",
        "mapping/slam/graph_slam.py",
        "explore --mapper graph",
    ),
    _part(
        "appendix A",
        "1000 scans at a wall, 1000 into the open",
        "evaluation/calibration/experiment.py",
        "calibrate",
    ),
)
"""Every part, in the order of the thesis."""


def parts_as_html(parts: Sequence[ThesisPart] = PARTS) -> str:
    """The table as the page has it."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in HEADINGS)
    rows = [
        f"<tr><td>{escape(each.part)}</td><td>{escape(each.what)}</td>"
        f"<td><code>{escape(each.module)}</code></td>"
        f"<td>{f'<code>{escape(each.shown_command)}</code>' if each.command else ''}</td></tr>"
        for each in parts
    ]
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"

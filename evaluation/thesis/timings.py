"""Tells how long map updates took on this machine: the one part of the page that never repeats."""

from html import escape

import numpy as np

from evaluation.thesis.regenerate import Runs

BEGIN, END = "<!-- timings: these differ from run to run -->", "<!-- end of timings -->"
"""Around the part of the page that differs between two runs of the same seed."""

NAMES = {
    "hallway": "OccGridMapp",
    "hallway_gmapping": "GMapping, 2 Hz",
    "back_graph": "graph SLAM",
    "back_scan_match": "scan matching",
    "back_ogm": "ogm",
}
"""Which maps are timed, and under which name."""

SLOWEST = 99.0
"""The rate that a mapper keeps up is 1 over this percentile of its times: single longer ones are
the machine's, as when it first reads code from its disk."""


def timings_as_html(runs: Runs) -> str:
    """A table of the times, between the marks."""
    rows = []
    for key, name in NAMES.items():
        seconds = runs.maps[key].update_seconds
        if len(seconds) == 0:
            continue
        median, slow = np.percentile(seconds, (50.0, SLOWEST))
        figures = (f"{1e3 * median:.2f}", f"{1e3 * slow:.2f}", f"{1.0 / slow:.0f}")
        cells = "".join(f"<td>{each}</td>" for each in figures)
        rows.append(f"<tr><th>{escape(name)}</th>{cells}</tr>")
    head = "<th></th><th>median [ms]</th><th>99th percentile [ms]</th><th>rate kept up [Hz]</th>"
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
    return f"{BEGIN}\n{table}\n{END}"

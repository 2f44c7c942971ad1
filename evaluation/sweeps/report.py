"""Turns run folders into one HTML page: table, dot plots, the worst maps, and what failed and why.

The page holds its pictures and needs no network; links lead to the run folders beside it.
"""

import math
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

from evaluation.sweeps.report_pictures import dot_plots, thumbnail
from evaluation.sweeps.run_record import RunRecord
from evaluation.sweeps.run_table import KEYS, short_name, table_of
from mapping.io.atomic import write_atomically

WORST = 12
"""How many maps are shown, the worst first."""

_STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #20242b; background: #fff;
       max-width: 1200px; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.6rem; margin: 0; }
h2 { font-size: 1.15rem; margin: 2.4rem 0 .6rem; border-bottom: 1px solid #d9dde3; }
p { color: #4b5462; margin: .3rem 0 .8rem; }
.tiles { display: flex; flex-wrap: wrap; gap: .8rem; margin: 1.2rem 0; }
.tile { background: #f4f6f8; border-radius: .5rem; padding: .6rem 1.1rem; }
.tile b { display: block; font-size: 1.5rem; font-variant-numeric: tabular-nums; }
.bad b, td.bad { color: #b3261e; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%; }
th, td { text-align: right; padding: .25rem .7rem; white-space: nowrap; }
th { font-weight: 600; border-bottom: 2px solid #20242b; }
td { border-bottom: 1px solid #eceff2; }
th.name, td.name { text-align: left; }
td.text { text-align: left; white-space: normal; }
tr.total td { font-weight: 600; background: #f4f6f8; }
svg { max-width: 100%; height: auto; }
.maps { display: grid; grid-template-columns: repeat(auto-fill, minmax(340px, 1fr)); gap: 1.2rem; }
figure { margin: 0; }
figure img { width: 100%; border: 1px solid #d9dde3; border-radius: .3rem; }
figcaption { font-size: .85rem; color: #4b5462; }
a { color: #0a58a6; }
"""


def write_report(runs: Sequence[RunRecord], path: Path, title: str) -> None:
    """Write the page, whole or not at all.

    Args:
        runs: What to report, one at least.
        path: The page; links are relative to where it lies.
        title: Its heading.

    Raises:
        TestbedError: If it cannot be written.
    """
    page = report_page(runs, path.parent, title)
    write_atomically(path, lambda file: file.write(page.encode()))


def report_page(runs: Sequence[RunRecord], home: Path, title: str) -> str:
    """The page as text, with links relative to a folder."""
    sections = [_tiles(runs), "<h2>Table</h2>", _table(runs)]
    if any(run.result for run in runs):
        sections += [
            "<h2>Every run</h2>",
            "<p>A dot is a run, a bar the median of several. A cross at the right edge is a run "
            "that never covered 95 %.</p>",
            dot_plots(runs),
        ]
    sections += ["<h2>What went wrong, and what was left</h2>", _troubles(runs, home)]
    sections += ["<h2>Maps, the worst runs first</h2>", _maps(runs, home)]
    body = "\n".join(sections)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{escape(title)}</h1>\n{body}\n</body>\n</html>\n"
    )


def badness(run: RunRecord) -> tuple[float, ...]:
    """How a run ranks among bad ones; the lower, the worse.

    First runs without a result, then those with contacts, then those that were not complete; among
    equals the one that covered least, then the least efficient.
    """
    contacts, efficiency = run.number("contacts"), run.number("efficiency")
    return (
        0.0 if run.failure is not None else 1.0,
        0.0 if contacts > 0 else 1.0,
        1.0 if run.is_complete else 0.0,
        round(0.0 if math.isnan(run.number("coverage")) else run.number("coverage"), 2),
        1.0 if math.isnan(efficiency) else efficiency,
    )


def _tiles(runs: Sequence[RunRecord]) -> str:
    """The figures to see first."""
    complete = sum(run.is_complete for run in runs)
    contacts = sum(int(run.result.get("contacts", 0)) for run in runs)
    coverages = [run.number("coverage") for run in runs if run.result]
    efficiencies = [value for run in runs if not math.isnan(value := run.number("efficiency"))]
    tiles = [
        ("complete", f"{complete} of {len(runs)}", complete < len(runs)),
        ("contacts", str(contacts), contacts > 0),
        ("worlds", str(len({run.told("world") for run in runs})), False),
    ]
    if coverages:
        tiles.append(("least coverage", f"{min(coverages):.3f}", False))
    if efficiencies:
        tiles.append(("least efficiency", f"{min(efficiencies):.2f}", False))
    return _div(
        "tiles",
        (
            f'<div class="tile{" bad" if is_bad else ""}"><b>{escape(value)}</b>{name}</div>'
            for name, value, is_bad in tiles
        ),
    )


def _table(runs: Sequence[RunRecord]) -> str:
    headings, *rows = table_of(runs)
    names = sum(heading in KEYS for heading in headings)
    worlds = {short_name(run.told("world")) for run in runs}
    text = [_row(headings, names, tag="th")]
    text += [_row(row, names, is_total=row[0] not in worlds) for row in rows]
    note = "<p>Medians, but for complete, contacts and least.</p>"
    return note + _div("scroll", ("<table>", *text, "</table>"))


def _row(cells: Sequence[str], names: int, *, tag: str = "td", is_total: bool = False) -> str:
    told = "".join(
        f"<{tag}{' class=name' if i < names else ''}>{escape(cell)}</{tag}>"
        for i, cell in enumerate(cells)
    )
    return f"<tr{' class=total' if is_total else ''}>{told}</tr>"


def _troubles(runs: Sequence[RunRecord], home: Path) -> str:
    """A row for each run that was not complete, touched something or gave frontiers up."""
    troubled = [
        run
        for run in runs
        if not run.is_complete or run.result.get("contacts") or run.result.get("dropped_frontiers")
    ]
    if not troubled:
        return "<p>Nothing: every run was complete, without a contact, and gave no frontier up.</p>"
    rows = ["<tr><th class=name>run<th class=name>stop reason<th>contacts<th>coverage<th>home [m]"]
    rows[0] += "<th class=name>why</tr>"
    for run in sorted(troubled, key=badness):
        stop = run.result.get("stop_reason", "failed")
        contacts = run.result.get("contacts", "-")
        rows.append(
            f"<tr><td class=name>{_link(run, home)}</td>"
            f'<td class="name{"" if run.is_complete else " bad"}">{escape(str(stop))}</td>'
            f'<td class="{"bad" if contacts not in (0, "-") else ""}">{contacts}</td>'
            f"<td>{_shown(run.number('coverage'), 3)}</td>"
            f"<td>{_shown(run.number('home_distance_m'), 2)}</td>"
            f"<td class=text>{escape(_why(run))}</td></tr>"
        )
    return _div("scroll", ("<table>", *rows, "</table>"))


def _why(run: RunRecord) -> str:
    """What a run itself says about what it left."""
    if run.failure is not None:
        return run.failure
    dropped = run.result.get("dropped_frontiers") or []
    if not dropped:
        return ""
    reasons = Counter(str(each.get("reason", "no reason")) for each in dropped)
    told = ", ".join(f"{count} {reason}" for reason, count in reasons.most_common())
    return f"{len(dropped)} frontier{'s' if len(dropped) > 1 else ''} given up: {told}"


def _maps(runs: Sequence[RunRecord], home: Path) -> str:
    figures = []
    for run in sorted(runs, key=badness)[:WORST]:
        picture = thumbnail(run.folder / "map.png")
        if picture is None:
            continue
        address = quote(os.path.relpath(run.folder / "map.png", home))
        figures.append(
            f'<figure><a href="{address}"><img alt="map of {escape(run.folder.name)}" '
            f'src="{picture}"></a><figcaption>{_link(run, home)}: {escape(_figures(run))}'
            "</figcaption></figure>"
        )
    return _div("maps", figures) if figures else "<p>There are none.</p>"


def _figures(run: RunRecord) -> str:
    return (
        f"{run.result.get('stop_reason')}, coverage {_shown(run.number('coverage'), 3)}, "
        f"t95 {_shown(run.number('t95_s'), 0)} s, "
        f"efficiency {_shown(run.number('efficiency'), 2)}, "
        f"contacts {run.result.get('contacts')}"
    )


def _link(run: RunRecord, home: Path) -> str:
    address = quote(os.path.relpath(run.folder, home))
    name = escape(run.folder.resolve().name)
    return f'<a href="{address}/">{name}</a>'


def _shown(value: float, digits: int) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def _div(name: str, lines: Iterable[str]) -> str:
    inside = "\n".join(lines)
    return f'<div class="{name}">\n{inside}\n</div>'

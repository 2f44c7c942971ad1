"""Turns the regenerated figures into one HTML page that needs nothing besides itself."""

from collections.abc import Sequence
from html import escape
from string import Template

from assets import ROOT
from evaluation.thesis.config import ThesisConfig
from evaluation.thesis.figure import ThesisFigure
from evaluation.thesis.parts import parts_as_html
from evaluation.thesis.picture import svg_of
from evaluation.thesis.regenerate import Runs
from evaluation.thesis.timings import timings_as_html
from evaluation.thesis.verdict import Check

TEMPLATE = ROOT / "thesis" / "page.html"

BADGES = {"seen again": "again", "seen in part": "part", "not seen": "not"}
"""Classes of the verdicts' badges."""

SECTIONS = (
    ("5.1 Mapping and gap filling", ("Fig. 5.1", "Fig. 5.2", "Fig. 5.3", "Fig. 5.4", "Fig. 5.5")),
    ("5.2 Beside GMapping", ("Fig. 5.6", "Fig. 5.7", "Fig. 5.8", "Table 5.3")),
    ("5.3 What the odometry does", ("Fig. 5.9", "Fig. 5.10", "Fig. 5.11")),
)
"""Headings of the page, and which figures stand under each."""


def page_of(config: ThesisConfig, runs: Runs, figures: Sequence[ThesisFigure]) -> str:
    """The page as text; but for the timings the same for the same config."""
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        seed=config.seed,
        tiles=_tiles(figures),
        drives=_drives(runs),
        summary=_summary(figures),
        sections="\n".join(_section(title, names, figures) for title, names in SECTIONS),
        parts=parts_as_html(),
        timings=timings_as_html(runs),
    )


def _tiles(figures: Sequence[ThesisFigure]) -> str:
    verdicts = [figure.verdict for figure in figures]
    return "".join(
        f'<div class="tile {badge}"><b>{verdicts.count(verdict)}</b>{verdict}</div>'  # type: ignore[arg-type]
        for verdict, badge in BADGES.items()
    )


def _drives(runs: Runs) -> str:
    """A line for each drive."""
    lines = [
        f"<li><code>{escape(drive.config.world)}</code>: {drive.length:.1f} m in "
        f"{drive.end:.0f} s, {len(drive.log.scans)} scans, {drive.contacts} contacts; "
        f"ended {escape(drive.stop_reason)}</li>"
        for drive in runs.drives.values()
    ]
    return "".join(sorted(lines))


def _summary(figures: Sequence[ThesisFigure]) -> str:
    rows = [
        f'<tr><td><a href="#{figure.anchor}">{escape(figure.number)}</a></td>'
        f"<td>{escape(figure.saw)}</td><td>{_badge(figure)}</td></tr>"
        for figure in figures
    ]
    head = "<tr><th>figure</th><th>what the thesis saw</th><th>here</th></tr>"
    return f'<table class="words"><thead>{head}</thead><tbody>{"".join(rows)}</tbody></table>'


def _section(title: str, names: Sequence[str], figures: Sequence[ThesisFigure]) -> str:
    told = "\n".join(_figure(figure) for figure in figures if figure.number in names)
    return f'<section><h2>{escape(title)}</h2>\n<div class="row">\n{told}\n</div></section>'


def _figure(figure: ThesisFigure) -> str:
    views = "".join(
        f"<div><p class='view'>{escape(view.title)}</p>{svg_of(view)}</div>"
        for view in figure.views
    )
    reasons = "".join(
        f'<p class="why"><b>Why not:</b> {escape(check.why_not)}</p>'
        for check in _with_reasons(figure.checks)
    )
    return (
        f'<article id="{figure.anchor}" class="of{len(figure.views)}">'
        f"<h3>{escape(figure.number)} {escape(figure.title)} {_badge(figure)}</h3>\n"
        f'<figure><div class="views">{views}</div>'
        f"<figcaption>{escape(figure.caption)}</figcaption></figure>\n"
        f'<p class="saw"><b>The thesis:</b> {escape(figure.saw)}</p>\n'
        f"{_checks(figure.checks)}{reasons}{_numbers(figure.table)}</article>"
    )


def _badge(figure: ThesisFigure) -> str:
    return f'<span class="badge {BADGES[figure.verdict]}">{figure.verdict}</span>'


def _checks(checks: Sequence[Check]) -> str:
    rows = "".join(
        f'<tr class="{"holds" if check.holds else "fails"}"><td>{"✓" if check.holds else "✗"}</td>'
        f"<td>{escape(check.claim)}<br><small>{escape(check.measure)}</small></td>"
        f"<td>{escape(check.shown_value)}</td><td>{escape(check.shown_bound)}</td></tr>"
        for check in checks
    )
    head = "<tr><th></th><th>criterion</th><th>here</th><th>must be</th></tr>"
    table = f'<table class="checks"><thead>{head}</thead><tbody>{rows}</tbody></table>'
    return f'<div class="scroll">{table}</div>'


def _with_reasons(checks: Sequence[Check]) -> list[Check]:
    """The criteria that failed, each reason once."""
    failed = {check.why_not: check for check in checks if not check.holds and check.why_not}
    return list(failed.values())


def _numbers(rows: Sequence[Sequence[str]]) -> str:
    """A table of numbers; its first row are headings when its first cell has more than one."""
    if not rows:
        return ""
    head, body = "", list(rows)
    if len(rows[0]) > 2 or not rows[0][0]:
        head = "".join(f"<th>{escape(cell)}</th>" for cell in body.pop(0))
        head = f"<thead><tr>{head}</tr></thead>"
    told = "".join(
        f"<tr><th>{escape(name)}</th>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"
        for name, *cells in body
    )
    return f'<div class="scroll"><table class="numbers">{head}<tbody>{told}</tbody></table></div>'

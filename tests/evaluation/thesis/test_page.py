"""The page: well formed, holding all it shows, the same from the same runs."""

import json
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from evaluation.thesis.config import ThesisConfig, hallway_drive, room_drive
from evaluation.thesis.drive import Drive
from evaluation.thesis.map_run import MapRun
from evaluation.thesis.page import SECTIONS, page_of
from evaluation.thesis.parts import HEADINGS, PARTS, parts_as_html
from evaluation.thesis.picture import svg_of
from evaluation.thesis.regenerate import SPECS, Runs
from evaluation.thesis.thesis_folder import figures_of, write_thesis
from evaluation.thesis.timings import BEGIN, END
from evaluation.thesis.views import view
from mapping.errors import TestbedError
from scripts.__main__ import VERBS, run
from tests.evaluation.thesis.made_up_runs import drive_through, map_of, room_points, without_timings

ROOT = Path(__file__).resolve().parents[3]

VOID = {"meta", "br", "image", "path", "rect"}
"""Elements that need no end tag, in HTML or because they end themselves in SVG."""

SCORES = {
    "map_updates": 50,
    "scans_dropped": 1,
    "map_file_kb": 40.0,
    "ate_rmse_m": 0.1,
    "coverage": 0.9,
    "f1_5cm": 0.8,
    "f1_10cm": 0.9,
    "adnn_m": None,
    "free_iou": 0.9,
}


class Page(HTMLParser):
    """Checks that every element is closed in order, and collects what a browser would fetch."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.text: list[str] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = {name: str(value) for name, value in attrs}
        assert tag not in ("script", "link", "iframe", "img", "object")
        self.fetched += [told["href"]] if tag == "image" else []
        self.links += [told["href"]] if tag == "a" else []
        self.ids += [told["id"]] if "id" in told else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text.append(data)


@pytest.fixture(scope="module")
def runs() -> Runs:
    poses = np.column_stack(
        (
            np.concatenate((np.linspace(0.4, 1.8, 20), np.linspace(1.8, 0.4, 20))),
            np.ones(40),
            np.concatenate((np.zeros(20), np.full(20, np.pi))),
        )
    )
    drive = drive_through(poses)
    return Runs(
        drives={"hallway": drive, "room": drive},
        maps={name: _as(drive, name) for name in SPECS},
    )


def _as(drive: Drive, name: str) -> MapRun:
    drawn = map_of(drive, room_points(), (0.02, 0.0, 0.01))
    return replace(drawn, spec=SPECS[name], result=SCORES)


def test_the_page_is_well_formed_and_holds_all_it_shows(runs: Runs) -> None:
    text = page_of(ThesisConfig(), runs, figures_of(runs))
    page = Page(text)
    assert page.open == []
    assert len(page.fetched) == sum(len(figure.views) for figure in figures_of(runs))
    assert all(address.startswith("data:image/png;base64,") for address in page.fetched)
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids)
    assert "http" not in text
    assert "url(" not in text
    assert "$" not in text, "no place of the template is left open"


def test_every_figure_of_the_thesis_is_on_the_page_with_its_verdict(runs: Runs) -> None:
    figures = figures_of(runs)
    expected = [*(f"Fig. 5.{number}" for number in range(1, 12)), "Table 5.3"]
    assert sorted(figure.number for figure in figures) == sorted(expected)
    assert sorted(name for _, names in SECTIONS for name in names) == sorted(expected)
    told = "".join(Page(page_of(ThesisConfig(), runs, figures)).text)
    for figure in figures:
        assert f"{figure.number} {figure.title} {figure.verdict}" in told
        for check in figure.checks:
            assert (check.why_not in told) or check.holds


def test_a_verdict_follows_the_numbers_of_the_run(runs: Runs) -> None:
    before = {figure.number: figure.verdict for figure in figures_of(runs)}
    assert before["Fig. 5.11"] == "not seen", "nothing is drawn twice"
    drive = runs.drives["hallway"]
    twice = map_of(drive, np.concatenate((room_points(), room_points() + (0.0, 0.4))))
    twice.trajectory.poses[drive.ground_truth.stamps > drive.farthest, 1] += 0.4
    doubled = replace(twice, spec=SPECS["back"], result=SCORES)
    after = Runs(drives=runs.drives, maps={**runs.maps, "back": doubled})
    assert {figure.number: figure.verdict for figure in figures_of(after)} == {
        **before,
        "Fig. 5.11": "seen again",
    }


def test_only_the_timings_differ_between_two_pages_of_the_same_runs(
    runs: Runs, tmp_path: Path
) -> None:
    slower = {
        name: replace(each, update_seconds=3.0 * each.update_seconds)
        for name, each in runs.maps.items()
    }
    pages = []
    for number, maps in enumerate((runs.maps, slower)):
        again = Runs(drives=runs.drives, maps=maps)
        folder = tmp_path / str(number)
        folder.mkdir()
        write_thesis(ThesisConfig(), again, figures_of(again), folder)
        pages.append((folder / "thesis.html").read_text())
    assert pages[0] != pages[1]
    assert without_timings(pages[0]) == without_timings(pages[1])
    assert all(mark in pages[0] and mark not in without_timings(pages[0]) for mark in (BEGIN, END))
    verdicts = [(tmp_path / each / "thesis.json").read_bytes() for each in ("0", "1")]
    assert verdicts[0] == verdicts[1]
    assert json.loads(verdicts[0])["figures"]["Fig. 5.11"]["verdict"] == "not seen"


def test_a_picture_has_the_start_heading_up(runs: Runs) -> None:
    ahead = np.array([[1.0, 1.0], [1.5, 1.0]])
    picture = svg_of(replace(view(runs, "hallway", "<b>"), path=ahead))
    assert "<b>" not in picture, "titles are escaped"
    way = picture[picture.index('class="way"') :]
    ends = way[way.index('d="M') + 4 : way.index('"/>')].split("L")
    (x0, y0), (x1, y1) = (map(float, each.split()) for each in (ends[0], ends[-1]))
    assert x1 == pytest.approx(x0)
    assert y1 < y0, "forward is up the page"


def test_every_part_of_the_thesis_is_where_the_table_says() -> None:
    for part in PARTS:
        assert (ROOT / part.module).exists(), part.module
        assert not part.command or part.command.split()[0] in VERBS, part.command


def parts_as_markdown() -> str:
    """The table as docs/thesis.md has it."""
    rows = [
        (
            each.part,
            each.what,
            f"`{each.module}`",
            f"`{each.shown_command}`" if each.command else "",
        )
        for each in PARTS
    ]
    lines = [HEADINGS, ("---",) * len(HEADINGS), *rows]
    return "".join(f"| {' | '.join(row)} |\n".replace("|  |", "| |") for row in lines)


def test_the_table_in_the_docs_is_the_one_of_the_page() -> None:
    assert parts_as_markdown() in (ROOT / "docs" / "thesis.md").read_text()
    told = "".join(Page(parts_as_html()).text)
    assert all(part.what in told for part in PARTS)


def test_a_folder_that_cannot_be_written_is_refused_before_anything_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    taken = tmp_path / "file"
    taken.write_text("mine")
    assert run(["thesis", "--out", str(taken)]) == 2
    assert capsys.readouterr().err.startswith(f"burger thesis: --out {taken}: cannot be written")
    assert taken.read_text() == "mine"


@pytest.mark.parametrize(
    ("words", "told"), [(["--seed", "-1"], "seed: -1"), (["--jobs", "0"], "--jobs: 0")]
)
def test_figures_that_make_no_page_are_refused(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["thesis", "--out", str(tmp_path / "out"), *words]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_drives_of_two_seeds_make_no_page() -> None:
    with pytest.raises(TestbedError, match="must be the same in both drives"):
        ThesisConfig(hallway=hallway_drive(0), room=room_drive(1))

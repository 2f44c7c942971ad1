"""Reports: one page that holds everything, worst first, read by an independent parser."""

import json
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from evaluation.sweeps.report import badness, report_page, write_report
from evaluation.sweeps.run_record import RunRecord, find_runs
from mapping.errors import TestbedError
from scripts.__main__ import run


def write_run_folder(folder: Path, *, world: str = "lim_room", **result: object) -> Path:
    folder.mkdir(parents=True)
    config = {"world": world, "mapper": "ogm", "navigator": "frontier", "odometry": "typical"}
    (folder / "config.json").write_text(json.dumps(config))
    told = {"stop_reason": "complete", "contacts": 0, "coverage": 0.99, "t95_s": 50.0}
    told |= {"dropped_frontiers": [], "home_distance_m": 0.1, "efficiency": 0.8, **result}
    (folder / "result.json").write_text(json.dumps(told))
    pixels = np.full((40, 60, 3), 255, dtype=np.uint8)
    Image.fromarray(pixels).save(folder / "map.png")
    return folder


class Page(HTMLParser):
    """Collects what a browser would fetch or follow, and the text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.links: list[str] = []
        self.text: list[str] = []
        self.open: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        told = dict(attrs)
        self.fetched += [str(told[key]) for key in ("src", "data") if key in told]
        self.links += [str(told["href"])] if tag == "a" else []
        assert tag not in ("script", "link", "iframe")

    def handle_data(self, data: str) -> None:
        self.text.append(data)


def test_the_page_fetches_nothing_and_links_to_what_is_there(tmp_path: Path) -> None:
    for seed in range(2):
        write_run_folder(tmp_path / "sweep" / f"lim_room seed#{seed}")
    write_report(find_runs([tmp_path / "sweep"]), tmp_path / "report.html", "A <title>")
    text = (tmp_path / "report.html").read_text()
    page = Page(text)
    assert page.fetched
    assert all(address.startswith("data:image/png;base64,") for address in page.fetched)
    assert len(page.links) == 4, "a picture and a name of each run"
    for link in page.links:
        assert (tmp_path / link.replace("%20", " ").replace("%23", "#")).exists(), link
    assert "A <title>" in page.text
    assert "url(http" not in text


def test_a_run_that_left_something_says_what_and_why(tmp_path: Path) -> None:
    dropped = [{"reason": "no path"}, {"reason": "no path"}, {"reason": "stuck <there>"}]
    write_run_folder(tmp_path / "a", stop_reason="stuck", dropped_frontiers=dropped)
    write_run_folder(tmp_path / "b")
    text = " ".join(Page(report_page(find_runs([tmp_path]), tmp_path, "t")).text)
    assert "3 frontiers given up: 2 no path, 1 stuck <there>" in text
    trouble = text[text.index("What went wrong") : text.index("Maps")]
    assert "stuck" in trouble
    assert " b " not in trouble, "it did well"


def test_runs_that_did_well_are_said_to_have(tmp_path: Path) -> None:
    write_run_folder(tmp_path / "a")
    assert "Nothing: every run was complete" in report_page(find_runs([tmp_path]), tmp_path, "t")


def test_the_worst_comes_first() -> None:
    def record(name: str, **result: object) -> RunRecord:
        good = {"stop_reason": "complete", "contacts": 0, "coverage": 0.99, "efficiency": 0.8}
        return RunRecord(folder=Path(name), config={}, result={**good, **result})

    ranked = [
        RunRecord(folder=Path("failed"), config={}, failure="ValueError: no"),
        record("touched", contacts=1),
        record("stuck", stop_reason="stuck"),
        record("missed a part", coverage=0.9),
        record("slow", efficiency=0.5),
        record("good"),
    ]
    assert sorted(reversed(ranked), key=badness) == ranked


def test_a_failed_run_is_told_with_its_reason(tmp_path: Path) -> None:
    folder = tmp_path / "lost"
    folder.mkdir()
    config = {"world": "w", "mapper": "ogm", "navigator": "frontier", "odometry": "typical"}
    (folder / "config.json").write_text(json.dumps(config))
    (folder / "failure.txt").write_text("the process died (SIGKILL)\n")
    page = report_page(find_runs([tmp_path]), tmp_path, "t")
    assert "the process died (SIGKILL)" in page
    assert "<svg" not in page, "there is nothing to plot"


def test_the_same_runs_give_the_same_bytes(tmp_path: Path) -> None:
    write_run_folder(tmp_path / "a", world="random:1", t95_s=None, efficiency=None)
    write_run_folder(tmp_path / "b", world="random:2")
    pages = [report_page(find_runs([tmp_path]), tmp_path, "t") for _ in range(2)]
    assert pages[0] == pages[1]
    assert pages[0].count("<svg") == 1


def test_replays_and_half_written_folders_are_left_out(tmp_path: Path) -> None:
    write_run_folder(tmp_path / "a")
    (write_run_folder(tmp_path / "half") / "result.json").unlink()
    (write_run_folder(tmp_path / "replay") / "config.json").write_text('{"log": "fr079.clf"}')
    assert [record.folder.name for record in find_runs([tmp_path, tmp_path / "a"])] == ["a"]


def test_runs_are_read_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    names = [f"random_{seed}-ogm" for seed in (0, 2, 10)]
    for name in reversed(names):
        write_run_folder(tmp_path / name)
    assert [record.folder.name for record in find_runs([tmp_path])] == names


def test_what_is_no_run_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(TestbedError, match="no runs in it"):
        find_runs([tmp_path])
    (write_run_folder(tmp_path / "a") / "result.json").write_text("[1]")
    with pytest.raises(TestbedError, match=r"result\.json: holds a list"):
        find_runs([tmp_path])
    for words in (["report"], ["report", str(tmp_path / "none")], ["report", str(tmp_path)]):
        assert run(words) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "report.html").exists()


def test_the_command_writes_the_page_beside_the_runs(tmp_path: Path) -> None:
    write_run_folder(tmp_path / "a")
    assert run(["report", str(tmp_path)]) == 0
    assert (tmp_path / "report.html").read_text().startswith("<!DOCTYPE html>")

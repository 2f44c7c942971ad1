"""junit.xml, read back by xml.etree as CI servers read it."""

from datetime import datetime
from pathlib import Path
from xml.etree import ElementTree

import pytest

from evaluation.scenarios.file import read_scenario
from evaluation.scenarios.junit import write_junit
from evaluation.scenarios.run import ScenarioRun
from tests.evaluation.scenarios.scenario_files import good_result, write_scenario

STARTED = datetime(2024, 2, 29, 12, 0, 1, 5)

# windyroad/JUnit-Schema@2378e66, the strictest schema in use: what must stand, and no more may.
SUITE = "id package name timestamp hostname tests failures errors skipped time".split()


@pytest.fixture
def root(tmp_path: Path) -> ElementTree.Element:
    """Two scenarios: one seed passed, one missed two criteria, one broke off; one passed."""
    mine = read_scenario(write_scenario(tmp_path))
    other = read_scenario(write_scenario(tmp_path, ("name: mine", "name: other")))
    common = {"folder": Path("out/x"), "result": good_result()}
    runs = [
        ScenarioRun(scenario=mine, seed=0, **common),
        ScenarioRun(
            scenario=mine, seed=1, missed=("t95_s 70, must be at most 65", "b <&> \0"), **common
        ),
        ScenarioRun(scenario=mine, seed=2, folder=Path("out"), result=None, failure="crashed"),
        ScenarioRun(scenario=other, seed=0, **common),
    ]
    write_junit(tmp_path / "junit.xml", runs, started=STARTED)
    return ElementTree.parse(tmp_path / "junit.xml").getroot()


def test_a_scenario_is_a_suite_and_a_seed_a_case(root: ElementTree.Element) -> None:
    assert root.tag == "testsuites"
    assert [suite.get("name") for suite in root] == ["mine", "other"]
    names = [[case.get("name") for case in suite.iter("testcase")] for suite in root]
    assert names == [["seed 0", "seed 1", "seed 2"], ["seed 0"]]


def test_the_counts_are_those_of_the_cases(root: ElementTree.Element) -> None:
    for suite in root:
        for count, tag in (("tests", "testcase"), ("failures", "failure"), ("errors", "error")):
            assert int(suite.get(count, "")) == len(list(suite.iter(tag)))
    assert [root[0].get(count) for count in ("tests", "failures", "errors")] == ["3", "1", "1"]
    assert [suite.get("time") for suite in root] == ["2.500", "1.250"]


def test_a_failure_tells_what_was_missed(root: ElementTree.Element) -> None:
    (failure,) = root.iter("failure")
    assert failure.get("message") == "t95_s 70, must be at most 65; b <&> ?"
    assert failure.get("type")
    assert "out/x" in (failure.text or "")
    (error,) = root.iter("error")
    assert error.get("message") == "crashed"


def test_the_file_keeps_to_the_strictest_schema_in_use(root: ElementTree.Element) -> None:
    assert root.attrib == {}
    for number, suite in enumerate(root):
        assert list(suite.attrib) == SUITE
        assert suite.get("id") == str(number)
        assert suite.get("timestamp") == "2024-02-29T12:00:01"
        tags = [child.tag for child in suite]
        cases = tags.count("testcase")
        assert tags == ["properties", *["testcase"] * cases, "system-out", "system-err"]
        for case in suite.iter("testcase"):
            assert set(case.attrib) == {"name", "classname", "time"}
            assert len(case) <= 1


def test_no_run_at_all_makes_a_file_without_suites(tmp_path: Path) -> None:
    write_junit(tmp_path / "junit.xml", [], started=STARTED)
    assert len(ElementTree.parse(tmp_path / "junit.xml").getroot()) == 0

"""Turns judged runs into junit.xml, which GitHub, GitLab and Jenkins show as tests.

A scenario is a test suite, a seed a test case; a missed criterion is a failure, and a run that
broke off an error. The file keeps to the stricter of the two schemas in use, that of Ant
(windyroad/JUnit-Schema@2378e66), which Jenkins's (xunit-plugin, junit-10.xsd@031e285) contains.
"""

import re
from collections.abc import Sequence
from datetime import datetime
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

from evaluation.scenarios.run import ScenarioRun
from mapping.io.atomic import write_atomically

NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 has no way to write (section 2.2)."""

HOST = "localhost"
"""What Ant's schema asks for where the host is not told; nobody's machine need be named."""


def write_junit(path: Path, runs: Sequence[ScenarioRun], *, started: datetime) -> None:
    """Write ``junit.xml``, whole or not at all.

    Args:
        path: The file.
        runs: The runs, those of a scenario side by side.
        started: When they were started, in local time.

    Raises:
        TestbedError: The file cannot be written.
    """
    root = ElementTree.Element("testsuites")
    for _, group in groupby(runs, key=lambda run: run.scenario.name):
        root.append(_suite(list(group), number=len(root), started=started))
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    write_atomically(path, lambda file: file.write(text + b"\n"))


def _suite(runs: list[ScenarioRun], *, number: int, started: datetime) -> ElementTree.Element:
    """One scenario."""
    scenario = runs[0].scenario
    suite = ElementTree.Element(
        "testsuite",
        id=str(number),
        package="scenarios",
        name=scenario.name,
        timestamp=started.strftime("%Y-%m-%dT%H:%M:%S"),
        hostname=HOST,
        tests=str(len(runs)),
        failures=str(sum(bool(run.missed) for run in runs)),
        errors=str(sum(run.failure is not None for run in runs)),
        skipped="0",
        time=_seconds(sum(run.wall_time for run in runs)),
    )
    properties = ElementTree.SubElement(suite, "properties")
    for name in ("world", "mapper", "navigator", "odometry", "lidar"):
        value = _clean(str(getattr(scenario.episode, name)))
        ElementTree.SubElement(properties, "property", name=name, value=value)
    for run in runs:
        suite.append(_case(run))
    ElementTree.SubElement(suite, "system-out").text = _clean(scenario.description)
    ElementTree.SubElement(suite, "system-err")
    return suite


def _case(run: ScenarioRun) -> ElementTree.Element:
    """One seed."""
    case = ElementTree.Element(
        "testcase",
        classname=f"scenarios.{run.scenario.name}",
        name=f"seed {run.seed}",
        time=_seconds(run.wall_time),
    )
    if run.failure is not None:
        message = _clean(run.failure)
        broken = ElementTree.SubElement(case, "error", message=message, type="broke off")
        broken.text = f"run folder: {_clean(str(run.folder))}"
    elif run.missed:
        message = _clean("; ".join(run.missed))
        failed = ElementTree.SubElement(case, "failure", message=message, type="criteria missed")
        failed.text = _clean("\n".join((*run.missed, f"run folder: {run.folder}")))
    return case


def _seconds(time: float) -> str:
    return f"{time:.3f}"


def _clean(text: str) -> str:
    return NOT_XML.sub("?", text)

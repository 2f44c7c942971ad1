"""Turns a YAML file into a scenario, or into one line: file, line, field, value, what is allowed.

::

    name: my_flat
    description: our flat, with the robot that we have
    world: my_flat_plan.yaml     # a built-in world, or a file beside this one
    odometry: poor
    lidar: dropouts
    seeds: 3                     # how many from 0 on; or a list of them: [4, 7, 11]
    time_limit: 900              # simulated [s]
    regions:
      kitchen: [4.0, 0.0, 7.5, 3.0]          # xmin, ymin, xmax, ymax [m]
    criteria:
      coverage: {min: 0.97}
      t95_s: {max: 400}
      coverage_in.kitchen: {min: 0.99}
      t99_s: {max_ratio: 1.5, of: lim_room}  # of that scenario's, with the same seed

``name`` and ``world`` must stand. The other fields of an episode are those of ``burger explore``
(``mapper``, ``navigator``, ``waypoints``, ``odometry_yaw``, ``imu``, ``resolution`` ...) with the
same defaults. A criterion is a key of ``result.json`` with ``min``, ``max``, ``is``, or
``max_ratio`` and ``of``; a null value meets none. Every scenario also asks for ``stop_reason: {is:
complete}``, ``contacts: {max: 0}``, ``home_distance_m: {max: 0.3}``, ``false_free: {max: 0.01}``
and ``map_reloads: {is: true}``, unless it sets another bound on that key.
"""

from dataclasses import fields
from pathlib import Path
from typing import Any

from envs.worlds import WORLDS
from evaluation.episode import EpisodeConfig, check_episode
from evaluation.scenarios.criterion import Criterion
from evaluation.scenarios.scenario import DEFAULT_SEEDS, Region, Scenario
from evaluation.scenarios.yaml_lines import YamlLines, read_yaml_lines
from evaluation.seed_count import MOST_SEEDS
from mapping.errors import TestbedError
from mapping.settings import parse_settings

EPISODE_FIELDS = tuple(each.name for each in fields(EpisodeConfig) if each.name != "seed")

FIELDS = ("name", "description", *EPISODE_FIELDS, "seeds", "regions", "criteria")

BOUNDS = ("min", "max", "is", "max_ratio")

KIND = "a scenario in YAML"


def read_scenario(path: Path) -> Scenario:
    """The scenario of a YAML file; whether its world exists shows in ``check_scenario``.

    Raises:
        TestbedError: The file cannot be read or is no scenario.
    """
    file = read_yaml_lines(path, kind=KIND)
    file.check_keys((), FIELDS, needed=("name", "world"))
    try:
        return Scenario(
            name=_text(file, "name"),
            description=_text(file, "description") if "description" in file.values else "",
            episode=EpisodeConfig(**_settings(file)),
            seeds=_seeds(file),
            regions=_regions(file),
            own_criteria=_criteria(file),
            source=path,
        )
    except TestbedError as error:
        file.relay(error)


def check_scenario(scenario: Scenario) -> None:
    """Refuse a scenario whose world, mapper, sensors or waypoints do not exist or do not fit.

    Raises:
        TestbedError: What `check_episode` raises, with the scenario's file and line.
    """
    try:
        check_episode(scenario.episode)
    except TestbedError as error:
        if scenario.source is None:
            raise
        read_yaml_lines(scenario.source, kind=KIND).relay(error)


def _text(file: YamlLines, field: str) -> str:
    value = file.values[field]
    if not isinstance(value, str) or len(value.splitlines()) != 1:
        file.refuse((field,), "one line of text")
    return value.strip()


def _settings(file: YamlLines) -> dict[str, Any]:
    """The fields of the episode, of the types that they have there."""
    words = []
    for field in EPISODE_FIELDS:
        if field in file.values:
            value = file.values[field]
            if isinstance(value, list | dict):
                file.refuse((field,), "one value")
            words.append(f"{field}={'none' if value is None else value}")
    try:
        settings = parse_settings(EpisodeConfig, words)
    except TestbedError as error:
        raise TestbedError(str(error).removeprefix("setting ")) from None
    settings["world"] = _world(file.path.parent, settings["world"])
    return settings


def _world(folder: Path, name: str) -> str:
    """A world's name as it is; a file's, which is told from the scenario's folder, from here."""
    is_built_in = (WORLDS / f"{name}.yaml").is_file() and name == Path(name).name
    return str(folder / name) if not is_built_in and (folder / name).is_file() else name


def _seeds(file: YamlLines) -> tuple[int, ...]:
    value = file.values.get("seeds", len(DEFAULT_SEEDS))
    counted = tuple(range(value)) if _is_whole(value) and 0 < value <= MOST_SEEDS else value
    if not isinstance(counted, tuple | list) or not counted or not all(map(_is_whole, counted)):
        file.refuse(("seeds",), f"how many, 1 to {MOST_SEEDS}, or a list of whole numbers")
    return tuple(counted)


def _regions(file: YamlLines) -> dict[str, Region]:
    if "regions" not in file.values:
        return {}
    listed = file.values["regions"]
    if not isinstance(listed, dict):
        file.refuse(("regions",), "names with [xmin, ymin, xmax, ymax] [m]")
    regions = {}
    for name, sides in listed.items():
        place = ("regions", name)
        if not (isinstance(sides, list) and len(sides) == 4 and all(map(_is_number, sides))):
            file.refuse(place, "four numbers [xmin, ymin, xmax, ymax] [m]")
        left, bottom, right, top = map(float, sides)
        try:
            regions[str(name)] = Region(left=left, bottom=bottom, right=right, top=top)
        except TestbedError as error:
            file.complain(place, f"regions: {name}: {error}")
    return regions


def _criteria(file: YamlLines) -> tuple[Criterion, ...]:
    """All criteria, a bound each."""
    if "criteria" not in file.values:
        return ()
    listed = file.values["criteria"]
    if not isinstance(listed, dict):
        file.refuse(("criteria",), "keys of result.json, each with {min: }, {max: } or {is: }")
    return tuple(criterion for key in listed for criterion in _criteria_of(file, ("criteria", key)))


def _criteria_of(file: YamlLines, place: tuple[str, str]) -> list[Criterion]:
    """The bounds of one key."""
    key = place[-1]
    bounds = file.values["criteria"][key]
    try:
        if isinstance(bounds, dict) and not bounds:
            file.refuse(place, f"one of {', '.join(BOUNDS)} with a value")
        file.check_keys(place, (*BOUNDS, "of"))
        of = bounds.get("of", "")
        if not isinstance(of, str):
            file.refuse((*place, "of"), "a scenario's name or file")
        if of and "max_ratio" not in bounds:
            file.complain((*place, "of"), f"criteria: {key}: of: stands without max_ratio")
        least, most = bounds.get("min"), bounds.get("max")
        if _is_number(least) and _is_number(most) and least > most:
            file.refuse(place, "bounds that a value can keep: min at most max")
        return [
            Criterion(key=key, bound=bound, value=value, of=of if bound == "max_ratio" else "")
            for bound, value in bounds.items()
            if bound != "of"
        ]
    except TestbedError as error:
        file.relay(TestbedError(f"criteria: {error}") if type(error) is TestbedError else error)


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

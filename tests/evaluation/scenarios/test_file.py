"""Scenario files: what stands in them is what is run, and a mistake is told with its line."""

import re
from pathlib import Path

import pytest

import evaluation.scenarios.file
from envs.plan_yaml import write_plan
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.scenarios.criterion import Criterion
from evaluation.scenarios.file import check_scenario, read_scenario
from evaluation.scenarios.scenario import BASE_CRITERIA, Region
from mapping.errors import TestbedError
from tests.evaluation.scenarios.scenario_files import write_scenario


def refusal(path: Path) -> str:
    with pytest.raises(TestbedError) as caught:
        check_scenario(read_scenario(path))
    told = str(caught.value)
    assert told.startswith(f"{path}: ")
    assert len(told.splitlines()) == 1
    return told.removeprefix(f"{path}: ")


def test_a_scenario_is_what_its_file_says(tmp_path: Path) -> None:
    scenario = read_scenario(write_scenario(tmp_path))
    assert (scenario.name, scenario.description) == ("mine", "a room of my own")
    assert (scenario.episode.world, scenario.episode.time_limit) == ("lim_room", 60.0)
    assert scenario.seeds == (0, 1)
    assert scenario.config(7).seed == 7
    assert scenario.regions == {"corner": Region(left=0.0, bottom=0.0, right=1.0, top=1.0)}
    assert scenario.own_criteria == (
        Criterion(key="coverage", bound="min", value=0.9),
        Criterion(key="t95_s", bound="min", value=1),
        Criterion(key="t95_s", bound="max", value=65),
        Criterion(key="coverage_in.corner", bound="min", value=0.99),
    )
    assert scenario.criteria == BASE_CRITERIA + scenario.own_criteria


def test_the_example_in_the_docstring_reads(tmp_path: Path) -> None:
    text = (evaluation.scenarios.file.__doc__ or "").split("::\n", 1)[1].split("``name``")[0]
    path = tmp_path / "example.yaml"
    path.write_text("\n".join(line.removeprefix("    ") for line in text.splitlines()))
    scenario = read_scenario(path)
    assert scenario.seeds == (0, 1, 2)
    assert scenario.own_criteria[-1] == Criterion(
        key="t99_s", bound="max_ratio", value=1.5, of="lim_room"
    )


def test_the_example_in_the_documentation_can_be_copied(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "docs" / "exploration.md").read_text()
    (block,) = [each for each in text.split("```yaml\n")[1:] if each.startswith("name: my_flat")]
    path = tmp_path / "my_flat.yaml"
    path.write_text(block.split("```")[0])
    check_scenario(read_scenario(path))


def test_seeds_may_be_listed_and_are_continued_after_the_largest(tmp_path: Path) -> None:
    scenario = read_scenario(write_scenario(tmp_path, ("seeds: 2", "seeds: [7, 3]")))
    assert scenario.seeds == (7, 3)
    assert scenario.with_seeds(1).seeds == (7,)
    assert scenario.with_seeds(4).seeds == (7, 3, 8, 9)
    with pytest.raises(TestbedError, match="seeds: 0; must be 1 to"):
        scenario.with_seeds(0)


def test_a_world_file_is_looked_for_beside_the_scenario(tmp_path: Path) -> None:
    write_plan(TINY_ROOM, tmp_path / "tiny.yaml")
    scenario = read_scenario(write_scenario(tmp_path, ("lim_room", "tiny.yaml")))
    assert scenario.episode.world == str(tmp_path / "tiny.yaml")
    check_scenario(scenario)


def test_a_bound_of_its_own_replaces_that_of_all_scenarios(tmp_path: Path) -> None:
    path = write_scenario(tmp_path, ("coverage: {min: 0.9}", "contacts: {max: 2}"))
    contacts = [each for each in read_scenario(path).criteria if each.key == "contacts"]
    assert contacts == [Criterion(key="contacts", bound="max", value=2)]


def test_an_unknown_field_is_told_with_its_line_and_the_nearest(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("time_limit: 60", "time_limt: 60")))
    assert told.startswith("line 6: time_limt: unknown key; did you mean time_limit? must be one")


def test_a_missing_field_is_told(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("world: lim_room\n", "")))
    assert told == "line 1: world: missing; must stand"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("time_limit: 60", "time_limit: long", "line 6: time_limit: 'long'; must be a number"),
        ("time_limit: 60", "time_limit: [1]", "line 6: time_limit: [1]; must be one value"),
        ("seeds: 2", "seeds: 0", "line 5: seeds: 0; must be how many, 1 to 100000, or a"),
        ("seeds: 2", "seeds: 10000000000", "line 5: seeds: 10000000000; must be how many"),
        ("seeds: 2", "seeds: [1, 1]", "line 5: seeds: [1, 1]; must be different numbers"),
        ("seeds: 2", "seeds: [-1]", "line 5: seeds: [-1]; must be different numbers, 0 or more"),
        ("seeds: 2", "seeds: [a]", "line 5: seeds: ['a']; must be how many"),
        ("name: mine", "name: ../mine", "line 1: name: '../mine'; must be letters"),
        ("name: mine", "name: 3", "line 1: name: 3; must be one line of text"),
        ("[0, 0, 1, 1]", "[0, 0, 1]", "line 8: regions: corner: [0, 0, 1]; must be four numbers"),
        ("[0, 0, 1, 1]", "[1, 0, 1, 1]", "line 8: regions: corner: [1, 0, 1, 1]; must be [xmin"),
        ("{min: 0.9}", "0.9", "line 10: criteria: coverage: 0.9; must be keys and values: min"),
        (
            "{min: 0.9}",
            "{min: 1, max: 0}",
            "line 10: criteria: coverage: {'max': 0, 'min': 1}; must be bounds",
        ),
        ("{min: 0.9}", "{}", "line 10: criteria: coverage: {}; must be one of min, max"),
    ],
)
def test_a_value_of_the_wrong_kind_is_told_with_its_line(
    old: str, new: str, told: str, tmp_path: Path
) -> None:
    assert refusal(write_scenario(tmp_path, (old, new))).startswith(told)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("time_limit: 60", "time_limit: -1", "line 6: time_limit: -1.0 s; must be finite"),
        ("typical", "typcal", "line 4: odometry: 'typcal'"),
        ("world: lim_room", "world: lim_rom", "line 3: world: 'lim_rom': no such world"),
        ("seeds: 2", "lidar: none_such", "line 5: lidar: 'none_such'"),
        ("seeds: 2", "mapper: none_such", "line 5: mapper: 'none_such'; must be one of"),
        ("seeds: 2", "waypoints: 1,1", "line 5: waypoints: given; must not be with"),
        ("seeds: 2", "odometry_yaw: gps", "line 5: odometry_yaw: 'gps'; must be encoders or imu"),
    ],
)
def test_what_the_episode_refuses_is_told_with_its_line(
    old: str, new: str, told: str, tmp_path: Path
) -> None:
    assert refusal(write_scenario(tmp_path, (old, new))).startswith(told)


def test_a_slip_in_the_key_of_a_criterion_names_the_nearest(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("  t95_s:", "  t95:")))
    assert told.startswith("line 11: criteria: t95: unknown key; did you mean t95_s? must be one")


def test_a_slip_in_a_bound_names_the_nearest(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("{min: 0.9}", "{mim: 0.9}")))
    assert told.startswith("line 10: criteria: coverage: mim: unknown key; did you mean min?")


def test_an_unknown_region_names_the_nearest(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("coverage_in.corner", "coverage_in.conner")))
    assert told.startswith(
        "line 12: criteria: coverage_in.conner: unknown region; did you mean corner? must be one "
        "of regions (corner)"
    )


@pytest.mark.parametrize(
    ("bound", "told"),
    [
        ("{min: high}", "coverage: min: 'high'; must be a number"),
        ("{min: .nan}", "coverage: min: nan; must be a number"),
        ("{min: true}", "coverage: min: True; must be a number"),
        ("{min: null}", "coverage: min: None; must be a number"),
        ("{max_ratio: 2}", "of: must name a scenario beside max_ratio"),
        ("{max_ratio: 0, of: lim_room}", "coverage: max_ratio: 0; must be above 0 and finite"),
        ("{max: 2, of: lim_room}", "coverage: of: stands without max_ratio"),
        ("{max_ratio: 2, of: 3}", "coverage: of: 3; must be a scenario's name or file"),
    ],
)
def test_a_bound_that_nothing_can_be_held_against_is_told(
    bound: str, told: str, tmp_path: Path
) -> None:
    line = refusal(write_scenario(tmp_path, ("{min: 0.9}", bound)))
    assert re.match(rf"line (9|10): criteria: {re.escape(told)}", line), line


def test_a_word_has_no_least_value(tmp_path: Path) -> None:
    path = write_scenario(tmp_path, ("coverage: {min: 0.9}", "stop_reason: {max: 3}"))
    told = refusal(path)
    assert told == "line 10: criteria: stop_reason: max: is no number; must have the bound is"


def test_the_line_counts_comments_and_empty_lines(tmp_path: Path) -> None:
    path = write_scenario(tmp_path, ("seeds: 2", "# so many\n\n\nseeds: none"))
    assert refusal(path).startswith("line 8: seeds: 'none'")


def test_a_bad_line_of_yaml_is_told(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("seeds: 2", "seeds: [2")))
    assert told.startswith("line 6: not YAML")


def test_a_key_said_twice_is_told_with_its_line(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("seeds: 2", "seeds: 2\nseeds: 3")))
    assert told.startswith("line 6: not YAML ('seeds' stands twice)")


@pytest.mark.parametrize("text", ["", "- a\n- b\n", "just words\n"])
def test_a_file_without_keys_is_no_scenario(text: str, tmp_path: Path) -> None:
    path = tmp_path / "empty.yaml"
    path.write_text(text)
    assert refusal(path).startswith("line 1: no keys and values; must be a scenario in YAML")


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    assert refusal(tmp_path / "none.yaml") == "no such file; must be a scenario in YAML"


def test_an_alias_that_holds_itself_is_survived(tmp_path: Path) -> None:
    told = refusal(write_scenario(tmp_path, ("{min: 0.9}", "&me {min: *me}")))
    assert told.startswith("line 10: criteria: coverage: min: ")

"""Sweeps: every combination once, going on after an interruption, a table and a CSV of all."""

import csv
import json
import math
from pathlib import Path
from unittest.mock import patch

import pytest

from evaluation.episode import EpisodeConfig
from evaluation.episode_pool import Failure, Job, Outcome
from evaluation.sweeps.run_record import RunRecord
from evaluation.sweeps.run_table import ALL_WORLDS, group_runs, table_of
from evaluation.sweeps.sweep import SweepConfig, finished_runs, plan_sweep, run_sweep
from mapping.errors import TestbedError
from scripts.__main__ import run

TINY = """
name: tiny
start: [0.5, 0.5, 0.0]
walls: [{points: [[0, 0], [2, 0], [2, 1.5], [0, 1.5]], closed: true}]
"""


@pytest.fixture
def world(tmp_path: Path) -> str:
    path = tmp_path / "tiny.yaml"
    path.write_text(TINY)
    return str(path)


def quick(world: str, **wishes: object) -> SweepConfig:
    return SweepConfig(**{"worlds": (world,), "mappers": ("ogm",), "time_limit": 1.0, **wishes})


def record(**result: object) -> RunRecord:
    config = {"world": "w", "mapper": "m", "navigator": "n", "odometry": "typical"}
    return RunRecord(folder=Path("w"), config=config, result=dict(result))


def test_every_combination_has_a_folder_and_a_seed_of_its_own(tmp_path: Path) -> None:
    sweep = SweepConfig(
        worlds=("lim_room", "random:0..2,area=40"),
        mappers=("ogm", "graph"),
        navigators=("frontier", "nearest"),
        odometry=("typical", "poor"),
        seeds=2,
    )
    planned = plan_sweep(sweep, tmp_path)
    assert len(planned) == len(set(planned.values())) == 4 * 2 * 2 * 2 * 2
    config = planned[tmp_path / "random_2_area40-graph-nearest-poor-seed1"]
    assert config.world == "random:2,area=40"
    assert (config.mapper, config.navigator, config.odometry) == ("graph", "nearest", "poor")
    assert config.seed == 1


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"worlds": ("lim_room", "nowhere")}, "nowhere"),
        ({"worlds": ("lim_room", "random:x")}, "random:x"),
        ({"mappers": ("ogm", "crayon")}, "crayon"),
        ({"navigators": ("frontier", "compass")}, "compass"),
        ({"odometry": ("typical", "psychic")}, "psychic"),
    ],
)
def test_what_cannot_be_run_is_refused_before_anything_is(
    wrong: dict[str, tuple[str, ...]], told: str, tmp_path: Path
) -> None:
    with pytest.raises(TestbedError, match=told):
        plan_sweep(SweepConfig(**{"worlds": ("lim_room",), "mappers": ("ogm",), **wrong}), tmp_path)


def test_two_files_of_one_name_are_refused(world: str, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "tiny.yaml").write_text(TINY)
    with pytest.raises(TestbedError, match="share the folder tiny-ogm"):
        plan_sweep(quick(world, worlds=(world, str(other / "tiny.yaml"))), tmp_path)


def test_a_sweep_of_nothing_is_refused() -> None:
    with pytest.raises(TestbedError, match="worlds: none"):
        SweepConfig(worlds=())
    with pytest.raises(TestbedError, match="seeds: 0"):
        SweepConfig(worlds=("lim_room",), seeds=0)
    with pytest.raises(TestbedError, match="seeds: 100000000000"):
        SweepConfig(worlds=("lim_room",), seeds=10**11)


def test_a_sweep_that_was_interrupted_goes_on_and_ends_in_the_same_table(
    world: str, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    planned = plan_sweep(quick(world, seeds=3), out)
    with patch("evaluation.sweeps.sweep.run_episodes", interrupted_after(1)):
        cut_short = run_sweep(planned, out, finished={})
    assert cut_short.interrupted
    assert [record.config["seed"] for record in cut_short.runs] == [0]
    finished = finished_runs(planned)
    assert list(finished) == list(planned)[:1]
    ran: list[Path] = []
    whole = run_sweep(
        planned, out, finished=finished, on_run=lambda record: ran.append(record.folder)
    )
    assert ran == list(planned)[1:]
    assert not whole.interrupted
    assert [record.config["seed"] for record in whole.runs] == [0, 1, 2]
    rows = list(csv.DictReader((out / "sweep.csv").open()))
    assert [row["seed"] for row in rows] == ["0", "1", "2"]
    for row in rows:
        result = json.loads((out / row["folder"] / "result.json").read_text())
        assert float(row["coverage"]) == result["coverage"]
        assert row["dropped_frontiers"] == str(len(result["dropped_frontiers"]))


def interrupted_after(count: int):  # type: ignore[no-untyped-def]
    """A pool that Ctrl-C reaches after so many runs."""
    from evaluation.episode_pool import run_episodes

    def cut_short(jobs: list[Job], *, processes: int, on_done) -> list[Outcome]:  # type: ignore[no-untyped-def]
        run_episodes(jobs[:count], processes=processes, on_done=on_done)
        raise KeyboardInterrupt

    return cut_short


def test_a_run_of_another_config_or_of_a_world_that_changed_is_run_again(
    world: str, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    planned = plan_sweep(quick(world), out)
    run_sweep(planned, out, finished={})
    assert len(finished_runs(planned)) == 1
    assert not finished_runs(plan_sweep(quick(world, time_limit=2.0), out))
    (folder,) = planned
    (folder / "result.json").write_text("{")
    assert not finished_runs(planned)


def test_a_failed_run_is_a_row_with_its_reason(world: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    planned = plan_sweep(quick(world, seeds=2), out)
    out.mkdir()

    def half(jobs: list[Job], *, processes: int, on_done) -> None:  # type: ignore[no-untyped-def]
        on_done(0, {"stop_reason": "complete", "coverage": 1.0, "contacts": 0})
        on_done(1, Failure(reason="ValueError: no"))

    with patch("evaluation.sweeps.sweep.run_episodes", half):
        sweep = run_sweep(planned, out, finished={})
    assert [record.failure for record in sweep.failures] == ["ValueError: no"]
    rows = list(csv.DictReader((out / "sweep.csv").open()))
    assert [row["failure"] for row in rows] == ["", "ValueError: no"]
    assert list(rows[0])[-1] == "failure"
    (group,) = group_runs(sweep.runs)
    assert group.complete_share == 0.5


def test_a_time_that_was_not_reached_counts_as_infinite_and_its_efficiency_as_none() -> None:
    (group,) = group_runs(
        [record(t95_s=100.0, efficiency=0.8), record(t95_s=None, efficiency=None)] * 2
        + [record(t95_s=None, efficiency=None)]
    )
    assert group.median("t95_s") == math.inf
    assert group.median("efficiency") == 0.0
    assert math.isnan(group.median("f1_5cm"))


def test_the_table_sums_up_each_variant_over_the_worlds() -> None:
    runs = [
        RunRecord(
            folder=Path("w"),
            config={"world": world, "mapper": "m", "navigator": navigator, "odometry": "typical"},
            result={"stop_reason": "complete", "coverage": coverage, "contacts": 1},
        )
        for world, navigator, coverage in (("a", "x", 1.0), ("a", "y", 0.5), ("b", "x", 0.8))
    ]
    headings, *rows = table_of(runs)
    assert headings[:4] == ["world", "mapper", "navigator", "runs"], "one odometry is not told"
    assert [row[0] for row in rows] == ["a", "a", "b", ALL_WORLDS, ALL_WORLDS]
    over_all = dict(zip(headings, rows[3], strict=True))
    assert (over_all["runs"], over_all["complete"], over_all["contacts"]) == ("2", "100%", "2")
    assert over_all["coverage"] == "0.900"


@pytest.mark.parametrize(("key", "values"), [("people", (0, 3)), ("lidar", ("ideal", "measured"))])
def test_runs_that_differ_in_anything_but_the_seed_are_not_summed_up(
    key: str, values: tuple[object, object]
) -> None:
    named = {"world": "a", "mapper": "m", "navigator": "x"}
    runs = [
        RunRecord(
            folder=Path("w"),
            config={**named, key: value, "seed": seed},
            result={"stop_reason": "complete"},
        )
        for value in values
        for seed in (0, 1)
    ]
    headings, *rows = table_of(runs)
    assert headings[:5] == ["world", "mapper", "navigator", key, "runs"]
    assert [row[3:5] for row in rows] == [[str(value), "2"] for value in values]


def test_the_command_says_what_it_keeps_and_exits_as_it_went(
    world: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scripts.sweep.compile_if_needed", lambda *_, **__: None)
    words = ["sweep", "--worlds", world, "--mappers", "ogm", "--time-limit", "1"]
    words += ["--out", str(tmp_path / "out")]
    assert run(words) == 0
    assert run(words) == 0
    assert "1 of 1 runs are there already" in capsys.readouterr().out
    assert run([*words, "--jobs", "0"]) == 2
    assert run(["sweep", "--worlds", "nowhere", "--out", str(tmp_path / "no")]) == 2
    assert not (tmp_path / "no").exists()
    broken = patch("scripts.sweep.run_sweep", side_effect=KeyboardInterrupt)
    with broken:
        assert run(words) == 130


def test_a_config_that_is_run_is_the_one_in_its_folder(world: str, tmp_path: Path) -> None:
    planned = plan_sweep(quick(world, odometry=("poor",), lidar="ideal"), tmp_path)
    (episode,) = planned.values()
    assert episode == EpisodeConfig(
        world=world, mapper="ogm", odometry="poor", lidar="ideal", time_limit=1.0
    )

"""The first run: it says that it compiles, but never before bad input is told of."""

from pathlib import Path

import pytest

from evaluation.kernels.kernel_set import KernelSet
from evaluation.kernels.warm_up import kernels_of_mapper
from scripts.first_run import compile_if_needed
from tests.scripts.test_bad_input import refused, refused_exploration


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Whose kernels were compiled, on a machine where none are yet."""
    owners: list[str] = []
    monkeypatch.setattr(KernelSet, "is_ready", False)
    monkeypatch.setattr(KernelSet, "compile", lambda kernels: owners.append(kernels.owner))
    return owners


@pytest.mark.parametrize(
    "option",
    [
        ("--mapper", "grpah"),
        ("--navigator", "fronteir"),
        ("--lidar", "hokuyo"),
        ("--odometry", "good"),
        ("--imu", "none"),
        ("--waypoints", "there"),
    ],
)
def test_bad_options_of_an_episode_are_refused_before_anything_is_compiled(
    option: tuple[str, str],
    compiled: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert option[1] in refused_exploration("lim_room", tmp_path, capsys, *option)
    assert compiled == []


def test_an_unknown_world_is_refused_before_anything_is_compiled(
    compiled: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "lim_rom" in refused_exploration("lim_rom", tmp_path, capsys)
    assert compiled == []


def test_a_bad_setting_of_a_replay_is_refused_before_anything_is_compiled(
    compiled: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "one.log"
    log.write_text("FLASER 3 1.0 1.0 1.0 0 0 0 0 0 0 1.0 robot 1.0\n")
    line = refused(
        ["replay", "--log", str(log), "--out", str(tmp_path / "run"), "--set", "hit"], capsys
    )
    assert "NAME=VALUE" in line
    assert compiled == []


def test_a_good_run_compiles_and_says_so(
    compiled: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    checked: list[bool] = []
    compile_if_needed(kernels_of_mapper("ogm", simulates=True), lambda: checked.append(True))
    assert compiled == ["mapper ogm"]
    assert checked == [True]
    assert "compiling the kernels of mapper ogm" in capsys.readouterr().err

"""The wheel carries its data and runs without the repository."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built from a copy of the sources, so that the checkout stays clean."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    ignored = shutil.ignore_patterns(".*", "__pycache__", "runs", "build", "*.egg-info", "tests")
    shutil.copytree(ROOT, source, ignore=ignored)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
        + ["--wheel-dir", str(folder), str(source)],
        check=True,
        cwd=folder,
    )
    (built,) = folder.glob("*.whl")
    return built


def test_the_wheel_contains_every_asset(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    assets = {
        path.relative_to(ROOT).as_posix()
        for pattern in ("*.xml", "*.yaml")
        for path in (ROOT / "assets").rglob(pattern)
    }
    assert assets
    assert assets <= names


def test_the_wheel_contains_every_module(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    modules = {
        path.relative_to(ROOT).as_posix()
        for package in ("assets", "mapping", "nav", "envs", "evaluation", "scripts")
        for path in (ROOT / package).rglob("*.py")
    }
    assert modules <= names


def test_the_wheel_runs_an_episode_in_a_clean_environment(wheel: Path, tmp_path: Path) -> None:
    home = tmp_path / "venv"
    venv.create(home, with_pip=False)
    (site,) = home.glob("lib/python*/site-packages")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    # The dependencies come from this environment; a path named in a .pth file is searched, but
    # the .pth files in it are not read, so the editable install of the project stays unseen.
    (site / "dependencies.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    code = (
        "import sys, mapping; assert 'venv' in mapping.__file__, mapping.__file__;"
        "from scripts.__main__ import run; sys.exit(run(sys.argv[1:]))"
    )
    words = "explore --world empty_room --resolution 0.05 --time-limit 1.5 --out run".split()
    # Uncompiled kernels: compiling them would take half a minute, running them takes seconds.
    outcome = subprocess.run(
        [str(home / "bin" / "python"), "-c", code, *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": ""},
    )
    assert outcome.returncode == 1, f"out of time is status 1\n{outcome.stderr}"
    result = json.loads((tmp_path / "run" / "result.json").read_text())
    assert result["stop_reason"] == "time_limit"
    assert result["map_updates"] > 3
    assert "compiling" not in outcome.stderr, "without a compiler there is nothing to wait for"

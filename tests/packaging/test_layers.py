"""The folders import one way only."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def lint_imports(*options: str) -> subprocess.CompletedProcess[str]:
    program = Path(sys.executable).with_name("lint-imports")
    return subprocess.run(
        [str(program), "--no-cache", *options],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_folders_import_one_way_only() -> None:
    outcome = lint_imports()
    assert outcome.returncode == 0, outcome.stdout


def test_the_layer_check_can_fail(tmp_path: Path) -> None:
    upside_down = tmp_path / "layers.ini"
    upside_down.write_text(
        "[importlinter]\nroot_packages =\n    mapping\n    nav\n"
        "[importlinter:contract:1]\nname = upside down\ntype = layers\n"
        "layers =\n    mapping\n    nav\n"
    )
    assert lint_imports("--config", str(upside_down)).returncode == 1


def test_asking_for_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from scripts.__main__ import run; run(['--help']);"
        "heavy = {'numpy', 'numba', 'mujoco', 'matplotlib', 'gymnasium', 'scipy', 'tyro'};"
        "sys.exit(str(heavy & set(sys.modules)) if heavy & set(sys.modules) else 0)"
    )
    outcome = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert outcome.returncode == 0, outcome.stderr
    assert "explore" in outcome.stdout

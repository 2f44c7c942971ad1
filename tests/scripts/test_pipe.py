"""The command in a pipe that nobody reads any more, as in ``burger world list | head -1``."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("words", [["--help"], ["world", "list"], ["world", "--help"]])
def test_a_reader_that_has_left_is_no_reason_for_a_traceback(words: list[str]) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "scripts", *words],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as child:
        assert child.stdout is not None
        assert child.stderr is not None
        child.stdout.close()
        assert child.stderr.read() == b""
        assert child.wait() == 141

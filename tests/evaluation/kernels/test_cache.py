"""Which kernels are compiled: noted by what a process called."""

import os
from pathlib import Path
from unittest.mock import patch

import numpy as np

from evaluation.kernels import cache
from evaluation.kernels.cache import called_kernels, is_compiled, note_kernels
from mapping import hit_cells
from mapping.hit_cells import raise_to


def test_what_was_called_is_told_with_its_folder() -> None:
    raise_to(
        np.zeros((2, 2), dtype=np.float32),
        np.zeros((1, 2), dtype=np.int64),
        np.ones(1, dtype=np.float32),
    )
    folder = Path(called_kernels()[hit_cells.__file__])
    assert any(folder.glob("hit_cells.*.nbi"))


def test_a_kind_of_run_is_cold_until_it_is_noted_and_when_a_kernel_has_changed(
    tmp_path: Path,
) -> None:
    note, source = tmp_path / "kernels.json", tmp_path / "kernel.py"
    source.touch()
    (tmp_path / "kernel.f-1.py311.nbi").touch()
    with (
        patch.object(cache, "_note_of", lambda kind: note),
        patch.object(cache, "called_kernels", lambda: {str(source): str(tmp_path)}),
    ):
        assert not is_compiled("some")
        note_kernels("some")
        assert is_compiled("some")
        later = source.stat().st_mtime + 10.0
        os.utime(source, (later, later))
        assert not is_compiled("some"), "its code is older than it"
        source.unlink()
        assert not is_compiled("some"), "it is no longer there"
        note.write_text("not json")
        assert not is_compiled("some")


def test_without_a_compiler_there_is_nothing_to_compile() -> None:
    with patch.object(cache, "interpolate", lambda: None):
        assert is_compiled("some")
        note_kernels("some")

"""The digest tells states of the sources apart: those that matter, however they are imported."""

from pathlib import Path

import pytest

from evaluation import source_digest
from evaluation.kernels import cache
from evaluation.source_digest import digest_of_sources, digest_with_imports, imports_of


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project whose kernel has a constant of a file that imports another."""
    files = {
        "mapping/kernel.py": "import numpy\nfrom mapping.sizes import WIDTH  # njit\n",
        "mapping/sizes.py": "from nav.deep import (\n    first,\n    second,\n)\nWIDTH = 1\n",
        "mapping/other.py": "from mapping.kernel import run\n",
        "nav/deep/__init__.py": "",
        "nav/deep/second.py": "FACTOR = 2\n",
        "assets/worlds/room.yaml": "name: room\n",
        "assets/notes.txt": "nothing\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(source_digest, "ROOT", tmp_path)
    monkeypatch.setattr(cache, "ROOT", tmp_path)
    return tmp_path


def test_imports_are_found_in_brackets_and_of_packages(root: Path) -> None:
    assert imports_of(root / "mapping" / "kernel.py") == [root / "mapping" / "sizes.py"]
    deep = root / "nav" / "deep"
    assert imports_of(root / "mapping" / "sizes.py") == [deep / "__init__.py", deep / "second.py"]


@pytest.mark.parametrize("file", ["mapping/kernel.py", "mapping/sizes.py", "nav/deep/second.py"])
def test_compiled_code_is_told_stale_by_whatever_its_kernel_imports(root: Path, file: str) -> None:
    before = digest_with_imports([root / "mapping" / "kernel.py"])
    assert cache._fingerprint() == before
    (root / file).write_text((root / file).read_text() + "MORE = 3\n")
    assert cache._fingerprint() != before


def test_compiled_code_is_not_told_stale_by_what_uses_it(root: Path) -> None:
    before = cache._fingerprint()
    (root / "mapping" / "other.py").write_text("MORE = 3\n")
    assert cache._fingerprint() == before


@pytest.mark.parametrize(
    ("file", "matters"),
    [("mapping/other.py", True), ("assets/worlds/room.yaml", True), ("assets/notes.txt", False)],
)
def test_a_runs_sources_are_the_code_and_the_worlds(root: Path, file: str, matters: bool) -> None:
    digests = []
    for text in ("a = 1\n", "a = 2\n"):
        (root / file).write_text(text)
        digest_of_sources.cache_clear()
        digests.append(digest_of_sources())
    digest_of_sources.cache_clear()
    assert (digests[0] != digests[1]) == matters

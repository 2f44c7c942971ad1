"""One reader for every format of a recorded run."""

from pathlib import Path

import pytest

from mapping.errors import TestbedError
from mapping.io.carmen_writer import write_carmen
from mapping.io.recorded_run import RecordedRun
from mapping.io.rosbag_writer import write_rosbag
from mapping.io.sensor_log_file import read_log
from tests.mapping.io.logs import driven_log


@pytest.mark.parametrize("name", ["a.log", "a.clf", "a.carmen", "a.txt", "a"])
def test_a_carmen_log_is_known_by_its_lines_whatever_its_name(tmp_path: Path, name: str) -> None:
    write_carmen(tmp_path / name, driven_log())
    assert len(read_log(tmp_path / name).scans) == 10


def test_bags_are_known_as_folders_and_as_files(tmp_path: Path) -> None:
    for name in ("bag", "a.mcap"):
        write_rosbag(tmp_path / name, RecordedRun(log=driven_log()))
        assert len(read_log(tmp_path / name).scans) == 10


def test_of_a_runs_folder_the_log_is_read_and_without_it_the_bag(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_text("{}")
    write_rosbag(tmp_path / "bag", RecordedRun(log=driven_log(seconds=1.0)))
    write_carmen(tmp_path / "log.carmen", driven_log(seconds=2.0))
    assert len(read_log(tmp_path).scans) == 10
    (tmp_path / "log.carmen").unlink()
    assert len(read_log(tmp_path).scans) == 5


def test_the_folder_of_a_run_that_was_not_recorded_is_told_how_to_record_it(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_text("{}")
    with pytest.raises(TestbedError, match="--record"):
        read_log(tmp_path)


@pytest.mark.parametrize(
    ("name", "content"), [("a.txt", b"1 2 3\n"), ("a.log", b""), ("a.bin", bytes(range(256)) * 999)]
)
def test_a_file_of_another_kind_is_told_what_it_may_be(
    tmp_path: Path, name: str, content: bytes
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(TestbedError, match=r"unknown format; must be a CARMEN log") as error:
        read_log(tmp_path / name)
    assert "\n" not in str(error.value)


def test_a_path_at_which_nothing_is_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="no such file or folder"):
        read_log(tmp_path / "gone")

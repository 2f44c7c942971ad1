"""Turns a recorded run in any of the formats that are read into a sensor log."""

from pathlib import Path

from mapping.errors import TestbedError
from mapping.io.carmen import KINDS
from mapping.io.carmen_reader import read_carmen
from mapping.io.rosbag_reader import STORAGES, read_rosbag
from mapping.sensor_log import SensorLog

RECORDED_LOG, RECORDED_BAG = "log.carmen", "bag"
"""What a recorded run's folder holds."""

ROS_1_BAG = ".bag"
"""Ending of a kind of bag that is known but not read."""

SNIFFED_LINES = 1000
"""A CARMEN log shows itself within so many lines; what comes first may be comments."""

SNIFFED_BYTES = 65536
"""Of a line so much is looked at: a file without line breaks is not read whole."""

_KINDS = tuple(kind.encode() for kind in KINDS)


def read_log(path: str | Path) -> SensorLog:
    """Read a CARMEN log, a ROS 2 bag, an MCAP file or the folder of a recorded run.

    Of a run's folder the CARMEN log is read, which holds the same messages as the bag with more
    digits and needs no library; the bag is read when there is no such log.

    Raises:
        TestbedError: It is none of these, it is broken, or the run was not recorded.
    """
    path = Path(path)
    if not path.exists():
        raise TestbedError(f"{path}: no such file or folder; must be a log")
    if path.is_dir():
        return _read_folder(path)
    if path.suffix in (*STORAGES, ROS_1_BAG):
        return read_rosbag(path)
    if _is_carmen(path):
        return read_carmen(path)
    raise TestbedError(
        f"{path}: unknown format; must be a CARMEN log (lines of {', '.join(KINDS[:3])}), "
        "a ROS 2 bag, an .mcap file, or the folder of a run with --record"
    )


def _read_folder(path: Path) -> SensorLog:
    """The log in a folder: of a bag, or of a recorded run."""
    if (path / RECORDED_LOG).is_file():
        return read_carmen(path / RECORDED_LOG)
    if (path / RECORDED_BAG).is_dir():
        return read_rosbag(path / RECORDED_BAG)
    if (path / "config.json").is_file():
        raise TestbedError(
            f"{path}: holds no {RECORDED_LOG}; must be the folder of a run with --record"
        )
    return read_rosbag(path)


def _is_carmen(path: Path) -> bool:
    """Whether one of the first lines is of a kind that CARMEN logs have."""
    try:
        with path.open("rb") as file:
            first = (file.readline(SNIFFED_BYTES).split(maxsplit=1) for _ in range(SNIFFED_LINES))
            return any(words and words[0] in _KINDS for words in first)
    except OSError as error:
        raise TestbedError(f"{path}: cannot be read ({error.strerror}); must be a log") from error

"""The moving picture of a short episode in a tiny room, read back with Pillow."""

from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from evaluation.animation.animation import LAST_FRAME_MS, Animation
from evaluation.animation.frame import COLOURS, PEOPLE_COLOUR, SCAN_COLOUR
from evaluation.animation.map_canvas import MapCanvas
from evaluation.animation.scan_ends import scan_ends
from evaluation.episode import Episode, EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.progress import Progress
from mapping.coarse_map import coarse_map
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.path_plot import PATH_COLOUR
from mapping.plot import FREE_COLOUR, OCCUPIED_COLOUR, UNKNOWN_COLOUR

CONFIG = EpisodeConfig(world="tiny_room", mapper="ogm", seed=3, time_limit=12.0, people=1)

Frames = list[NDArray[np.uint8]]


def animated(config: EpisodeConfig, file: Path) -> tuple[Episode, int]:
    """The episode of a config, and how often it told of its progress."""
    animation, times = Animation(), []

    def note(progress: Progress) -> None:
        times.append(progress.time)
        animation.note(progress)

    episode = run_episode(config, note, plan=TINY_ROOM)
    animation.write(file, episode)
    return episode, len(times)


def frames_of(file: Path) -> Frames:
    with Image.open(file) as picture:
        frames = []
        for index in range(picture.n_frames):
            picture.seek(index)
            frames.append(np.asarray(picture.convert("RGB")))
        return frames


def has(frame: NDArray[np.uint8], colour: str) -> NDArray[np.bool_]:
    return np.asarray((frame == list(bytes.fromhex(colour[1:]))).all(axis=-1))


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Episode, int]:
    file = tmp_path_factory.mktemp("animation") / "episode.gif"
    return file, *animated(CONFIG, file)


def test_there_is_a_frame_for_every_simulated_second_and_one_for_the_end(
    run: tuple[Path, Episode, int],
) -> None:
    file, episode, told = run
    frames = frames_of(file)
    assert len(frames) == told + 1
    assert told == pytest.approx(episode.sim_time, abs=2.0)
    assert len({frame.shape for frame in frames}) == 1
    with Image.open(file) as picture:
        picture.seek(picture.n_frames - 1)
        assert picture.info["duration"] == LAST_FRAME_MS


def test_the_last_frame_shows_the_final_map_and_the_whole_path(
    run: tuple[Path, Episode, int],
) -> None:
    file, episode, _ = run
    frame = frames_of(file)[-1]
    last_map = coarse_map(episode.grid, episode.grid.resolution)
    canvas = MapCanvas(last_map)
    states = canvas.states(last_map)
    shown = frame[: len(states)]
    drawn_over = np.logical_or.reduce([has(shown, colour) for colour in COLOURS[3:]])
    assert drawn_over.mean() < 0.05
    for state, colour in (
        (OCCUPIED, OCCUPIED_COLOUR),
        (FREE, FREE_COLOUR),
        (UNKNOWN, UNKNOWN_COLOUR),
    ):
        seen = (states == state) & ~drawn_over
        assert has(shown, colour)[seen].mean() > 0.98, "but for the rims of marks"
    path = np.floor(canvas.pixels(episode.trajectory.poses[:, :2])).astype(int)
    on_path = has(shown, PATH_COLOUR) | has(shown, OCCUPIED_COLOUR)
    assert on_path[path[:, 1], path[:, 0]].mean() > 0.95


def test_the_map_grows_and_people_are_shown_where_they_walk(
    run: tuple[Path, Episode, int],
) -> None:
    frames = frames_of(run[0])
    unknown = [np.count_nonzero(has(frame, UNKNOWN_COLOUR)) for frame in frames]
    assert unknown[-1] < unknown[0]
    assert all(has(frame, PEOPLE_COLOUR).any() for frame in frames[:-1])
    assert has(frames[3], SCAN_COLOUR).any()
    assert not np.array_equal(has(frames[2], PEOPLE_COLOUR), has(frames[5], PEOPLE_COLOUR))


def test_the_same_seed_gives_the_same_bytes(run: tuple[Path, Episode, int], tmp_path: Path) -> None:
    animated(CONFIG, tmp_path / "again.gif")
    assert (tmp_path / "again.gif").read_bytes() == run[0].read_bytes()


def test_a_long_episode_has_fewer_frames_to_the_second(tmp_path: Path) -> None:
    with patch("evaluation.animation.animation.MOST_FRAMES", 4):
        _, told = animated(CONFIG, tmp_path / "a.gif")
    assert told > 8
    assert len(frames_of(tmp_path / "a.gif")) == -(-told // 4) + 1, "every fourth, and the end"


def test_an_episode_that_ended_before_anything_was_told_shows_its_end(tmp_path: Path) -> None:
    episode = run_episode(replace(CONFIG, time_limit=1.0), plan=TINY_ROOM)
    Animation().write(tmp_path / "a.gif", episode)
    assert len(frames_of(tmp_path / "a.gif")) == 1


def test_a_run_folder_keeps_no_animation_of_an_earlier_run(tmp_path: Path) -> None:
    animation = Animation()
    episode = run_episode(replace(CONFIG, time_limit=2.0), animation.note, plan=TINY_ROOM)
    write_run(episode, tmp_path, animation)
    assert len(frames_of(tmp_path / "episode.gif")) >= 3
    write_run(episode, tmp_path)
    assert not (tmp_path / "episode.gif").exists()


def test_the_ends_of_a_scan_lie_on_walls_though_the_robot_moves_and_turns() -> None:
    faces = np.array([[0.05, 0.05], [3.95, 2.95]])  # of walls 0.1 m thick
    gaps: list[float] = []

    def measure(progress: Progress) -> None:
        assert progress.observation is not None
        ends = scan_ends(progress.observation, progress.pose_map)
        to_walls = np.abs(ends[:, None, :] - faces).min(axis=(1, 2))
        to_pillar = np.abs(np.hypot(*(ends - (2.0, 1.2)).T) - 0.3)
        gaps.extend(np.minimum(to_walls, to_pillar).tolist())

    config = replace(CONFIG, people=0, odometry="truth", lidar="ideal")
    run_episode(config, measure, plan=TINY_ROOM)
    assert len(gaps) > 1000
    # 0.3 s of extrapolated way leave some centimetres while the robot speeds up or turns in
    assert np.percentile(gaps, 90) < 0.03
    assert max(gaps) < 0.3

"""Runs that are recorded, and what can be read back of them."""

import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import gymnasium
import numpy as np
import pytest
from mcap.reader import make_reader

from evaluation.episode import EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.progress import Progress
from evaluation.recorder import Recorder
from mapping.errors import TestbedError
from mapping.geometry import compose
from mapping.io.ros_library import message_types
from mapping.io.rosbag_reader import read_rosbag
from mapping.io.sensor_log_file import read_log
from mapping.mappers import make_mapper
from mapping.messages import Imu, LaserScan, Odometry
from mapping.sensor_log import SensorLog

CONFIG = EpisodeConfig(world="tiny_room", seed=3, time_limit=12.0, odometry="poor")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    write_run(run_episode(CONFIG, plan=TINY_ROOM, recorder=Recorder()), folder)
    return folder


def driven_anew(folder: Path) -> SensorLog:
    """The messages of the same run, from an environment that is given the recorded commands."""
    environment = gymnasium.make(
        "envs:TurtleBot3Burger-v0", world=TINY_ROOM, odometry="poor", odometry_yaw="imu"
    )
    observations = [environment.reset(seed=CONFIG.seed)[0]]
    for _, command in bag_messages(folder, "/cmd_vel")[:-1]:
        action = np.array([command.linear.x, command.angular.z], dtype=np.float32)
        observations.append(environment.step(action)[0])
    environment.close()
    scans = [LaserScan.from_observation(each) for each in observations]
    return SensorLog(
        source="environment",
        scans=[
            a for a, b in zip(scans, [None, *scans], strict=False) if not b or a.stamp != b.stamp
        ],
        odometry=[m for each in observations for m in Odometry.from_observation(each)],
        imu=[m for each in observations for m in Imu.from_observation(each)],
    )


def bag_messages(folder: Path, topic: str) -> list[tuple[float, object]]:
    """When each message of a topic was logged [s], and the message."""
    types = message_types()
    with (folder / "bag" / "bag.mcap").open("rb") as file:
        return [
            (message.log_time / 1e9, types.deserialize_cdr(message.data, schema.name))
            for schema, _, message in make_reader(file).iter_messages(topics=[topic])
        ]


def test_the_logs_hold_every_message_that_the_robot_sent(recorded: Path) -> None:
    sent = driven_anew(recorded)
    for log in (read_log(recorded), read_rosbag(recorded / "bag")):
        assert len(log.scans) == len(sent.scans) >= 55
        for before, after in zip(sent.scans, log.scans, strict=True):
            assert np.array_equal(before.ranges, after.ranges)
            assert after.beam_stamps == pytest.approx(before.beam_stamps, abs=1e-6)
            assert after.angles == pytest.approx(before.angles, abs=1e-6)
        assert [m.stamp for m in log.odometry] == pytest.approx([m.stamp for m in sent.odometry])
        assert np.allclose(
            [m.pose_odom for m in log.odometry], [m.pose_odom for m in sent.odometry], atol=1e-12
        )
        assert np.array_equal(
            [m.angular_velocity for m in log.imu], [m.angular_velocity for m in sent.imu]
        )
        assert log.lidar_pose_base == pytest.approx((-0.032, 0.0, 0.0))


def test_mapping_the_log_draws_the_map_that_was_drawn_on_the_way() -> None:
    recorder = Recorder()
    episode = run_episode(replace(CONFIG, mapper="ogm"), plan=TINY_ROOM, recorder=recorder)
    log = recorder.run(episode.grid, "run").log
    mapper = make_mapper("ogm", start_pose_map=TINY_ROOM.start)
    for scan, odometry, imu in log.periods():
        mapper.update(scan, odometry, imu)
    states, drawn = mapper.grid.states(), episode.grid.states()
    assert mapper.grid.extent == episode.grid.extent
    differing = np.count_nonzero(states != drawn) / np.count_nonzero(drawn != -1)
    assert differing < 0.005, "a replay has the odometry after a scan's end, the run had not yet"


def test_the_frames_of_the_bag_lead_to_the_pose_that_the_mapper_had(recorded: Path) -> None:
    odometry = {message.stamp: message.pose_odom for message in read_log(recorded).odometry}
    believed = []
    for _, message in bag_messages(recorded, "/tf"):
        link = message.transforms[0]
        if link.header.frame_id == "map":
            stamp = link.header.stamp.sec + link.header.stamp.nanosec * 1e-9
            pose_odom = odometry[min(odometry, key=lambda known: abs(known - stamp))]
            turn, shift = link.transform.rotation, link.transform.translation
            yaw = 2.0 * np.arctan2(turn.z, turn.w)
            believed.append(compose((shift.x, shift.y, yaw), pose_odom))
    (first, *_) = believed
    assert first == pytest.approx(TINY_ROOM.start, abs=0.02), "it stands where it started"
    rows = np.loadtxt(recorded / "trajectory.tum")
    last = rows[-1, 1:3]
    assert np.hypot(*(believed[-1][:2] - last)) < 0.22 * 0.4, "at most 0.4 s of driving apart"


def test_the_map_grows_in_the_bag_and_is_whole_in_the_end(recorded: Path) -> None:
    maps = bag_messages(recorded, "/map")
    assert [when for when, _ in maps] == pytest.approx([0.2, 5.2, 10.2, 12.2], abs=0.11)
    known = [np.count_nonzero(np.array(drawn.data) >= 0) for _, drawn in maps]
    assert known[0] < known[2]
    resolutions = [drawn.info.resolution for _, drawn in maps]
    assert resolutions == pytest.approx([0.05, 0.05, 0.05, 0.01])


def test_a_recorded_run_writes_the_same_bytes_again_and_the_same_result(
    recorded: Path, tmp_path: Path
) -> None:
    write_run(run_episode(CONFIG, plan=TINY_ROOM, recorder=Recorder()), tmp_path / "again")
    for file in ("log.carmen", "bag/bag.mcap", "bag/metadata.yaml", "map.pgm"):
        assert (tmp_path / "again" / file).read_bytes() == (recorded / file).read_bytes(), file
    write_run(run_episode(CONFIG, plan=TINY_ROOM), tmp_path / "plain")
    assert (tmp_path / "plain" / "map.pgm").read_bytes() == (recorded / "map.pgm").read_bytes()


def test_ctrl_c_keeps_what_was_recorded(tmp_path: Path) -> None:
    def stop(progress: Progress) -> None:
        if progress.time > 3.0:
            raise KeyboardInterrupt

    episode = run_episode(CONFIG, stop, plan=TINY_ROOM, recorder=Recorder())
    write_run(episode, tmp_path)
    log = read_log(tmp_path)
    assert len(log.odometry) == 3 * len(episode.track)


def test_a_run_that_is_not_recorded_takes_an_earlier_recording_away(tmp_path: Path) -> None:
    short = EpisodeConfig(world="tiny_room", time_limit=1.0)
    write_run(run_episode(short, plan=TINY_ROOM, recorder=Recorder()), tmp_path)
    assert (tmp_path / "log.carmen").exists()
    write_run(run_episode(short, plan=TINY_ROOM), tmp_path)
    assert not (tmp_path / "log.carmen").exists()
    assert not (tmp_path / "bag").exists()


def test_a_recording_that_cannot_be_written_leaves_no_result(tmp_path: Path) -> None:
    short = EpisodeConfig(world="tiny_room", time_limit=1.0)
    episode = run_episode(short, plan=TINY_ROOM, recorder=Recorder())
    broken = patch("evaluation.recorder.write_rosbag", side_effect=TestbedError("disk full"))
    with broken, pytest.raises(TestbedError):
        write_run(episode, tmp_path)
    assert not (tmp_path / "result.json").exists()


def test_without_the_library_the_run_is_refused_before_it_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(TestbedError, match=r"pip install 'burger-testbed\[ros\]'"):
        Recorder()

"""Frames that are linked to frames."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mapping.io.ros_frames import FrameTree, transform, yaw_of

PARTS = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 1e-3)


@given(PARTS)
def test_a_quaternion_of_any_length_turns_as_scipy_says(quaternion: tuple[float, ...]) -> None:
    matrix = transform((1.0, 2.0, 3.0), quaternion)
    assert matrix[:3, :3] == pytest.approx(Rotation.from_quat(quaternion).as_matrix(), abs=1e-12)
    assert matrix[:, 3].tolist() == [1.0, 2.0, 3.0, 1.0]


def test_a_quaternion_of_zeros_does_not_turn() -> None:
    assert np.array_equal(transform((0, 0, 0), (0, 0, 0, 0)), np.eye(4))


def test_a_frame_is_found_up_and_down_the_tree() -> None:
    quarter = (0.0, 0.0, np.sin(np.pi / 4), np.cos(np.pi / 4))
    tree = FrameTree()
    tree.add("trunk", "left", (1.0, 0.0, 0.0), quarter)
    tree.add("trunk", "right", (0.0, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    pose = tree.find("right", ["left"])
    assert pose is not None
    assert pose[:2, 3] == pytest.approx([2.0, 1.0]), "2 ahead of and 1 beside what looks north"
    assert yaw_of(pose) == pytest.approx(-np.pi / 2)


def test_a_base_behind_a_namespace_counts_after_the_plain_one() -> None:
    tree = FrameTree()
    tree.add("robot/base_link", "/laser", (3.0, 0.0, 0.0), (0, 0, 0, 1))
    found = tree.find("laser", ["base_footprint", "base_link"])
    assert found is not None
    assert found[0, 3] == 3.0
    tree.add("base_link", "laser", (4.0, 0.0, 0.0), (0, 0, 0, 1))
    found = tree.find("laser", ["base_footprint", "base_link"])
    assert found is not None
    assert found[0, 3] == 4.0


def test_frames_without_a_link_are_not_found() -> None:
    tree = FrameTree()
    tree.add("odom", "base_link", (0, 0, 0), (0, 0, 0, 1))
    assert tree.find("laser", ["base_link"]) is None

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.slam.particle_paths import FIRST_NODES, ParticlePaths


@given(seed=st.integers(0, 10_000), particles=st.integers(1, 40), steps=st.integers(1, 400))
@settings(max_examples=20, deadline=None)
def test_shared_paths_equal_paths_that_share_nothing(seed: int, particles: int, steps: int) -> None:
    rng = np.random.default_rng(seed)
    poses = rng.random((particles, 3))
    paths, slow = ParticlePaths(poses), [[pose] for pose in poses]
    for _ in range(steps):
        if rng.random() < 0.2:
            parents = rng.integers(0, particles, particles)
            paths.resample(parents)
            slow = [list(slow[parent]) for parent in parents]
        poses = rng.random((particles, 3))
        paths.extend(poses)
        for path, pose in zip(slow, poses, strict=True):
            path.append(pose)
    assert paths.steps == steps + 1
    assert np.array_equal(paths.newest, poses)
    for particle in range(particles):
        assert np.array_equal(paths.path(particle), slow[particle])


def test_a_long_run_holds_little_more_than_one_pose_a_step() -> None:
    rng = np.random.default_rng(0)
    paths = ParticlePaths(np.zeros((30, 3)))
    for step in range(3000):
        if step % 5 == 0:
            paths.resample(np.sort(rng.integers(0, 30, 30)))
        paths.extend(rng.random((30, 3)))
    # the common past, and at worst half a store of what has not been forgotten yet
    assert 3000 <= paths.nodes <= 3000 + 2 * FIRST_NODES

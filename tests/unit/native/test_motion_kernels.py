"""The kernels of motion compute the bytes of their definition in plain NumPy."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros.native import motion_kernels
from sailenv_ros.native.library import load_library, using_instruction_set
from tests.support import reference_motion as reference

SIZES = [(8, 8), (9, 13), (61, 300)]


@pytest.fixture(params=load_library().instruction_sets)
def instruction_set(request: pytest.FixtureRequest) -> Iterator[str]:
    """Let kernels run on one of the instruction sets."""
    with using_instruction_set(request.param):
        yield request.param


def views(rng: np.random.Generator, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Patches of some ids at slanted depths, with background and what is too near."""
    down, along = -(-height // 7), -(-width // 11)
    ids = np.repeat(np.repeat(rng.integers(0, 9, (down, along)), 7, 0), 11, 1)[:height, :width]
    ids[rng.random(ids.shape) < 0.05] = 60000
    depth = 0.5 + 0.15 * (ids % 4) + 0.01 * np.arange(width) + rng.random((height, 1))
    depth[ids == 0] = np.inf
    depth[rng.random(ids.shape) < 0.02] = np.nan
    return depth.astype(np.float32), ids.astype(np.uint16)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("lens", ["same", "other"])
@pytest.mark.usefixtures("instruction_set")
def test_motions_are_those_of_the_definition(size: tuple[int, int], lens: str) -> None:
    """All arrays, bit by bit, on any number of threads; everything happens in the picture."""
    rng = np.random.default_rng(size)
    begin, end = views(rng, *size), views(rng, *(size if lens == "same" else (31, 47)))
    rows = np.zeros(65536, np.uint16)
    rows[:8] = np.arange(1, 9)
    rows[7] = 60000  # beyond the motions
    motions, displacements = rng.normal(0.0, 0.05, (2, 9, 3, 4))
    motions[::3] = 0.0
    motions[8, 2, 3] = -20.0  # goes behind the camera
    motions[0] = np.nan  # of what has no motion: must not be looked at
    one = np.array([size[1] / 1.2, (size[1] - 1) / 2, (size[0] - 1) / 2, 0.05, 60.0])
    other = one if lens == "same" else np.array([40.0, 23.0, 15.0, 0.7, 2.0])
    given = (*begin, rows, motions, displacements, one, other, *end, 0.01)
    expected = reference.move_points(*given, threads=1)
    for name in ("valid", "occluded", "out_of_view"):
        found = getattr(expected, name)
        if size[0] > 60:
            assert found.any(), name
            assert not found.all(), name
    for threads in (1, 2, 5):
        got = motion_kernels.move_points(*given, threads=threads)
        for name, array in got._asdict().items():
            assert array.tobytes() == getattr(expected, name).tobytes(), name


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.usefixtures("instruction_set")
def test_transformed_points_are_those_of_the_definition(size: tuple[int, int]) -> None:
    """Bit by bit, also where there is no point."""
    rng = np.random.default_rng(size)
    rows = np.zeros(65536, np.uint16)
    rows[1:8] = np.arange(1, 8)
    rows[7] = 60000
    lens = np.array([30.0, 3.5, 4.5, 0.05, 60.0])
    given = (*views(rng, *size), rows, rng.normal(0.0, 3.0, (8, 3, 4)), lens)
    expected = reference.transform_points(*given, threads=1)
    assert np.isfinite(expected).any()
    for threads in (1, 3):
        got = motion_kernels.transform_points(*given, threads=threads)
        assert got.tobytes() == expected.tobytes()

"""The kernels of motion compute the bytes of their definition in plain NumPy."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.native import motion_kernels
from sailenv_ros.native.lens import LENS
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.native.motion_kernels import MOTION_OUTPUTS
from sailenv_ros.native.records import RecordKernel
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


def lens_of(height: int, width: int, near_m: float = 0.05, far_m: float = 60.0) -> np.ndarray:
    numbers = (width / 1.2, width / 1.2, (width - 1) / 2, (height - 1) / 2, near_m, far_m)
    return np.array([numbers], LENS)


def empty(height: int, width: int) -> dict[str, np.ndarray]:
    return {
        name: np.empty((height, width, *channels), dtype)
        for name, (dtype, channels) in MOTION_OUTPUTS.items()
    }


def motion_input(rng: np.random.Generator, size: tuple[int, int], lens: str) -> list:
    """What `move_points` takes but the outputs; everything happens in the picture."""
    other_size = size if lens == "same" else (31, 47)
    begin, end = views(rng, *size), views(rng, *other_size)
    rows = np.zeros(65536, np.uint16)
    rows[:8] = np.arange(1, 9)
    rows[7] = 60000  # beyond the motions
    motions, displacements = rng.normal(0.0, 0.05, (2, 9, 3, 4))
    motions[::3] = 0.0
    motions[8, 2, 3] = -20.0  # goes behind the camera
    motions[0] = np.nan  # of what has no motion: must not be looked at
    one = lens_of(*size)
    other = one if lens == "same" else np.array([(40.0, 40.0, 23.0, 15.0, 0.7, 2.0)], LENS)
    return [*begin, rows, motions, displacements, one, other, *end, 0.01]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("lens", ["same", "other"])
@pytest.mark.parametrize("seen_by", ["instance", "depth", "nothing"])
@pytest.mark.parametrize("duration_s", [1.0, -1.0 / 30.0])
@pytest.mark.usefixtures("instruction_set")
def test_motions_are_those_of_the_definition(
    size: tuple[int, int], lens: str, seen_by: str, duration_s: float
) -> None:
    """All arrays, bit by bit, on any number of threads; and each of them alone."""
    given = motion_input(np.random.default_rng(size), size, lens)
    if seen_by != "instance":
        given[8] = None
    if seen_by == "nothing":
        given[7] = None
    expected = empty(*size)
    reference.move_points(*given, expected, duration_s=duration_s, threads=1)
    if size[0] > 60:
        for name in ("valid", "occluded", "out_of_view", "hidden"):
            found = expected[name]
            if seen_by != "nothing" or name == "valid":
                assert found.any(), name
                assert not found.all(), name
    for threads in (1, 2, 5):
        got = empty(*size)
        motion_kernels.move_points(*given, got, duration_s=duration_s, threads=threads)
        for name, array in got.items():
            assert array.tobytes() == expected[name].tobytes(), name
    for name in expected:
        one = {name: empty(*size)[name]}
        motion_kernels.move_points(*given, one, duration_s=duration_s, threads=2)
        assert one[name].tobytes() == expected[name].tobytes(), name


def test_without_another_picture_everything_is_hidden() -> None:
    """And flow is what it is."""
    given = motion_input(np.random.default_rng(3), (40, 60), "same")
    given[7] = given[8] = None
    found = empty(40, 60)
    motion_kernels.move_points(*given, found, threads=2)
    assert found["hidden"].all()
    assert not found["occluded"].any()
    assert np.isfinite(found["flow"][found["valid"]]).all()


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.usefixtures("instruction_set")
def test_transformed_points_are_those_of_the_definition(size: tuple[int, int]) -> None:
    """Bit by bit, also where there is no point."""
    rng = np.random.default_rng(size)
    rows = np.zeros(65536, np.uint16)
    rows[1:8] = np.arange(1, 8)
    rows[7] = 60000
    given = (*views(rng, *size), rows, rng.normal(0.0, 3.0, (8, 3, 4)), lens_of(8, 10))
    expected = reference.transform_points(*given, threads=1)
    assert np.isfinite(expected).any()
    for threads in (1, 3):
        got = motion_kernels.transform_points(*given, threads=threads)
        assert got.tobytes() == expected.tobytes()


def test_a_lens_is_read_as_it_was_written() -> None:
    """Each number from its own place: the ray of every pixel, with two focal lengths.

    Where rays are parallel, places are those of depth 1 at any depth.
    """
    lens = np.array([(40.0, 25.0, 3.5, 2.25, 0.05, 60.0)], LENS)
    rows = np.ones(65536, np.uint16)
    depth, ids = np.ones((6, 9), np.float32), np.zeros((6, 9), np.uint16)
    found = motion_kernels.transform_points(
        depth, ids, rows, np.stack([np.eye(4)[:3]] * 2), lens, threads=1
    )
    v, u = np.mgrid[:6, :9].astype(np.float64)
    expected = np.stack([(u - 3.5) / 40.0, (v - 2.25) / 25.0, np.ones_like(u)], axis=-1)
    np.testing.assert_array_equal(found, expected.astype(np.float32))
    found = motion_kernels.transform_points(
        *(3.0 * depth, ids, rows, np.stack([np.eye(4)[:3]] * 2), lens), parallel=True, threads=1
    )
    expected[..., 2] = 3.0
    np.testing.assert_array_equal(found, expected.astype(np.float32))


def test_a_structure_that_differs_is_refused_by_name() -> None:
    """A field too few, or two in each other's place: both layouts stand in the error."""
    arrays = "depth instance row_of_instance transforms"
    wrong = RecordKernel(
        *("transform_points", ("integer", "height width"), ("array", arrays), ("integer", "rows")),
        ("array", "lens points"),
    )
    values = dict.fromkeys([*arrays.split(), "lens", "points"])
    with pytest.raises(NativeLibraryError, match=r"arguments of transform_points"):
        wrong(1, height=0, width=0, rows=1, **values)

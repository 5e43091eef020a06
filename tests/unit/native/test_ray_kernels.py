"""Rays meet the same triangles with the tree in C++ as without one in plain NumPy, bit by bit."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, NativeLibraryError
from sailenv_ros.native import ray_kernels
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.native.ray_kernels import RayModels, TriangleTree
from tests.support import reference_rays as reference


@pytest.fixture(params=load_library().instruction_sets)
def instruction_set(request: pytest.FixtureRequest) -> Iterator[str]:
    """Let kernels run on one of the instruction sets."""
    with using_instruction_set(request.param):
        yield request.param


def models_of(*corners: np.ndarray, two_sided: np.ndarray | None = None) -> RayModels:
    trees = [ray_kernels.build_tree(part) for part in corners]
    count = sum(map(len, corners))
    return RayModels(
        corners=np.concatenate(corners),
        two_sided=np.zeros(count, bool) if two_sided is None else two_sided,
        first_triangle=np.array([0, *accumulate(map(len, corners))], np.int64),
        first_node=np.array([0, *accumulate(len(tree.bounds) for tree in trees)], np.int64),
        tree=TriangleTree(*(np.concatenate(arrays) for arrays in zip(*trees, strict=True))),
    )


@pytest.mark.usefixtures("instruction_set")
def test_rays_meet_what_they_meet_without_a_tree() -> None:
    """Soups of triangles, some in one plane and some twice, turned, scaled, mirrored, in rows."""
    rng = np.random.default_rng(5)
    soup = rng.normal(size=(150, 1, 3)) + 0.4 * rng.normal(size=(150, 3, 3))
    flat = rng.integers(-3, 4, (60, 3, 3)).astype(np.float64)
    flat[:, :, 2] = 1.0
    flat[30:40] = flat[20:30]
    models = models_of(soup, np.zeros((0, 3, 3)), flat, two_sided=rng.random(210) < 0.3)
    transforms = rng.normal(size=(5, 3, 4))
    transforms[3] = np.eye(4)[:3]
    numbers = np.array([0, 2, 1, 2, 0], np.int32)
    origins = rng.normal(scale=3.0, size=(400, 3))
    origins[:50] = np.round(origins[:50])
    directions = -origins + rng.normal(size=(400, 3))
    directions[:50] = [0.0, 0.0, 1.0]
    nearest = np.zeros(400)
    nearest[::7] = 1.0
    given = (models, transforms, numbers, origins, directions, nearest)
    expected = reference.cast_rays(*given, threads=1)
    assert 50 < np.isfinite(expected.distance).sum() < 400
    assert set(expected.instance.tolist()) == {-1, 0, 1, 3, 4}
    for threads in (1, 3):
        got = ray_kernels.cast_rays(*given, threads=threads)
        for name, array in got._asdict().items():
            assert array.tobytes() == getattr(expected, name).tobytes(), name


def test_a_tree_holds_every_triangle_once_in_boxes_around_them() -> None:
    """Also of equal triangles, of one and of none."""
    rng = np.random.default_rng(1)
    for corners in (rng.normal(size=(999, 3, 3)), np.ones((77, 3, 3)), np.ones((1, 3, 3))):
        tree = ray_kernels.build_tree(corners)
        assert sorted(tree.order) == list(range(len(corners)))
        seen = []
        waiting = [0]
        while waiting:
            node = waiting.pop()
            first, count = tree.children[node]
            if not count:
                waiting += [first, first + 1]
                continue
            held = corners[tree.order[first : first + count]].reshape(-1, 3)
            assert (held >= tree.bounds[node, :3]).all()
            assert (held <= tree.bounds[node, 3:]).all()
            seen += tree.order[first : first + count].tolist()
        assert sorted(seen) == list(range(len(corners)))
    assert len(ray_kernels.build_tree(np.zeros((0, 3, 3))).order) == 0


def test_what_no_ray_can_be_cast_at_is_refused() -> None:
    """Corners that are no numbers, instances of models that there are not."""
    with pytest.raises(NativeLibraryError, match="refused"):
        ray_kernels.build_tree(np.full((2, 3, 3), np.nan))
    models = models_of(np.ones((2, 3, 3)))
    ray = (np.zeros((1, 3)), np.ones((1, 3)), np.zeros(1))
    with pytest.raises(InvalidRequest, match="numbers of models"):
        ray_kernels.cast_rays(
            *(models, np.zeros((1, 3, 4)), np.array([1], np.int32), *ray),
            threads=1,
        )

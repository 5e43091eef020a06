"""Rays meet the same triangles with the tree in C++ as without one in plain NumPy.

Rays of ground truth bit by bit, rays of light as far as floats go.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, NativeLibraryError
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.native.ray_kernels import (
    BoxTree,
    RayHits,
    build_tree,
    cast_rays,
    light_hits,
    light_share,
)
from sailenv_ros.rays.triangle_tree import TriangleTree, in_leaves, triangle_tree
from tests.support import reference_rays

Models = list[tuple[np.ndarray, np.ndarray]]


@pytest.fixture(params=load_library().instruction_sets)
def instruction_set(request: pytest.FixtureRequest) -> Iterator[str]:
    """Let kernels run on one of the instruction sets."""
    with using_instruction_set(request.param):
        yield request.param


def cast(
    models: Models,
    model_from_world: np.ndarray,
    numbers: np.ndarray,
    *rays: np.ndarray,
    threads: int = 1,
) -> RayHits:
    """Build the trees, and cast the rays at them."""
    trees = [triangle_tree(corners, sides) for corners, sides in models]
    shapes = np.concatenate([tree.record for tree in trees])
    shapes["first_triangle"] = np.cumsum([0, *(len(corners) for corners, _ in models)])[:-1]
    boxes = [box_of(trees[n], m) for n, m in zip(numbers, model_from_world, strict=True)]
    over = build_tree(np.array(boxes).reshape(-1, 6), 1)
    return cast_rays(shapes, (over, model_from_world, numbers), *rays, threads=threads)


def box_of(tree: TriangleTree, model_from_world: np.ndarray) -> np.ndarray:
    """Return a box around a model in the world."""
    corners = (
        np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
        * (tree.high - tree.low)
        + tree.low
    )
    inverse = np.linalg.inv(np.vstack([model_from_world, [0.0, 0.0, 0.0, 1.0]]))
    world = corners @ inverse[:3, :3].T + inverse[:3, 3]
    return np.concatenate([world.min(axis=0) - 1e-6, world.max(axis=0) + 1e-6])


@pytest.mark.usefixtures("instruction_set")
@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_rays_meet_what_they_meet_without_a_tree(scale: float) -> None:
    """Soups of triangles, some in one plane and some twice, turned, scaled, mirrored, in rows."""
    rng = np.random.default_rng(5)
    soup = scale * (rng.normal(size=(150, 1, 3)) + 0.4 * rng.normal(size=(150, 3, 3)))
    flat = scale * rng.integers(-3, 4, (60, 3, 3)).astype(np.float64)
    flat[:, :, 2] = scale
    flat[30:40] = flat[20:30]
    models: Models = [
        (corners, rng.random(len(corners)) < 0.3) for corners in (soup, np.zeros((0, 3, 3)), flat)
    ]
    transforms = rng.normal(size=(5, 3, 4))
    transforms[3] = np.eye(4)[:3]
    transforms[:, :, 3] *= scale
    numbers = np.array([0, 2, 1, 2, 0], np.int32)
    origins = rng.normal(scale=3.0, size=(400, 3))
    origins[:50] = np.round(origins[:50])
    directions = -origins + rng.normal(size=(400, 3))
    directions[:50] = [0.0, 0.0, 1.0]
    origins *= scale
    directions[::3] *= scale
    nearest = np.zeros(400)
    nearest[::7] = 1.0
    given = (models, transforms, numbers, origins, directions, nearest)
    expected = reference_rays.cast_rays(*given)
    assert 50 < np.isfinite(expected.distance).sum() < 400
    assert set(expected.instance.tolist()) == {-1, 0, 1, 3, 4}
    for threads in (1, 3):
        got = cast(*given, threads=threads)
        for name, array in got._asdict().items():
            assert array.tobytes() == getattr(expected, name).tobytes(), name


@pytest.mark.usefixtures("instruction_set")
def test_rays_from_far_away_meet_the_edges_of_tiny_things() -> None:
    """A thousand squares of 1 cm, 10 km away, hit in corners, on edges and in the middle."""
    places = np.stack(np.meshgrid(*(np.arange(10.0),) * 3), axis=-1).reshape(-1, 1, 3)
    square = 0.01 * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]])
    corners = places + square
    models: Models = [(corners, np.ones(len(corners), np.bool_))]
    spots = np.array([[1, 0, 0], [0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]]) / np.array(
        [[1], [1], [2], [3], [2]]
    )
    points = np.einsum("sc,tcx->tsx", spots, corners).reshape(-1, 3)[::7]
    origins = points + np.array([3000.0, 4000.0, 8660.0])
    given = (models, np.eye(4)[None, :3], np.zeros(1, np.int32))
    rays = origins, points - origins, np.zeros(len(points))
    expected = reference_rays.cast_rays(*given, *rays)
    assert np.isfinite(expected.distance).mean() > 0.5
    got = cast(*given, *rays)
    for name, array in got._asdict().items():
        assert array.tobytes() == getattr(expected, name).tobytes(), name


@pytest.mark.usefixtures("instruction_set")
def test_rays_of_light_meet_the_same() -> None:
    """The same triangle at the same distance, but for what floats cannot tell."""
    rng = np.random.default_rng(6)
    corners = (rng.normal(size=(400, 1, 3)) + 0.3 * rng.normal(size=(400, 3, 3))).astype(np.float32)
    origins = rng.normal(scale=3.0, size=(2000, 3)).astype(np.float32)
    directions = (-origins + rng.normal(size=(2000, 3))).astype(np.float32)
    directions[:200] = np.eye(3)[rng.integers(0, 3, 200)]
    models: Models = [(corners.astype(np.float64), np.ones(400, np.bool_))]
    alone = np.eye(4)[None, :3], np.zeros(1, np.int32)
    rays = origins.astype(np.float64), directions.astype(np.float64), np.zeros(2000)
    expected = reference_rays.cast_rays(models, *alone, *rays)
    tree = triangle_tree(corners)
    got = light_hits(tree.record, origins, directions, threads=2)
    same = got.triangle == expected.triangle
    assert same.mean() > 0.998
    met = same & (got.triangle >= 0)
    assert met.sum() > 1000
    assert got.distance[met] == pytest.approx(expected.distance[met], rel=1e-4, abs=1e-5)
    weights = np.stack([got.second, got.third], axis=-1)
    assert weights[met] == pytest.approx(expected.weights[met], abs=1e-3)
    assert (got.distance[got.triangle < 0] == np.float32(1e30)).all()
    panes = rng.choice(400, 80, replace=False)
    solid, glass = np.delete(corners, panes, axis=0), corners[panes]
    clear = rng.random(80).astype(np.float32)
    lengths = rng.uniform(0.2, 3.0, 2000).astype(np.float32)
    shares = expected_share(solid, glass, clear, rays, lengths)
    of_solid, of_glass = triangle_tree(solid), triangle_tree(glass)
    glazing = of_glass.record, in_leaves(clear, of_glass.order)
    share = light_share(of_solid.record, glazing, origins, directions, lengths, threads=2)
    assert (np.abs(share - shares) < 1e-3).mean() > 0.998
    assert 0.2 < np.mean(shares == 0.0) < 0.8
    assert np.mean((shares > 0.0) & (shares < 1.0)) > 0.02


def expected_share(
    solid: np.ndarray,
    glass: np.ndarray,
    clear: np.ndarray,
    rays: tuple[np.ndarray, ...],
    lengths: np.ndarray,
) -> np.ndarray:
    """Return what is let through, by plain arithmetic."""
    alone = np.eye(4)[None, :3], np.zeros(1, np.int32)
    blocked, pane = (
        reference_rays.cast_rays([(one.astype(float), np.ones(len(one), np.bool_))], *alone, *rays)
        for one in (solid, glass)
    )
    share = np.ones(len(lengths))
    edges = glass[:, 1:].astype(float) - glass[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])[pane.triangle]
    sizes = np.linalg.norm(normals, axis=1) * np.linalg.norm(rays[1], axis=1)
    cosine = np.abs(np.einsum("ri,ri->r", normals, rays[1])) / sizes
    near = pane.distance < lengths
    share[near] = (clear[pane.triangle] * reference_rays.glazing_transmittance(cosine))[near]
    share[blocked.distance < lengths] = 0.0
    return share


@pytest.mark.parametrize("leaf", [1, 3, 8])
def test_a_tree_holds_every_box_once(leaf: int) -> None:
    """Also of boxes in one place; each box lies in its leaf's box and in all above it."""
    rng = np.random.default_rng(0)
    low = rng.uniform(-1, 1, (500, 3))
    boxes = np.concatenate([low, low + rng.uniform(0, 0.2, (500, 3))], axis=1)
    boxes[100:300] = boxes[100]
    for some in (boxes, boxes[:1], boxes[100:300]):
        tree = build_tree(np.ascontiguousarray(some), leaf)
        assert sorted(tree.order[tree.order >= 0]) == list(range(len(some)))
        assert sorted(held_below(tree, some, 0)) == list(range(len(some)))
    assert build_tree(np.zeros((0, 6)), leaf).order.shape == (0, leaf)


def held_below(tree: BoxTree, boxes: np.ndarray, number: int) -> list[int]:
    """Return what a node holds, each in the box that the node has for it."""
    held: list[int] = []
    node = tree.nodes[number]
    for lane, child in enumerate(node["children"]):
        if child == 0:
            continue
        own = tree.order[~child] if child < 0 else np.array(held_below(tree, boxes, child))
        own = own[own >= 0]
        assert (boxes[own, :3] >= node["planes"][:3, lane]).all()
        assert (boxes[own, 3:] <= node["planes"][3:, lane]).all()
        held += own.tolist()
    return held


def test_what_no_ray_can_be_cast_at_is_refused() -> None:
    """Corners that are no numbers, instances of models that there are not."""
    with pytest.raises(NativeLibraryError, match="refused"):
        triangle_tree(np.full((2, 3, 3), np.nan))
    tree = triangle_tree(np.ones((2, 3, 3)))
    over = build_tree(np.zeros((1, 6)), 1)
    ray = (np.zeros((1, 3)), np.ones((1, 3)), np.zeros(1))
    instances = over, np.zeros((1, 3, 4)), np.array([1], np.int32)
    with pytest.raises(InvalidRequest, match="numbers of models"):
        cast_rays(tree.record, instances, *ray, threads=1)

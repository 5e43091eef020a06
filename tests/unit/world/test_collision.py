"""Compounds of collision shapes: each lies where it should, hulls and turned boxes too."""

from __future__ import annotations

import gc
import math
import sys
import tempfile
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    SphereShape,
    TriangleShape,
)
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.collision import build_collision, hull_files
from tests.support.allocator import allocations

SLAB = BoxShape(half_extents_m=(2.0, 2.0, 0.1), centre_m=(0.0, 0.0, -0.1))
PYRAMID = ConvexShape(
    points=np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 1]], float)
)
EIGHTH = (0.0, 0.0, math.sin(math.radians(22.5)), math.cos(math.radians(22.5)))


def _hits(
    shapes: list[CollisionShape],
    rays: list[tuple[float, float]],
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> list[float]:
    """Heights at which rays straight down meet a body of the shapes; NaN for none."""
    client = BulletClient()
    try:
        with hull_files(client) as files:
            shape = build_collision(
                files, shapes, scale=scale, centre_of_mass_m=(0.0, 0.0, 0.0), name="body"
            )
            client.createMultiBody(baseMass=0.0, baseCollisionShapeIndex=shape)
        found = [client.rayTest((x, y, 9.0), (x, y, -9.0))[0] for x, y in rays]
        return [hit[3][2] if hit[0] >= 0 else math.nan for hit in found]
    finally:
        client.close()


def test_boxes_in_a_compound_lie_where_they_should() -> None:
    step = BoxShape(half_extents_m=(0.5, 0.5, 0.25), centre_m=(1.0, 0.0, 0.25))
    assert _hits([SLAB, step], [(-1.0, 0.0), (1.0, 0.0)]) == pytest.approx([0.0, 0.5], abs=1e-6)


@pytest.mark.parametrize("alone", [True, False])
def test_a_turned_box_reaches_as_far_as_its_diagonal(alone: bool) -> None:
    """A square of 2 m turned by 45 degrees has its corner at 1.41 m and its side at 0.71 m."""
    box = BoxShape(half_extents_m=(1.0, 1.0, 0.5), orientation_xyzw=EIGHTH)
    shapes: list[CollisionShape] = [box] if alone else [SLAB, box]
    reached, missed = _hits(shapes, [(1.35, 0.0), (0.9, 0.9)])
    assert reached == pytest.approx(0.5, abs=0.01)
    assert np.isnan(missed) if alone else missed == pytest.approx(0.0, abs=1e-6)


def test_a_turned_box_is_scaled_equally_or_not_at_all() -> None:
    box = BoxShape(half_extents_m=(1.0, 1.0, 0.5), orientation_xyzw=EIGHTH)
    with pytest.raises(InvalidRequest, match="a turned box"):
        _hits([box], [], scale=(1.0, 2.0, 1.0))


def test_hulls_in_a_compound_have_their_slopes() -> None:
    """A pyramid of 1 m on a slab: half way up at half its base, to the collision margin."""
    heights = _hits([SLAB, PYRAMID], [(0.0, 0.0), (0.5, 0.0), (1.5, 1.5)])
    assert heights == pytest.approx([1.0, 0.5, 0.0], abs=0.06)


def test_two_hulls_in_a_compound_are_scaled() -> None:
    far = ConvexShape(points=np.add(PYRAMID.points, (5.0, 0.0, 0.0)))
    heights = _hits([PYRAMID, far], [(0.0, 0.0), (10.0, 0.0)], scale=(2.0, 1.0, 3.0))
    assert heights == pytest.approx([3.0, 3.0], abs=0.15)


@pytest.mark.parametrize("slabs", [0, 1, 15])
def test_each_of_many_hulls_is_felt(slabs: int) -> None:
    """PyBullet takes 16 shapes and leaves out the rest: forty hulls are all there, beside boxes."""
    hulls = [ConvexShape(points=np.add(PYRAMID.points, (3.0 * k, 0.0, 0.0))) for k in range(40)]
    below = [
        BoxShape(half_extents_m=(0.5, 0.5, 0.1), centre_m=(3.0 * k, 5.0, 0.1)) for k in range(slabs)
    ]
    rays = [(3.0 * k, 0.0) for k in range(40)] + [(3.0 * k, 5.0) for k in range(slabs)]
    expected = [1.0] * 40 + [0.2] * slabs
    assert _hits([*below, *hulls], rays) == pytest.approx(expected, abs=0.06)


@pytest.mark.parametrize("hulls", [0, 1])
def test_each_of_many_boxes_is_felt(hulls: int) -> None:
    """More than PyBullet takes are hulls: each is where it was, turned as it was."""
    boxes = [
        BoxShape(
            half_extents_m=(0.7, 0.2, 0.1 + 0.01 * k),
            centre_m=(3.0 * k, 5.0, 1.0),
            orientation_xyzw=EIGHTH if k % 2 else (0.0, 0.0, 0.0, 1.0),
        )
        for k in range(21)
    ]
    at = [(3.0 * k + (0.4 if k % 2 else 0.6), 5.0 + (0.4 if k % 2 else 0.0)) for k in range(21)]
    beside = [(3.0 * k + (0.6 if k % 2 else 0.0), 5.0 + (0.0 if k % 2 else 0.4)) for k in range(21)]
    shapes: list[CollisionShape] = [*boxes, *[PYRAMID] * hulls]
    assert _hits(shapes, at) == pytest.approx([1.1 + 0.01 * k for k in range(21)], abs=0.003)
    assert np.isnan(_hits(shapes, beside)).all()


def test_too_many_balls_are_refused() -> None:
    """None is left out silently."""
    with pytest.raises(InvalidRequest, match="at most 15 balls and cylinders, got 17"):
        _hits([SphereShape(radius_m=0.5) for _ in range(17)], [])


def test_hollow_geometry_stands_alone() -> None:
    hollow = TriangleShape(
        positions=PYRAMID.points, triangles=np.array([[0, 1, 4]], dtype=np.int32)
    )
    with pytest.raises(InvalidRequest, match="hollow geometry"):
        _hits([SLAB, hollow], [])


def test_shapes_that_do_not_come_again_keep_no_memory() -> None:
    """PyBullet takes references to the lists that it reads, and forgets to give them back."""
    dice = np.random.default_rng(1)
    triangles = np.arange(300, dtype=np.int32).reshape(-1, 3)
    hollows = [
        TriangleShape(positions=dice.normal(size=(300, 3)), triangles=triangles) for _ in range(21)
    ]
    # One set of lists alone is 50 kB.
    assert _grown([[hollow] for hollow in hollows]) < 25_000
    hulls = [ConvexShape(points=dice.normal(size=(100, 3))) for _ in range(21)]
    assert _grown([[hull] for hull in hulls]) < 25_000


def test_hulls_of_compounds_that_do_not_come_again_keep_no_memory() -> None:
    """Of files, PyBullet would keep each that it ever read: 13 kB a hull."""
    dice = np.random.default_rng(2)
    hulls = [ConvexShape(points=dice.normal(size=(100, 3))) for _ in range(201)]
    _hits([SLAB, hulls[0]], [])
    before = allocations().uordblks
    for hull in hulls[1:]:
        _hits([SLAB, hull], [])
    gc.collect()
    assert allocations().uordblks - before < 400_000


def test_little_is_left_of_the_hulls_of_a_compound(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """PyBullet never frees the name of a hull's file that it is given: no path, however long."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    dice = np.random.default_rng(3)
    bodies: list[list[CollisionShape]] = [
        [SLAB, ConvexShape(points=dice.normal(size=(10, 3)))] for _ in range(401)
    ]
    name = sys.getsizeof(b".sailenv0.obj")
    # What others in this process keep once, they keep in one of both halves.
    assert min(_grown(bodies[:201]), _grown(bodies[200:])) < 200 * name + 10_000


def test_bodies_of_hulls_are_made_without_a_word(capfd: pytest.CaptureFixture[str]) -> None:
    """PyBullet says it on standard error if it looks for a hull's file that is gone."""
    _hits([SLAB, PYRAMID], [])
    assert capfd.readouterr() == ("", "")


def _grown(bodies: list[list[CollisionShape]]) -> int:
    """Return what Python holds more after all than after the first [B]."""
    _hits(bodies[0], [])
    gc.collect()
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        for shapes in bodies[1:]:
            _hits(shapes, [])
        gc.collect()
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    return after - before


def test_hulls_files_are_removed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    client = BulletClient()
    with hull_files(client) as files:
        for compound in ([SLAB, PYRAMID, PYRAMID], [SLAB, PYRAMID]):
            build_collision(
                files, compound, scale=(1.0, 1.0, 1.0), centre_of_mass_m=(0, 0, 0), name="a"
            )
        assert len(list(tmp_path.glob("*/*.obj"))) == 3
    client.close()
    assert not list(tmp_path.iterdir())


def test_hulls_of_compounds_that_are_made_together_are_their_own() -> None:
    """PyBullet knows what it has read by names of files."""
    flat = ConvexShape(points=PYRAMID.points * [1.0, 1.0, 0.5])
    client = BulletClient()
    with hull_files(client) as files:
        for x, hull in ((0.0, PYRAMID), (5.0, flat)):
            shape = build_collision(
                files, [SLAB, hull], scale=(1.0, 1.0, 1.0), centre_of_mass_m=(0, 0, 0), name="a"
            )
            client.createMultiBody(
                baseMass=0.0, baseCollisionShapeIndex=shape, basePosition=(x, 0.0, 0.0)
            )
    heights = [client.rayTest((x, 0.0, 9.0), (x, 0.0, -9.0))[0][3][2] for x in (0.0, 5.0)]
    client.close()
    assert heights == pytest.approx([1.0, 0.5], abs=0.003)

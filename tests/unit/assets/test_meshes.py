"""Meshes keep their shape when they are welded, denoised, simplified, thinned out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import (
    RawMesh,
    box_uvs,
    components,
    is_open,
    outward,
    simplified,
    smooth_mesh,
    thinned_out,
)
from sailenv_ros.assets.simplification import fewer_triangles
from sailenv_ros.assets.solids import box_mesh, sphere_mesh
from sailenv_ros.types.model import Mesh


def raw(mesh: Mesh, *, normals: bool = False) -> RawMesh:
    return RawMesh(
        positions=mesh.positions.astype(np.float64),
        uvs=mesh.uvs.astype(np.float64),
        triangles=mesh.triangles.astype(np.int64),
        normals=mesh.normals.astype(np.float64) if normals else None,
    )


def area(mesh: RawMesh | Mesh) -> float:
    a, b, c = (mesh.positions[mesh.triangles[:, k].astype(int)] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def volume(mesh: RawMesh | Mesh) -> float:
    a, b, c = (mesh.positions[mesh.triangles[:, k].astype(int)] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def leaves(count: int, seed: int = 0) -> RawMesh:
    """So many separate quads."""
    generator = np.random.default_rng(seed)
    quad = np.array([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], dtype=np.float64)
    positions = (quad[None] + generator.uniform(0, 10, (count, 1, 3))).reshape(-1, 3)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])[None] + 4 * np.arange(count)[:, None, None]
    return RawMesh(
        positions=positions,
        uvs=np.zeros((4 * count, 2)),
        triangles=triangles.reshape(-1, 3),
    )


def test_a_cube_keeps_its_creases() -> None:
    """Each corner of a cube has the normal of its own face, none is denoised."""
    mesh = smooth_mesh(raw(box_mesh((1.0, 2.0, 3.0))))
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    for k in range(3):
        np.testing.assert_allclose(mesh.normals[mesh.triangles[:, k]], faces, atol=1e-6)


def test_a_ball_is_smooth() -> None:
    """A ball's found normals point away from its centre."""
    mesh = smooth_mesh(raw(sphere_mesh(2.0)))
    radial = mesh.positions / np.linalg.norm(mesh.positions, axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", radial, mesh.normals).min() > 0.99


def test_an_authors_normals_are_kept_and_tell_the_outside() -> None:
    """Triangles that run against given normals are turned; the normals stay."""
    ball = raw(sphere_mesh(1.0), normals=True)
    wrong = RawMesh(
        positions=ball.positions,
        uvs=ball.uvs,
        triangles=ball.triangles[:, ::-1],
        normals=ball.normals,
    )
    mesh = smooth_mesh(wrong)
    assert ball.normals is not None
    np.testing.assert_allclose(mesh.normals, ball.normals, atol=1e-6)
    assert volume(mesh) > 0.0


def test_simplifying_keeps_the_shape() -> None:
    """A ball of a tenth of the triangles has nearly the same size and volume."""
    ball = raw(sphere_mesh(1.0, segments=96))
    small = simplified(ball, len(ball.triangles) // 10, max_error=0.02)
    assert len(small.triangles) <= len(ball.triangles) // 8
    np.testing.assert_allclose(np.abs(small.positions).max(axis=0), 1.0, atol=0.03)
    assert volume(small) == pytest.approx(volume(ball), rel=0.05)
    assert simplified(ball, 10**6) is ball


def test_thin_foliage_is_as_dense() -> None:
    """With a quarter of the leaves, each is larger, and all together cover the same area."""
    plant = leaves(2000)
    thin = thinned_out(plant, 1000, seed=3)
    assert len(thin.triangles) <= 1000
    assert area(thin) == pytest.approx(area(plant), rel=1e-6)
    again = thinned_out(plant, 1000, seed=3)
    np.testing.assert_array_equal(thin.positions, again.positions)


def test_components_are_counted() -> None:
    """Separate quads are separate pieces, a welded ball is one."""
    assert len(np.unique(components(leaves(7)))) == 7
    assert components(raw(sphere_mesh(1.0))).max() == 0


def test_inside_out_pieces_are_turned_and_open_ones_are_not() -> None:
    """A closed cube that faces inwards is turned; sheets have no inside."""
    cube = raw(box_mesh((1.0, 1.0, 1.0)))
    inside_out = RawMesh(positions=cube.positions, uvs=cube.uvs, triangles=cube.triangles[:, ::-1])
    assert volume(outward(inside_out)) == pytest.approx(1.0)
    assert outward(cube) is cube
    sheet = leaves(3)
    assert outward(sheet) is sheet
    assert is_open(sheet)
    assert not is_open(cube)


def test_box_coordinates_are_in_metres_along_the_grain() -> None:
    """A plank's texture runs along it and is as large as it should be."""
    plank = box_uvs(raw(box_mesh((2.0, 0.2, 0.02))), tile_m=0.5)
    top = plank.positions[:, 2] > 0.0
    across = np.ptp(plank.uvs[top], axis=0)
    np.testing.assert_allclose(across, [2.0 / 0.5, 0.2 / 0.5], rtol=1e-6)


def test_slivers_are_dropped() -> None:
    """Triangles without area would have no normal."""
    points: NDArray[np.float64] = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]])
    mesh = RawMesh(
        positions=points, uvs=np.zeros((4, 2)), triangles=np.array([[0, 1, 2], [0, 1, 3]])
    )
    assert len(smooth_mesh(mesh).triangles) == 1


def grid(size: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return corners and triangles of a flat square of edge 1, cut into size x size squares."""
    line = np.linspace(0.0, 1.0, size + 1)
    x, y = np.meshgrid(line, line)
    positions = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    at = np.arange(x.size).reshape(x.shape)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    halves = [np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]
    return positions, np.concatenate([half.reshape(-1, 3) for half in halves])


def area_of(positions: NDArray[np.float64], triangles: NDArray[np.int64]) -> float:
    return area(RawMesh(positions=positions, uvs=positions[:, :2], triangles=triangles))


def test_a_flat_sheet_becomes_few_triangles_and_keeps_its_outline() -> None:
    """Its area is exact, and no triangle is turned over."""
    positions, triangles = grid(24)
    few = fewer_triangles(positions, triangles, 2, max_error=1e-6)
    assert len(few) <= 24
    assert area_of(positions, few) == pytest.approx(1.0, abs=1e-12)
    a, b, c = (positions[few[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0.0).all()


def test_a_cube_cut_finely_becomes_its_twelve_triangles() -> None:
    """Edges and corners are where a contraction costs; the inside of a face costs nothing."""
    positions, triangles = grid(8)
    sides, faces = [], []
    for axis in range(3):
        for side, turn in ((0.0, slice(None, None, -1)), (1.0, slice(None))):
            flat = np.roll(positions, axis + 1, axis=1)
            flat[:, axis] = side
            faces.append(triangles[:, turn] + len(positions) * len(sides))
            sides.append(flat)
    corners, cube = np.concatenate(sides).round(9), np.concatenate(faces)
    unique, place = np.unique(corners, axis=0, return_inverse=True)
    few = fewer_triangles(unique, place.reshape(-1)[cube], 12, max_error=1e-6)
    assert len(few) == 12
    assert area_of(unique, few) == pytest.approx(6.0, abs=1e-12)


def test_a_seam_of_texture_stays_where_it_is() -> None:
    """Two halves with coordinates of their own keep them: no triangle joins both."""
    positions, triangles = grid(16)
    right = positions[triangles].mean(axis=1)[:, 0] > 0.5
    triangles = np.where(right[:, None], triangles + len(positions), triangles)
    doubled = np.concatenate([positions, positions])
    few = fewer_triangles(doubled, triangles, 4, max_error=1e-6)
    assert len(few) < len(triangles) / 8
    of_right = few >= len(positions)
    assert (of_right.all(axis=1) | ~of_right.any(axis=1)).all()
    for half in (few[of_right.all(axis=1)], few[~of_right.any(axis=1)]):
        assert area_of(doubled, half) == pytest.approx(0.5, abs=1e-12)


def test_a_surface_does_not_move_farther_than_is_allowed() -> None:
    """A sphere that may not change keeps nearly all its triangles; no corner is made up."""
    ball = raw(sphere_mesh(1.0, segments=24))
    kept = simplified(ball, 20, max_error=1e-4)
    assert len(kept.triangles) > 0.8 * len(ball.triangles)
    rows = {tuple(row) for row in ball.positions.round(6)}
    assert all(tuple(row) in rows for row in simplified(ball, 60, max_error=0.1).positions.round(6))


def test_a_plant_of_large_leaves_keeps_its_size() -> None:
    """A leaf of many triangles loses its tips when it is simplified."""
    ball = raw(sphere_mesh(0.5, segments=96))
    bumps = 1.0 + 0.02 * np.random.default_rng(1).random((len(ball.positions), 1))
    leaf = replace(ball, positions=ball.positions * bumps)
    few = thinned_out(leaf, len(leaf.triangles) // 2, seed=1)
    assert len(few.triangles) <= len(leaf.triangles) // 2
    for edge in (np.min, np.max):
        kept, given = edge(few.positions, axis=0), edge(leaf.positions, axis=0)
        np.testing.assert_allclose(kept, given, atol=1e-9)

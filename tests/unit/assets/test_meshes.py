"""Meshes keep their shape when they are welded, denoised, simplified, thinned out."""

from __future__ import annotations

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
from sailenv_ros.assets.solids import box_mesh, sphere_mesh
from sailenv_ros.model import Mesh


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

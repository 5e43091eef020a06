"""The built-in solids are closed, wound outwards, and collide as what they look like."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets import AssetLibrary
from sailenv_ros.types.model import BoxShape, ConvexShape, CylinderShape, Mesh, SphereShape

LIBRARY = AssetLibrary()
SOLIDS = ("cube", "sphere", "cylinder", "cone")
EXACT_VOLUME = {
    "cube": 1.0,
    "sphere": math.pi / 6,
    "cylinder": math.pi / 4,
    "cone": math.pi / 12,
}


def _mesh(name: str) -> Mesh:
    (part,) = LIBRARY.get(name).model.parts
    return part.mesh


def _corners(mesh: Mesh) -> NDArray[np.float64]:
    """(M, 3, 3) corners of the triangles."""
    return mesh.positions.astype(np.float64)[mesh.triangles]


def _face_normals(mesh: Mesh) -> NDArray[np.float64]:
    a, b, c = np.moveaxis(_corners(mesh), 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    assert (lengths > 0).all(), "a triangle without area"
    result: NDArray[np.float64] = normals / lengths
    return result


@pytest.mark.parametrize("name", SOLIDS)
def test_every_edge_is_shared_by_two_triangles_that_run_along_it_oppositely(name: str) -> None:
    """So the surface is closed and all triangles are wound alike."""
    mesh = _mesh(name)
    rounded = np.round(mesh.positions, 5) + 0.0
    _, same = np.unique(rounded, axis=0, return_inverse=True)
    corners = same.reshape(-1)[mesh.triangles]
    edges = Counter((int(t[i]), int(t[(i + 1) % 3])) for t in corners for i in range(3))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)


@pytest.mark.parametrize("name", SOLIDS)
def test_triangles_are_wound_outwards_and_enclose_the_solid_s_volume(name: str) -> None:
    a, b, c = np.moveaxis(_corners(_mesh(name)), 1, 0)
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
    assert 0.99 * EXACT_VOLUME[name] < volume <= EXACT_VOLUME[name] * (1 + 1e-6)


@pytest.mark.parametrize("name", SOLIDS)
def test_the_origin_is_the_centre_of_mass(name: str) -> None:
    a, b, c = np.moveaxis(_corners(_mesh(name)), 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    centre = np.einsum("i,ij->j", volumes, (a + b + c) / 4.0) / volumes.sum()
    np.testing.assert_allclose(centre, 0.0, atol=1e-6)
    assert LIBRARY.get(name).centre_of_mass_m == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("name", [*SOLIDS, "plane"])
def test_normals_have_unit_length_and_fit_their_faces(name: str) -> None:
    mesh = _mesh(name)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-6)
    along = np.einsum("ijk,ik->ij", mesh.normals[mesh.triangles], _face_normals(mesh))
    # Smooth normals differ from the facets' by half a segment's angle or so.
    assert along.min() > math.cos(2 * math.pi / 64)


@pytest.mark.parametrize("name", ["cube", "plane"])
def test_flat_faces_have_flat_normals(name: str) -> None:
    mesh = _mesh(name)
    expected = np.repeat(_face_normals(mesh)[:, np.newaxis], 3, axis=1)
    np.testing.assert_array_equal(mesh.normals[mesh.triangles], expected)


def test_the_normals_of_a_sphere_are_its_radii() -> None:
    mesh = _mesh("sphere")
    np.testing.assert_allclose(mesh.positions, 0.5 * mesh.normals, atol=1e-7)


def test_the_normals_of_a_cylinder_are_radial_or_along_its_axis() -> None:
    mesh = _mesh("cylinder")
    caps = np.abs(mesh.normals[:, 2]) == 1.0
    sides = mesh.positions[~caps]
    np.testing.assert_allclose(mesh.normals[~caps][:, :2], sides[:, :2] / 0.5, atol=1e-6)
    np.testing.assert_array_equal(mesh.normals[~caps][:, 2], 0.0)
    np.testing.assert_array_equal(np.sign(mesh.positions[caps][:, 2]), mesh.normals[caps][:, 2])


def test_the_normals_of_a_cone_are_those_of_its_slope() -> None:
    """A cone of radius 1/2 and height 1 leans by atan(1/2)."""
    mesh = _mesh("cone")
    side = mesh.normals[mesh.normals[:, 2] > -0.5]
    np.testing.assert_allclose(side[:, 2], math.sin(math.atan(0.5)), atol=1e-6)


@pytest.mark.parametrize("name", [*SOLIDS, "plane"])
def test_textures_are_not_mirrored_and_not_squeezed_to_nothing(name: str) -> None:
    mesh = _mesh(name)
    a, b, c = np.moveaxis(mesh.uvs.astype(np.float64)[mesh.triangles], 1, 0)
    first, second = b - a, c - a
    areas = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    assert (areas > 0).all()


def test_triangles_are_few_and_outlines_smooth() -> None:
    counts = {name: LIBRARY.get(name).model.triangle_count for name in LIBRARY.names}
    assert counts == {"cube": 12, "sphere": 3968, "cylinder": 256, "cone": 128, "plane": 2}
    # 64 sides: the outline of a 1 m cylinder is within 0.61 mm of the circle.
    assert 0.5 * (1 - math.cos(math.pi / 64)) < 0.00061


def test_sizes_are_those_that_are_told() -> None:
    bounds = {name: LIBRARY.get(name).model.bounds().tolist() for name in LIBRARY.names}
    for name in ("cube", "sphere", "cylinder"):
        assert bounds[name] == [[-0.5] * 3, [0.5] * 3]
    assert bounds["cone"] == [[-0.5, -0.5, -0.25], [0.5, 0.5, 0.75]]
    assert bounds["plane"] == [[-5.0, -5.0, 0.0], [5.0, 5.0, 0.0]]


def test_physics_shapes_are_exact() -> None:
    shapes = {name: LIBRARY.get(name).collision for name in LIBRARY.names}
    assert shapes["cube"] == (BoxShape(half_extents_m=(0.5, 0.5, 0.5)),)
    assert shapes["sphere"] == (SphereShape(radius_m=0.5),)
    assert shapes["cylinder"] == (CylinderShape(radius_m=0.5, height_m=1.0),)
    (cone,) = shapes["cone"]
    assert isinstance(cone, ConvexShape)
    np.testing.assert_array_equal(cone.points.max(axis=0), [0.5, 0.5, 0.75])


def test_the_plane_faces_up_only_and_collides_up_to_its_face() -> None:
    plane = LIBRARY.get("plane")
    (part,) = plane.model.parts
    assert (_face_normals(part.mesh) == [0.0, 0.0, 1.0]).all()
    assert not part.material.double_sided
    (slab,) = plane.collision
    assert isinstance(slab, BoxShape)
    assert slab.centre_m[2] + slab.half_extents_m[2] == 0.0
    assert slab.half_extents_m[:2] == (5.0, 5.0)

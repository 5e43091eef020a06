"""Skinning, clusters, trees and points of surfaces that deform, against plain NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, NativeLibraryError
from sailenv_ros.native.deformation_kernels import (
    bounding_sphere,
    move_clusters,
    refit,
    skin,
)
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.native.mesh_kernels import clusters_of
from sailenv_ros.native.render_types import TRIANGLE_PLACE
from sailenv_ros.native.surface_kernels import surface_points
from sailenv_ros.rays.opaque_models import opaque_model, surface_between
from sailenv_ros.render.cpu.mesh_store import MeshStore
from sailenv_ros.render.scene.drawn_meshes import DrawnMesh
from tests.support.tiny_scenes import model_of
from tests.support.waving_sheet import sheet_mesh, waved

RANDOM = np.random.default_rng(5)
SHEET = model_of(sheet_mesh())


def bones_of(count: int) -> np.ndarray:
    """(B, 3, 4) rotations with translations."""
    turns = np.linalg.qr(RANDOM.normal(size=(count, 3, 3)))[0]
    return np.ascontiguousarray(np.concatenate([turns, RANDOM.normal(size=(count, 3, 1))], axis=2))


def skin_input(vertices: int, bones: int) -> tuple[np.ndarray, ...]:
    normals = RANDOM.normal(size=(vertices, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    weights = RANDOM.random((vertices, 4))
    weights[:, 2:] *= RANDOM.random((vertices, 2)) < 0.5
    weights /= weights.sum(axis=1, keepdims=True)
    return (
        RANDOM.normal(size=(vertices, 3)).astype(np.float32),
        normals.astype(np.float32),
        RANDOM.integers(bones, size=(vertices, 4)).astype(np.uint16),
        weights.astype(np.float32),
        bones_of(bones),
    )


def test_skinning_is_the_weighted_sum_of_what_bones_do() -> None:
    positions, normals, bones, weights, matrices = skin_input(5000, 40)
    moved, turned = skin(positions, normals, bones, weights, matrices, threads=2)
    blended = np.einsum("vk,vkij->vij", weights.astype(np.float64), matrices[bones])
    expected = np.einsum("vij,vj->vi", blended[:, :, :3], positions) + blended[:, :, 3]
    assert np.abs(moved - expected).max() < 3e-6
    expected = np.einsum("vij,vj->vi", blended[:, :, :3], normals)
    length = np.linalg.norm(expected, axis=1)
    sure = length > 0.05
    expected = expected[sure] / length[sure, None]
    assert np.abs(turned[sure] - expected).max() < 1e-5


def test_skinning_gives_the_same_bytes_everywhere() -> None:
    given = skin_input(3000, 9)
    results = []
    for name in load_library().instruction_sets:
        with using_instruction_set(name):
            results += [skin(*given, threads=threads) for threads in (1, 3)]
    for moved, turned in results[1:]:
        assert moved.tobytes() == results[0][0].tobytes()
        assert turned.tobytes() == results[0][1].tobytes()


def test_bones_that_are_not_there_are_refused() -> None:
    positions, normals, bones, weights, matrices = skin_input(10, 3)
    bones[4, 1] = 3
    with pytest.raises(NativeLibraryError):
        skin(positions, normals, bones, weights, matrices, threads=1)
    with pytest.raises(InvalidRequest, match="weights"):
        skin(positions, normals, bones, weights[:, :3].copy(), matrices, threads=1)


def test_clusters_of_moved_corners_are_those_that_are_made_of_them() -> None:
    mesh = SHEET.parts[0].mesh
    triangles, clusters = clusters_of(mesh.positions, mesh.triangles)
    moved = waved(SHEET, 0.7).meshes[0].positions
    given = clusters.copy()
    move_clusters(moved, np.ascontiguousarray(triangles.reshape(-1)), given)
    corners = moved[triangles].astype(np.float64)
    for cluster in given:
        first, count = cluster["first_index"] // 3, cluster["index_count"] // 3
        own = corners[first : first + count]
        away = np.linalg.norm(own - cluster["centre"], axis=2)
        assert away.max() == pytest.approx(cluster["radius"])
        normals = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        assert (normals @ cluster["axis"]).min() == pytest.approx(cluster["cosine"])


def test_a_refitted_tree_holds_its_triangles() -> None:
    rest, shape = opaque_model(SHEET), waved(SHEET, 1.1)
    nodes, corners, blocks = refit(
        shape.meshes[0].positions, rest.vertex_of, rest.tree.order, rest.tree.nodes
    )
    assert np.array_equal(corners, shape.meshes[0].positions[SHEET.parts[0].mesh.triangles])
    pending = [(0, corners.min(axis=(0, 1)) - 1.0, corners.max(axis=(0, 1)) + 1.0)]
    held = []
    while pending:
        number, low, high = pending.pop()
        if number < 0:
            triangles = [t for t in rest.tree.order[~number] if t >= 0]
            assert (corners[triangles] >= low).all()
            assert (corners[triangles] <= high).all()
            held += triangles
            block = blocks[~number].reshape(3, 3, 8).transpose(2, 0, 1)[: len(triangles)]
            assert np.allclose(block[:, 0], corners[triangles][:, 0])
            assert np.allclose(block[:, 2], (corners[triangles][:, 2] - corners[triangles][:, 0]))
            continue
        for lane, child in enumerate(nodes[number]["children"].tolist()):
            if child:
                planes = nodes[number]["planes"][:, lane]
                pending.append((child, planes[:3], planes[3:]))
    assert sorted(held) == list(range(len(corners)))


def test_a_mesh_takes_the_vertices_of_an_instant() -> None:
    shape = waved(SHEET, 0.4)
    drawn = DrawnMesh(SHEET.parts[0].mesh, None, 0, owner=3)
    mesh = MeshStore().get(drawn)
    mesh.move(shape.meshes[0])
    corners = mesh.corners[:, : mesh.corner_count].T
    numbers, places = mesh.corner_indices.reshape(-1, 3), mesh.vertex_indices.reshape(-1, 3)
    assert np.array_equal(corners[numbers], shape.meshes[0].positions[places])
    assert np.array_equal(mesh.vertices[:, :3], shape.meshes[0].normals)
    clusters = mesh.clusters.copy()
    move_clusters(np.ascontiguousarray(corners), mesh.corner_indices, clusters)
    assert clusters.tobytes() == mesh.clusters.tobytes()
    away = np.linalg.norm(corners - mesh.sphere[:3], axis=1)
    assert away.max() <= mesh.sphere[3] <= 1.001 * away.max() + 1e-5


def test_a_sphere_bounds_the_corners_alone() -> None:
    columns = np.full((3, 20), 1e9, np.float32)
    columns[:, :12] = RANDOM.normal(size=(3, 12))
    sphere = bounding_sphere(columns, 12)
    low, high = columns[:, :12].min(axis=1), columns[:, :12].max(axis=1)
    assert np.allclose(sphere[:3], 0.5 * (low.astype(np.float64) + high), atol=1e-12)
    away = np.linalg.norm(columns[:, :12].T - sphere[:3], axis=1)
    assert sphere[3] == pytest.approx(1.0001 * away.max() + 1e-6)
    assert (bounding_sphere(columns, 0) == 0.0).all()


def test_points_whose_triangles_are_known_go_with_them() -> None:
    present, target = waved(SHEET, 0.2), waved(SHEET, 0.9)
    surface = surface_between(7, (1.0, 2.0, 0.5), present, target, with_tree=False)
    places = np.zeros((4, 5), TRIANGLE_PLACE)
    triangles = SHEET.parts[0].mesh.triangles
    places["vertices"] = triangles[RANDOM.integers(len(triangles), size=(4, 5))]
    places["weights"] = RANDOM.dirichlet((1, 1, 1), size=(4, 5))
    places["vertices"][3, 3, 1] = len(present.positions)
    instance = np.full((4, 5), 7, np.uint16)
    instance[0, 0] = 3
    points = np.zeros((4, 5, 3), np.float32)
    points[1, 2] = np.nan
    moved = target.positions.astype(np.float64) - present.positions
    expected = np.einsum(
        "hwk,hwkj->hwj", places["weights"], moved.take(places["vertices"], axis=0, mode="clip")
    ) * (1.0, 2.0, 0.5)
    for given in (None, points):
        found = np.full((4, 5, 3), 5.0, np.float32)
        surface_points(given, instance, [surface], found, relative=True, threads=2, places=places)
        unknown = {(3, 3)} if given is None else {(3, 3), (1, 2)}
        assert set(zip(*np.nonzero(np.isnan(found[..., 0])), strict=True)) == unknown
        assert (found[0, 0] == 5.0).all()
        sure = (instance == 7) & ~np.isnan(found[..., 0])
        assert np.abs(found - expected)[sure].max() < 1e-6
    with pytest.raises(InvalidRequest, match="tree"):
        surface_points(points, instance, [surface], found, relative=True, threads=1)


def test_points_are_found_on_the_nearest_triangle() -> None:
    present, target = waved(SHEET, 0.2), waved(SHEET, 0.9)
    now, then = (
        shape.meshes[0].positions.astype(np.float64)[SHEET.parts[0].mesh.triangles]
        for shape in (present, target)
    )
    weights = RANDOM.dirichlet((1, 1, 1), size=(7, 9))
    triangles = RANDOM.integers(len(now), size=(7, 9))
    scale = (1.0, 2.0, 0.5)
    points = np.einsum("hwk,hwkj->hwj", weights, now[triangles]) * scale
    points[2, 3] = np.nan
    points[4, 4] += 9.0
    surface = surface_between(7, scale, present, target)
    instance = np.full((7, 9), 7, np.uint16)
    instance[0, 0] = 3
    found = np.full((7, 9, 3), 5.0, np.float32)
    surface_points(points.astype(np.float32), instance, [surface], found, relative=True, threads=2)
    expected = np.einsum("hwk,hwkj->hwj", weights, (then - now)[triangles]) * scale
    assert (found[0, 0] == 5.0).all()
    assert np.isnan(found[2, 3]).all()
    assert np.isnan(found[4, 4]).all()
    sure = (instance == 7) & ~np.isnan(found[..., 0])
    assert sure.sum() == 60
    assert np.abs(found[sure] - expected[sure]).max() < 1e-5

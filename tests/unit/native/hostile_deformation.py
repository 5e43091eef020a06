"""Hostile input for the kernels of surfaces that deform; part of `hostile_input.DRIVERS`."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import numpy as np

from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.native.deformation_kernels import (
    bounding_sphere,
    move_clusters,
    move_mesh,
    refit,
    skin,
)
from sailenv_ros.native.mesh_kernels import clusters_of, corners_of
from sailenv_ros.native.motion_kernels import MOTION_OUTPUTS, SurfaceMotions, move_points
from sailenv_ros.native.render_types import CLUSTER, TRIANGLE_PLACE
from sailenv_ros.native.surface_kernels import DeformingSurface, SurfaceTree, surface_points
from sailenv_ros.rays.triangle_tree import triangle_tree
from sailenv_ros.types.camera import CameraIntrinsics
from tests.unit.native.hostile_numbers import NUMBERS, THREADS, wild_floats

__all__ = ["DRIVERS"]


def drive_skinning() -> None:
    """Weights and matrices that are no numbers; bones that are not there."""
    rng = np.random.default_rng(7)
    for vertices, count in ((0, 1), (1, 1), (999, 1), (5000, 300)):
        matrices = rng.choice(np.array(NUMBERS), (count, 3, 4))
        bones = rng.integers(count, size=(vertices, 4)).astype(np.uint16)
        given = wild_floats(rng, vertices, 3), wild_floats(rng, vertices, 3)
        skin(*given, bones, wild_floats(rng, vertices, 4), matrices, threads=THREADS[1])
        bones[-1:] = 65535
        with contextlib.suppress(NativeLibraryError):
            skin(*given, bones, wild_floats(rng, vertices, 4), matrices, threads=THREADS[0])


def drive_clusters() -> None:
    """Corners that are no numbers, clusters without triangles or beyond the indices."""
    rng = np.random.default_rng(8)
    indices = rng.integers(40, size=96).astype(np.uint32)
    clusters = np.zeros(3, CLUSTER)
    clusters["first_index"], clusters["index_count"] = (0, 48, 96), (48, 48, 0)
    move_clusters(wild_floats(rng, 40, 3), indices, clusters)
    columns, vertices = np.zeros((3, 48), np.float32), np.zeros((50, 8), np.float32)
    sources = rng.integers(50, size=40).astype(np.uint32)

    def move() -> None:
        given = wild_floats(rng, 50, 3), wild_floats(rng, 50, 3)
        move_mesh(*given, sources, indices, columns, vertices, clusters)

    move()
    for first, count in ((-3, 9), (90, 9), (0, -1), (2**62, 2**62), (0, 96), (0, 99)):
        clusters["first_index"][1], clusters["index_count"][1] = first, count
        with contextlib.suppress(NativeLibraryError):
            move_clusters(wild_floats(rng, 40, 3), indices, clusters)
        with contextlib.suppress(NativeLibraryError):
            move()
    sources[7] = 50
    with contextlib.suppress(NativeLibraryError):
        move()
    for count in (0, 1, 17):
        bounding_sphere(wild_floats(rng, 3, 17), count)


def drive_meshes() -> None:
    """Places that are no numbers, vertices that are not there, many triangles in one place."""
    rng = np.random.default_rng(9)
    for vertices, count in ((0, 0), (1, 700), (40, 1), (40, 700)):
        positions = wild_floats(rng, vertices, 3)
        triangles = rng.integers(max(vertices, 1), size=(count, 3)).astype(np.uint32)
        for order in (clusters_of, corners_of):
            order(positions, triangles)
        triangles[-1:] = vertices
        for order in (clusters_of, corners_of):
            with contextlib.suppress(NativeLibraryError):
                order(positions, triangles)


def drive_surfaces() -> None:
    """Points that are no numbers on triangles without area; trees with wild children."""
    rng = np.random.default_rng(9)
    corners = rng.choice(np.array((0.0, 1e-300, 1.0, 0.5)), (500, 3, 3))
    tree = triangle_tree(corners)
    places = np.arange(1500, dtype=np.uint32).reshape(500, 3)
    positions = corners.reshape(-1, 3).astype(np.float32)
    targets = rng.choice(np.array(NUMBERS), positions.shape).astype(np.float32)
    on_triangles = np.zeros((8, 9), TRIANGLE_PLACE)
    on_triangles["vertices"] = rng.choice(
        np.array((0, 1499, 1500, 2**32 - 1), np.uint32), (8, 9, 3)
    )
    on_triangles["weights"] = wild_floats(rng, 8, 9, 3)
    rows = np.zeros((8, 9), np.uint16)
    rows[::2] = 5
    for scale in ((1.0, 1.0, 1.0), (0.0, np.nan, np.inf)):
        surface = DeformingSurface(5, scale, positions, targets, SurfaceTree(tree.record, places))
        for points in (wild_floats(rng, 8, 9, 3), rng.random((8, 9, 3)).astype(np.float32)):
            found = np.empty_like(points)
            surface_points(points, rows, [surface], found, relative=True, threads=THREADS[1])
            for known in (points, None):
                surface_points(
                    *(known, rows, [surface._replace(tree=None)], found),
                    relative=False,
                    threads=THREADS[1],
                    places=on_triangles,
                )
    refit(positions, places, tree.order, tree.nodes)
    for child in (-(2**31), 2**31 - 1, 1, -400):
        nodes = tree.nodes.copy()
        nodes["children"][-1, 0] = child
        with contextlib.suppress(NativeLibraryError):
            refit(positions, places, tree.order, nodes)
    with contextlib.suppress(NativeLibraryError):
        refit(wild_floats(rng, 1500, 3), places, tree.order, tree.nodes)
    with contextlib.suppress(NativeLibraryError):
        refit(positions[:9], places, tree.order, tree.nodes)


def drive_offsets() -> None:
    """Offsets that are no numbers."""
    rng = np.random.default_rng(10)
    lens = CameraIntrinsics(width=37, height=11).lens_record
    depth, ids = wild_floats(rng, 11, 37), rng.integers(3, size=(11, 37)).astype(np.uint16)
    numbers = rng.choice(np.array(NUMBERS), (4, 3, 4))
    found = {
        name: np.empty((11, 37, *channels), dtype)
        for name, (dtype, channels) in MOTION_OUTPUTS.items()
    }
    turns = np.ascontiguousarray(numbers[:, :, :3])
    surfaces = SurfaceMotions(wild_floats(rng, 11, 37, 3), np.ones(4, np.bool_), turns, turns)
    rows = np.arange(65536).astype(np.uint16)
    move_points(
        *(depth, ids, rows, numbers, numbers, lens, lens, depth, ids, 0.01),
        found,
        surfaces=surfaces,
        threads=THREADS[1],
    )


DRIVERS: tuple[Callable[[], None], ...] = (
    drive_skinning,
    drive_clusters,
    drive_meshes,
    drive_surfaces,
    drive_offsets,
)

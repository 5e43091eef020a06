"""Scenes that no renderer should be given, and must survive."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.tiny_scenes import Thing, box_mesh, mesh_of, model_of, snapshot_of


def hostile_scenes() -> dict[str, Callable[[], WorldSnapshot]]:
    """Scenes that nobody should make."""

    def posed(matrix: NDArray[np.float64]) -> WorldSnapshot:
        scene = snapshot_of([Thing(model_of(box_mesh(1.0)), Pose((2, 0, 0)))])
        return replace(scene, world_from_body=matrix[None])

    def shaped(points: NDArray[np.float64]) -> WorldSnapshot:
        triangles = np.arange(len(points) // 3 * 3, dtype=np.uint32).reshape(-1, 3)
        flat = np.tile(np.array([0, 0, 1], np.float32), (len(points), 1))
        mesh = mesh_of(points.astype(np.float32), flat, np.zeros((len(points), 2)), triangles)
        return snapshot_of([Thing(model_of(mesh, double_sided=True), Pose((0, 0, 0)))])

    random = np.random.default_rng(3)
    far = np.eye(4)
    far[:3, 3] = 1e30
    return {
        "pose without numbers": lambda: posed(np.full((4, 4), np.nan)),
        "infinite pose": lambda: posed(np.full((4, 4), np.inf)),
        "pose of zeros": lambda: posed(np.zeros((4, 4))),
        "far away": lambda: posed(far),
        "points": lambda: shaped(np.tile(random.normal(size=(40, 1, 3)), (1, 3, 1)).reshape(-1, 3)),
        "lines": lambda: shaped(np.linspace([1, 0, 0], [9, 1, 1], 90)),
        "huge": lambda: shaped(1e18 * random.normal(size=(90, 3))),
        "tiny": lambda: shaped(np.array([2, 0, 0]) + 1e-20 * random.normal(size=(90, 3))),
        "around the eye": lambda: shaped(1e-3 * random.normal(size=(900, 3))),
        "through the eye": lambda: shaped(random.normal(size=(900, 3)) * [1, 1, 0]),
        "nothing": lambda: snapshot_of([]),
    }

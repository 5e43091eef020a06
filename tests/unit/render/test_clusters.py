"""Clusters of triangles: nothing is lost, and nothing that an eye may see is left out."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sailenv_ros.native.cluster_kernels import MARGIN, seen_indices
from sailenv_ros.native.mesh_kernels import CLUSTER_TRIANGLES, clusters_of
from sailenv_ros.native.render_types import CLUSTER
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at

LENS = CameraIntrinsics(width=64, height=48, vertical_fov_deg=60.0)


def soup(seed: int, count: int) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return scattered triangles within two metres of the origin, some of them without area."""
    random = np.random.default_rng(seed)
    middles = random.uniform(-2.0, 2.0, (count, 1, 3))
    corners = middles + random.normal(0.0, 0.2, (count, 3, 3))
    corners[::17, 1] = corners[::17, 0]
    return (
        corners.reshape(-1, 3).astype(np.float32),
        np.arange(3 * count, dtype=np.uint32).reshape(-1, 3),
    )


def ball(steps: int) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return a sphere of radius 1, its triangles counter-clockwise from outside."""
    around = np.linspace(0.0, 2.0 * np.pi, 2 * steps, endpoint=False)
    up = np.linspace(0.0, np.pi, steps + 1)[1:-1]
    ring = np.stack([np.cos(around), np.sin(around)], axis=1)
    rows = [np.column_stack([np.sin(a) * ring, np.full(len(ring), np.cos(a))]) for a in up]
    points = np.concatenate([*rows, [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    columns, last = 2 * steps, len(points) - 1
    triangles = []
    for v in range(len(rows) - 1):
        for u in range(columns):
            a, b = v * columns + u, v * columns + (u + 1) % columns
            triangles += [(a, a + columns, b), (b, a + columns, b + columns)]
    for u in range(columns):
        low = (len(rows) - 1) * columns
        triangles += [(last - 1, u, (u + 1) % columns)]
        triangles += [(last, low + (u + 1) % columns, low + u)]
    return points.astype(np.float32), np.array(triangles, np.uint32)


def seen(
    positions: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    eye: tuple[float, float, float],
    target: tuple[float, float, float],
    *,
    one_sided: bool,
) -> tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.float64]]:
    """Return the ordered triangles, those gathered for an eye, and its clip matrix."""
    ordered, clusters = clusters_of(positions, triangles)
    camera = Camera(intrinsics=LENS, pose=look_at(eye, target))
    clip = LENS.clip_from_optical() @ camera.camera_from_world
    found, lies = seen_indices(
        np.zeros(1, np.intp),
        clusters,
        np.array([[0, len(clusters), ordered.size]]),
        clip[None],
        np.array([eye]),
        np.array([one_sided]),
        ordered.reshape(-1),
        np.zeros(ordered.size, np.uint32),
        np.zeros(1, bool),
    )
    assert lies.tolist() == [[0, len(found)]]
    return ordered, found.reshape(-1, 3), clip


def as_set(triangles: NDArray[np.uint32]) -> set[tuple[int, ...]]:
    return {tuple(triangle) for triangle in triangles.tolist()}


@given(seed=st.integers(0, 2**16), count=st.integers(1, 300))
def test_every_triangle_lies_in_one_cluster_that_encloses_it(seed: int, count: int) -> None:
    """Spheres hold their corners and cones their normals."""
    positions, triangles = soup(seed, count)
    ordered, clusters = clusters_of(positions, triangles)
    assert sorted(ordered.tolist()) == sorted(triangles.tolist())
    counts = clusters["index_count"]
    assert clusters["first_index"].tolist() == [0, *np.cumsum(counts)[:-1].tolist()]
    assert counts.sum() == triangles.size
    assert 0 < counts.min() <= counts.max() <= 3 * CLUSTER_TRIANGLES
    for cluster in clusters:
        first = int(cluster["first_index"]) // 3
        corners = positions[ordered[first : first + int(cluster["index_count"]) // 3]]
        away = np.linalg.norm(corners.astype(float) - cluster["centre"], axis=2)
        assert away.max() <= cluster["radius"] * (1.0 + 1e-12)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normals.astype(float), axis=1)
        some = length > 1e-6
        along = normals[some] / length[some, None] @ cluster["axis"]
        assert (along >= cluster["cosine"] - 1e-4).all()


@given(
    seed=st.integers(0, 2**16),
    eye=st.tuples(*[st.floats(-4.0, 4.0)] * 3),
    target=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    one_sided=st.booleans(),
)
def test_nothing_that_may_be_seen_is_left_out(
    seed: int,
    eye: tuple[float, float, float],
    target: tuple[float, float, float],
    one_sided: bool,
) -> None:
    """What is left out faces away, or has all its corners beyond one side of the picture."""
    if np.linalg.norm(np.subtract(target, eye)) < 0.1:
        target = (eye[0] + 1.0, eye[1], eye[2])
    positions, triangles = soup(seed, 150)
    ordered, found, clip = seen(positions, triangles, eye, target, one_sided=one_sided)
    assert as_set(found) <= as_set(ordered)
    left_out = [t for t in ordered.tolist() if tuple(t) not in as_set(found)]
    for corners in positions[np.array(left_out, int).reshape(-1, 3)].astype(float):
        x, y, _, w = (clip @ np.column_stack([corners, np.ones(3)]).T).reshape(4, 3)
        beyond = any((side < 0.0).all() for side in (w + x, w - x, w + y, w - y))
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        away = one_sided and float(normal @ (corners[0] - eye)) >= -1e-9
        assert beyond or away


def test_half_of_a_ball_is_left_out() -> None:
    """Of a fine closed surface about half is gathered if its back is not wanted, else all."""
    positions, triangles = ball(48)
    ordered, found, _ = seen(positions, triangles, (6.0, 0, 0), (0.0, 0, 0), one_sided=True)
    facing = positions[ordered].astype(float).mean(axis=1)[:, 0] > 1.0 / 6.0
    assert as_set(ordered[facing]) <= as_set(found)
    assert facing.mean() <= len(found) / len(ordered) <= facing.mean() + 0.25
    _, found, _ = seen(positions, triangles, (6.0, 0, 0), (0.0, 0, 0), one_sided=False)
    assert len(found) == len(ordered)
    _, found, _ = seen(positions, triangles, (6.0, 0, 0), (12.0, 0, 0), one_sided=False)
    assert not len(found)


def test_a_mesh_without_triangles_has_no_clusters() -> None:
    """And one whose triangles have no area cannot face away."""
    nothing = np.zeros((0, 3), np.uint32)
    ordered, clusters = clusters_of(np.zeros((0, 3), np.float32), nothing)
    assert ordered.shape == (0, 3)
    assert clusters.shape == (0,)
    assert clusters.dtype == CLUSTER
    _, clusters = clusters_of(np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32))
    assert clusters["cosine"].tolist() == [-1.0]


def test_a_cluster_that_barely_faces_away_is_kept() -> None:
    """The margin decides in favour of drawing."""
    positions = np.array([[0, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]], np.float32)
    triangles = np.array([[0, 1, 2]], np.uint32)  # faces +x
    for offset, kept in ((0.5 * MARGIN, True), (3.0 * MARGIN, False)):
        _, found, _ = seen(positions, triangles, (-offset, 0.0, 1.0), (0, 0, 0), one_sided=True)
        assert bool(len(found)) is kept

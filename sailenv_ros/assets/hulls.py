"""Collision shapes of models: convex pieces that together fill what the model fills.

`RawMesh` in, `ConvexShape`s out.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.meshes import RawMesh, components, simplified, welded
from sailenv_ros.extras import need
from sailenv_ros.types.model import ConvexShape

__all__ = ["convex_hull", "convex_parts", "hulls_of_pieces", "merged"]

MAX_HULL_POINTS = 48
MAX_HULLS = 24
THINNEST_M = 0.002
"""Flat pieces are given this thickness: a hull without volume stops nothing."""

LINES = 50
"""Vertical lines along each side that tell where a surface is."""

FEWEST_LINES = 8
"""A part whose top fewer lines meet stays where it is."""

MAX_SHIFT_M = 0.05
"""A part whose top is farther from the surface than this spans a hollow, and stays [m]."""

Floats = NDArray[np.float64]


def merged(meshes: Sequence[RawMesh]) -> RawMesh:
    """Join meshes into one, without normals."""
    starts = np.cumsum([0, *(len(mesh.positions) for mesh in meshes)])
    return RawMesh(
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        uvs=np.concatenate([mesh.uvs for mesh in meshes]),
        triangles=np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
        ),
    )


def convex_hull(points: Floats) -> ConvexShape:
    """Return the hull of points, of at most `MAX_HULL_POINTS` corners."""
    points = np.unique(np.asarray(points, dtype=np.float64).round(5), axis=0)
    corners = _corners(_thickened(points))
    if len(corners) > MAX_HULL_POINTS:
        corners = _fewer(corners)
    return ConvexShape(points=corners)


def hulls_of_pieces(mesh: RawMesh) -> tuple[ConvexShape, ...]:
    """Return one hull for each connected piece: exact for furniture that is joined from boards.

    Pieces inside another one's box are left out; the smallest join their nearest neighbours until
    there are at most `MAX_HULLS`.
    """
    of_triangle = components(mesh)
    clouds = [
        mesh.positions[np.unique(mesh.triangles[of_triangle == k])]
        for k in range(int(of_triangle.max()) + 1)
    ]
    clouds = _without_hidden(clouds)
    while len(clouds) > MAX_HULLS:
        clouds = _smallest_joined(clouds)
    return tuple(convex_hull(cloud) for cloud in clouds)


def convex_parts(mesh: RawMesh, *, threshold: float = 0.08) -> tuple[ConvexShape, ...]:
    """Return a convex decomposition, for what is hollow or branched.

    Notes
    -----
    CoACD (Wei, Liu, Ling and Su, SIGGRAPH 2022) with its fixed seed.
    """
    coacd = need("coacd", "importing a model")
    small = simplified(_closed(mesh), 4000, max_error=0.05)
    low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(small.positions, small.triangles),
        threshold=threshold,
        max_convex_hull=MAX_HULLS,
        preprocess_resolution=50,
        resolution=1000,
        mcts_nodes=10,
        mcts_iterations=40,
        mcts_max_depth=2,
        seed=0,
    )
    # Open meshes are closed by a skin around them, which stands out a little.
    clouds = [np.clip(np.asarray(points), low, high) for points, _ in parts]
    return tuple(convex_hull(np.clip(cloud, low, high)) for cloud in _on_surface(clouds, mesh))


def _on_surface(clouds: Sequence[Floats], mesh: RawMesh) -> list[Floats]:
    """Return the parts with their tops where the surface is, by the median over vertical lines.

    What lies on a seat would hang in the air or sink into it otherwise, by up to 3 cm on a bed.
    """
    low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
    sides = [np.linspace(low[axis], high[axis], LINES + 2)[1:-1] for axis in (0, 1)]
    lines = np.stack(np.meshgrid(*sides), -1).reshape(-1, 2)
    seen = _surface_heights(mesh, lines)
    felt = np.stack([_top_heights(cloud, lines) for cloud in clouds])
    topmost = np.where(np.isnan(felt), -np.inf, felt).argmax(axis=0)
    moved = []
    for k, cloud in enumerate(clouds):
        gaps = (felt[k] - seen)[(topmost == k) & np.isfinite(felt[k]) & np.isfinite(seen)]
        shift = float(np.median(gaps)) if len(gaps) >= FEWEST_LINES else 0.0
        moved.append(cloud - [0.0, 0.0, shift if abs(shift) <= MAX_SHIFT_M else 0.0])
    return moved


def _surface_heights(mesh: RawMesh, lines: Floats) -> Floats:
    """Return (N,) where vertical lines through (N, 2) points leave a mesh upwards, NaN if nowhere.

    NaN, too, where its surface is steeper than 45 degrees.
    """
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    ab, ac = b - a, c - a
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    normals = np.cross(ab, ac)
    flat = np.abs(normals[:, 2]) > np.sqrt(0.5) * np.linalg.norm(normals, axis=1)
    seen = np.abs(area) > 1e-12
    a, ab, ac, area, flat = a[seen], ab[seen], ac[seen], area[seen], flat[seen]
    heights = np.full(len(lines), np.nan)
    for row, (x, y) in enumerate(lines):
        u = ((x - a[:, 0]) * ac[:, 1] - (y - a[:, 1]) * ac[:, 0]) / area
        v = (ab[:, 0] * (y - a[:, 1]) - ab[:, 1] * (x - a[:, 0])) / area
        met = np.flatnonzero((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0))
        if len(met):
            z = a[met, 2] + u[met] * ab[met, 2] + v[met] * ac[met, 2]
            if flat[met[z.argmax()]]:
                heights[row] = z.max()
    return heights


def _top_heights(cloud: Floats, lines: Floats) -> Floats:
    """Return (N,) where vertical lines through (N, 2) points leave a hull, NaN where they miss."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        planes = ConvexHull(cloud).equations
    except QhullError:
        return np.full(len(lines), np.nan)
    level = -(lines @ planes[:, :2].T + planes[:, 3])
    up, down = planes[:, 2] > 1e-9, planes[:, 2] < -1e-9
    top = np.min(level[:, up] / planes[up, 2], axis=1)
    bottom = np.max(level[:, down] / planes[down, 2], axis=1)
    inside = (level[:, ~up & ~down] >= 0.0).all(axis=1)
    heights: Floats = np.where(inside & (bottom <= top), top, np.nan)
    return heights


def _closed(mesh: RawMesh) -> RawMesh:
    """Join what lies at one place, whatever its texture coordinates."""
    return welded(dataclasses.replace(mesh, uvs=np.zeros_like(mesh.uvs)))


def _thickened(points: Floats) -> Floats:
    """Return what is flat along an axis a little depth."""
    low, high = points.min(axis=0), points.max(axis=0)
    for axis in np.flatnonzero(high - low < THINNEST_M):
        lifted = points.copy()
        points = points.copy()
        points[:, axis] = (low[axis] + high[axis] - THINNEST_M) / 2.0
        lifted[:, axis] = (low[axis] + high[axis] + THINNEST_M) / 2.0
        points = np.concatenate([points, lifted])
    return points


def _corners(points: Floats) -> Floats:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:  # flat along no axis: its box is as good
        low, high = points.min(axis=0), points.max(axis=0)
        grid = np.array(np.meshgrid(*np.stack([low, high], axis=1))).reshape(3, -1).T
        return _thickened(grid)


def _fewer(corners: Floats) -> Floats:
    """Keep what it stands on, so that it stands, and of the rest what is far apart."""
    depth = max(1e-4, 0.01 * float(np.ptp(corners[:, 2])))
    base = corners[corners[:, 2] < corners[:, 2].min() + depth]
    base = base[_farthest(base, min(len(base), MAX_HULL_POINTS // 3))]
    rest = corners[_farthest(corners, MAX_HULL_POINTS - len(base))]
    return np.unique(np.concatenate([base, rest]), axis=0)


def _farthest(points: Floats, count: int) -> NDArray[np.int64]:
    """Choose points that are far from one another, beginning with the extreme ones."""
    chosen = list(dict.fromkeys([*points.argmin(axis=0), *points.argmax(axis=0)]))
    distance = np.min([np.linalg.norm(points - points[k], axis=1) for k in chosen], axis=0)
    while len(chosen) < count:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def _without_hidden(clouds: list[Floats]) -> list[Floats]:
    lows = np.array([cloud.min(axis=0) for cloud in clouds])
    highs = np.array([cloud.max(axis=0) for cloud in clouds])
    volumes = np.prod(highs - lows, axis=1)
    order = np.argsort(-volumes, kind="stable")
    kept: list[int] = []
    for k in order:
        inside = (
            (lows[kept] <= lows[k] + 1e-4).all(axis=1)
            & (highs[kept] >= highs[k] - 1e-4).all(axis=1)
            & _dense(clouds, kept, volumes)
        )
        if not inside.any():
            kept.append(int(k))
    return [clouds[k] for k in sorted(kept)]


def _dense(clouds: list[Floats], kept: list[int], volumes: Floats) -> NDArray[np.bool_]:
    """Return which pieces have a hull that fills most of their box and hides what is in it."""
    return np.array([_hull_volume(clouds[k]) > 0.8 * volumes[k] for k in kept], dtype=bool)


def _hull_volume(cloud: Floats) -> float:
    from scipy.spatial import ConvexHull, QhullError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return float(ConvexHull(cloud).volume)
    except (QhullError, ValueError):
        return 0.0


def _smallest_joined(clouds: list[Floats]) -> list[Floats]:
    middles = np.array([(cloud.min(axis=0) + cloud.max(axis=0)) / 2.0 for cloud in clouds])
    sizes = np.array([np.linalg.norm(np.ptp(cloud, axis=0)) for cloud in clouds])
    smallest = int(sizes.argmin())
    distances = np.linalg.norm(middles - middles[smallest], axis=1)
    distances[smallest] = np.inf
    nearest = int(distances.argmin())
    joined = np.concatenate([clouds[smallest], clouds[nearest]])
    return [c for k, c in enumerate(clouds) if k not in (smallest, nearest)] + [joined]

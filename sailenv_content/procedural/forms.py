"""Forms that everyday things are made of: turned, swept, extruded, lofted, stood upright.

Plain arrays in, `RawMesh` out. Faces look outwards; creases are found when meshes are finished.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from sailenv_content.procedural.shapes import Vector3, raw_mesh
from sailenv_ros.assets.hulls import merged
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.solids import sphere_mesh

__all__ = [
    "capsule_outline",
    "circle",
    "curve",
    "ellipsoid",
    "lathe",
    "loft",
    "merged",
    "moved",
    "moved_part",
    "panel",
    "rectangle",
    "slab",
    "standing",
    "tube",
    "upright_ring",
]

Floats = NDArray[np.float64]


def loft(rings: ArrayLike, *, closed: bool = True, caps: bool = True) -> RawMesh:
    """Return the skin over rings of points, one after the other.

    Parameters
    ----------
    rings : (R, C, 3) array-like
        Counter-clockwise seen from where the rings go.
    closed : bool
        True joins the last point of each ring with its first.
    caps : bool
        True closes the first and the last ring by a fan around its middle.
    """
    points = np.asarray(rings, np.float64)
    if closed:  # the seam has both ends of the texture
        points = np.concatenate([points, points[:, :1]], axis=1)
    rows, columns = points.shape[:2]
    # A picture is as high as the skin is long, so that it is not stretched where rings are far.
    steps = np.linalg.norm(np.diff(points, axis=0), axis=2).mean(axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    u, v = np.meshgrid(np.linspace(0.0, 1.0, columns), along / max(along[-1], 1e-12))
    positions, uvs = points.reshape(-1, 3), np.stack([u, v], axis=-1).reshape(-1, 2)
    place = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = place[:-1, :-1], place[:-1, 1:], place[1:, 1:], place[1:, :-1]
    sides = [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
    triangles = np.concatenate([side.reshape(-1, 3) for side in sides])
    if caps:
        for row, turned in ((0, True), (rows - 1, False)):
            middle = points[row, :-1].mean(axis=0) if closed else points[row].mean(axis=0)
            first, second = place[row, :-1], place[row, 1:]
            hub = np.full(len(first), len(positions))
            fan = np.stack([second, first, hub] if turned else [first, second, hub], -1)
            positions = np.concatenate([positions, middle[None]])
            uvs = np.concatenate([uvs, [[0.5, 0.5]]])
            triangles = np.concatenate([triangles, fan])
    return RawMesh(positions=positions, uvs=uvs, triangles=triangles)


def circle(count: int = 32) -> Floats:
    """Return (count, 2) points of the unit circle, counter-clockwise."""
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.stack([np.cos(turn), np.sin(turn)], axis=-1)


def lathe(profile: ArrayLike, segments: int = 32) -> RawMesh:
    """Return what a lathe makes of a profile: rows of radius and height [m], from the base up.

    A hollow thing's profile goes up outside and down inside. Ends off the axis are closed, but not
    those of a profile that comes back to where it began: it makes a ring.
    """
    outline = np.asarray(profile, np.float64)
    ring = circle(segments)
    rings = np.empty((len(outline), segments, 3))
    rings[..., :2] = outline[:, None, :1] * ring
    rings[..., 2] = outline[:, 1:]
    return loft(rings, caps=not np.array_equal(outline[0], outline[-1]))


def upright_ring(place: Vector3, radius_y: float, radius_z: float, count: int = 32) -> Floats:
    """Return (count, 3) points of an ellipse about a place [m], which looks along x."""
    ring = circle(count)
    zero = np.zeros(count)
    upright = np.stack([zero, radius_y * ring[:, 0], radius_z * ring[:, 1]], axis=-1)
    return np.asarray(upright + np.asarray(place), np.float64)


def curve(points: ArrayLike, count: int, *, closed: bool = False) -> Floats:
    """Return (count, 3) points of a smooth curve through points."""
    given = np.asarray(points, np.float64)
    if closed:
        given = np.concatenate([given, given[:1]])
    steps = np.linalg.norm(np.diff(given, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    spline = CubicSpline(along, given, bc_type="periodic" if closed else "natural")
    at = np.linspace(0.0, along[-1], count, endpoint=not closed)
    return np.asarray(spline(at), np.float64)


def tube(
    path: ArrayLike, radius: float | ArrayLike, *, sides: int = 10, closed: bool = False
) -> RawMesh:
    """Return a round tube along a path (N, 3); `radius` [m] may differ from point to point."""
    points = np.asarray(path, np.float64)
    if closed:
        points = np.concatenate([points, points[:1]])
        ahead = np.roll(points[:-1], -1, axis=0) - np.roll(points[:-1], 1, axis=0)
        ahead = np.concatenate([ahead, ahead[:1]])
    else:
        ahead = np.gradient(points, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    normal = np.cross(ahead[0], np.eye(3)[np.argmin(np.abs(ahead[0]))])
    frames = []
    for direction in ahead:  # the frame is carried along without a twist
        normal = normal - direction * (normal @ direction)
        normal = normal / np.linalg.norm(normal)
        frames.append((normal, np.cross(direction, normal)))
    side, up = (np.array(axes) for axes in zip(*frames, strict=True))
    radii = np.broadcast_to(np.asarray(radius, np.float64), (len(points),))[:, None, None]
    ring = circle(sides)
    offsets = ring[None, :, :1] * side[:, None] + ring[None, :, 1:] * up[:, None]
    return loft(points[:, None] + radii * offsets, caps=not closed)


def rectangle(width: float, depth: float, radius: float, steps: int = 6) -> Floats:
    """Return the outline of a rectangle with round corners, `depth` along x, `width` along y."""
    radius = min(radius, 0.499 * width, 0.499 * depth)
    turn = np.linspace(0.0, np.pi / 2.0, steps + 1)
    corner = radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    x, y = depth / 2.0 - radius, width / 2.0 - radius
    quarters = []
    for number, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        c, s = np.cos(number * np.pi / 2.0), np.sin(number * np.pi / 2.0)
        quarters.append(corner @ np.array([[c, s], [-s, c]]) + [sx * x, sy * y])
    return np.concatenate(quarters)


def capsule_outline(length: float, width: float, steps: int = 10) -> Floats:
    """Return the outline of a stadium that is long in x [m]."""
    return rectangle(width, length, width / 2.0, steps)


def slab(outline: ArrayLike, height: float, bevel: float = 0.0, *, steps: int = 3) -> RawMesh:
    """Return an outline (N, 2) in x and y, raised to a height, its edges rounded by `bevel` [m].

    The outline is counter-clockwise, and its middle sees all of it.
    """
    flat = np.asarray(outline, np.float64)
    following, before = np.roll(flat, -1, axis=0), np.roll(flat, 1, axis=0)
    along = following - before
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-12)[:, None]
    inward = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    bevel = min(bevel, 0.499 * height)
    if bevel > 0.0:
        turn = np.linspace(0.0, np.pi / 2.0, steps + 1)
        inset, rise = bevel * (1.0 - np.sin(turn)), bevel * (1.0 - np.cos(turn))
        insets = np.concatenate([inset, inset[::-1]])
        heights = np.concatenate([rise, height - rise[::-1]])
    else:
        insets, heights = np.zeros(2), np.array([0.0, height])
    rings = np.empty((len(insets), len(flat), 3))
    rings[..., :2] = flat + insets[:, None, None] * inward
    rings[..., 2] = heights[:, None]
    return loft(rings)


def ellipsoid(radii: Vector3, centre: Vector3, segments: int = 24) -> RawMesh:
    """Return an ellipsoid."""
    ball = raw_mesh(sphere_mesh(1.0, segments))
    return RawMesh(
        positions=ball.positions * np.asarray(radii) + np.asarray(centre),
        uvs=ball.uvs,
        triangles=ball.triangles,
    )


def panel(depth: float, width: float, z: float, *, y_up: bool = True) -> RawMesh:
    """Return a rectangle that looks up, with its picture's top towards -x, read from +x."""
    x, y = depth / 2.0, width / 2.0
    corners = [[x, -y, z], [x, y, z], [-x, y, z], [-x, -y, z]]
    uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    if not y_up:
        uvs = [[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]
    return RawMesh(
        positions=np.array(corners),
        uvs=np.array(uvs),
        triangles=np.array([[0, 1, 2], [0, 2, 3]]),
    )


def moved(
    mesh: RawMesh, by: ArrayLike = (0.0, 0.0, 0.0), turn_deg: ArrayLike = (0.0, 0.0, 0.0)
) -> RawMesh:
    """Return a mesh turned about the fixed axes x, y and z [deg], then shifted [m]."""
    turn = Rotation.from_euler("xyz", np.asarray(turn_deg, np.float64), degrees=True)
    normals = None if mesh.normals is None else turn.apply(mesh.normals)
    positions = turn.apply(mesh.positions) + np.asarray(by, np.float64)
    return dataclasses.replace(mesh, positions=positions, normals=normals)


def moved_part(
    part: RawPart, by: ArrayLike = (0.0, 0.0, 0.0), turn_deg: ArrayLike = (0.0, 0.0, 0.0)
) -> RawPart:
    """Return a part whose mesh is `moved`."""
    return dataclasses.replace(part, mesh=moved(part.mesh, by, turn_deg))


def standing(parts: Sequence[RawPart], scale: float = 1.0) -> list[RawPart]:
    """Return parts with the origin at the middle of their base."""
    points = np.concatenate([part.mesh.positions for part in parts])
    low, high = points.min(axis=0), points.max(axis=0)
    base = np.array([*(low[:2] + high[:2]) / 2.0, low[2]])
    return [
        dataclasses.replace(
            part,
            mesh=dataclasses.replace(part.mesh, positions=scale * (part.mesh.positions - base)),
        )
        for part in parts
    ]

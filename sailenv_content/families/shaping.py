"""Forms that furniture is made of: boards with bevelled edges, cushions, shells, turned legs.

Numbers in, finished `Mesh`es out. Boards have their grain along the longest side, and texture
coordinates in metres; all forms are closed but for sheets.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from sailenv_content.procedural.forms import lathe, loft, slab, tube
from sailenv_ros.assets.meshes import RawMesh, packed, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = [
    "Floats",
    "along_the_axis",
    "board",
    "cushion",
    "extruded",
    "placed",
    "ribbon",
    "swept",
    "turned",
    "with_uvs",
]

Floats = NDArray[np.float64]
Vector3 = tuple[float, float, float]

_SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)


@lru_cache(maxsize=1)
def _board_template() -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return corner and face of 24 vertices, and the 44 triangles between them."""
    corner = np.array([c for f in range(6) for c in range(8) if _SIGNS[c, f // 2] == _side(f)])
    face = np.repeat(np.arange(6), 4)
    place = {(int(c), int(f)): n for n, (c, f) in enumerate(zip(corner, face, strict=True))}
    triangles: list[tuple[int, int, int]] = []

    def fan(names: list[tuple[int, int]]) -> None:
        points = np.array([_SIGNS[c] + 0.2 * _normal(f) for c, f in names])
        middle = points.mean(axis=0)
        normal = np.cross(points[1] - points[0], points[2] - points[0])
        order = names if normal @ middle > 0.0 else names[::-1]
        numbers = [place[name] for name in order]
        triangles.extend(
            (numbers[0], numbers[k], numbers[k + 1]) for k in range(1, len(numbers) - 1)
        )

    for f in range(6):
        a, b = [k for k in range(3) if k != f // 2]
        ring = sorted(
            (c for c in range(8) if _SIGNS[c, f // 2] == _side(f)),
            key=lambda c: np.arctan2(_SIGNS[c, b], _SIGNS[c, a]),
        )
        fan([(c, f) for c in ring])
    for c in range(8):
        mine = [2 * axis + int(_SIGNS[c, axis] > 0) for axis in range(3)]
        fan([(c, f) for f in mine])
        for axis in range(3):  # the edge along this axis, from its lower end
            if _SIGNS[c, axis] < 0.0:
                other = int(np.flatnonzero((_SIGNS[c] * _flip(axis) == _SIGNS).all(axis=1))[0])
                first, second = (f for f in mine if f // 2 != axis)
                fan([(c, first), (other, first), (other, second), (c, second)])
    return corner, face, np.array(triangles)


def _side(face: int) -> float:
    return 1.0 if face % 2 else -1.0


def _normal(face: int) -> Floats:
    normal = np.zeros(3)
    normal[face // 2] = _side(face)
    return normal


def _flip(axis: int) -> Floats:
    flip = np.ones(3)
    flip[axis] = -1.0
    return flip


def board(
    size: Vector3,
    *,
    bevel: float = 0.002,
    tile_m: float = 1.0,
    shift: tuple[float, float] = (0.0, 0.0),
    top: tuple[float, float] = (1.0, 1.0),
    lean: tuple[float, float] = (0.0, 0.0),
) -> Mesh:
    """Return a board around the origin.

    Parameters
    ----------
    size : (3,) tuple of float
        [m].
    bevel : float
        Width of its rounded edges [m].
    tile_m : float
        Edge of what the texture shows [m].
    shift : (2,) tuple of float
        Of the texture, in tiles: no two boards are cut from the same place.
    top : (2,) tuple of float
        Size of its upper end as a share of its lower one: a leg that tapers.
    lean : (2,) tuple of float
        Shift of its upper end against the lower one, along x and y [m].
    """
    corner, face, triangles = _board_template()
    half = np.asarray(size, np.float64) / 2.0
    bevel = min(bevel, 0.4 * float(half.min()))
    normals = np.array([_normal(f) for f in range(6)])[face]
    points = _SIGNS[corner] * (half - bevel) + normals * bevel
    long = int(np.argmax(half))
    uvs = np.empty((24, 2))
    for f in range(6):
        rest = [k for k in range(3) if k != f // 2]
        along = long if long in rest else rest[0]
        across = rest[0] if rest[1] == along else rest[1]
        mine = face == f
        uvs[mine, 0] = points[mine, along] / tile_m + shift[0]
        uvs[mine, 1] = points[mine, across] / tile_m + shift[1] + 0.37 * f
    share = points[:, 2] / size[2] + 0.5
    points[:, :2] *= 1.0 + (np.asarray(top) - 1.0) * share[:, None]
    points[:, :2] += np.asarray(lean) * (share[:, None] - 0.5)
    return packed(points, normals, uvs, triangles)


@lru_cache(maxsize=8)
def _ball(steps: int) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64]]:
    """Return a cube's surface in steps: (N, 3) from -1 to 1, faces (N,), triangles."""
    ticks = np.linspace(-1.0, 1.0, steps + 1)
    a, b = (g.reshape(-1) for g in np.meshgrid(ticks, ticks, indexing="ij"))
    points, faces, triangles = [], [], []
    cell = np.arange(steps)
    low = (cell[:, None] * (steps + 1) + cell).reshape(-1)
    quad = np.stack([low, low + steps + 1, low + steps + 2, low + 1], axis=-1)
    for f in range(6):
        axis = f // 2
        one, two = (axis + 1) % 3, (axis + 2) % 3
        face = np.empty((len(a), 3))
        face[:, axis], face[:, one], face[:, two] = _side(f), a, b
        turned = quad if _side(f) > 0.0 else quad[:, ::-1]
        turned = turned + f * len(a)
        triangles += [turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]]
        points.append(face)
        faces.append(np.full(len(a), f))
    return np.concatenate(points), np.concatenate(faces), np.concatenate(triangles)


def cushion(
    size: Vector3,
    *,
    radius: float = 0.04,
    puff: float = 0.02,
    tile_m: float = 0.06,
    steps: int = 8,
    pinch: float = 0.0,
) -> Mesh:
    """Return a soft box around the origin: round edges, faces that bulge.

    Parameters
    ----------
    size : (3,) tuple of float
        Without what bulges [m].
    radius : float
        Of its edges [m].
    puff : float
        By which the middle of its larger faces bulges [m]; below 0 hollows them.
    pinch : float
        Share by which its corners are drawn out and its edges thinned: a pillow's 1, a seat's 0.
    """
    cube, faces, triangles = _ball(steps)
    half = np.asarray(size, np.float64) / 2.0
    radius = min(radius, 0.999 * float(half.min()))
    # Points lie closer where the edges are round.
    spread = np.sign(cube) * (1.0 - (1.0 - np.abs(cube)) ** 1.35)
    inner = half - radius
    points = np.clip(spread * half, -half, half)
    core = np.clip(points, -inner, inner)
    out = points - core
    length = np.linalg.norm(out, axis=1, keepdims=True)
    flat = np.eye(3)[faces // 2] * np.sign(cube)
    points = core + radius * np.where(length > 1e-9, out / np.maximum(length, 1e-9), flat)
    thin = int(np.argmin(half))
    wide = [k for k in range(3) if k != thin]
    share = points / half
    dome = np.prod([1.0 - np.clip(np.abs(share[:, k]), 0.0, 1.0) ** 2.5 for k in wide], axis=0)
    if pinch:
        edge = np.max(np.abs(share[:, wide]), axis=1)
        points[:, thin] *= 1.0 - pinch * 0.85 * np.clip(edge, 0.0, 1.0) ** 3
        for k, other in (wide, wide[::-1]):
            points[:, k] *= 1.0 - 0.08 * pinch * (1.0 - np.clip(share[:, other], -1, 1) ** 2)
    points[:, thin] += puff * dome * np.sign(share[:, thin])
    normals = _shared_normals(points, triangles)
    uvs = np.empty((len(points), 2))
    for f in range(6):
        mine, rest = faces == f, [k for k in range(3) if k != f // 2]
        uvs[mine] = points[mine][:, rest] / tile_m
    return packed(points, normals, uvs, triangles)


def _shared_normals(points: Floats, triangles: NDArray[np.int64]) -> Floats:
    """Return smooth normals, the same for vertices at the same place."""
    _, place = np.unique(points.round(6), axis=0, return_inverse=True)
    place = place.reshape(-1)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    total = np.zeros((place.max() + 1, 3))
    for k in range(3):
        np.add.at(total, place[triangles[:, k]], faces)
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-20)
    return np.asarray(total[place])


def turned(
    profile: ArrayLike, *, segments: int = 20, tile_m: float = 1.0, crease_deg: float = 40.0
) -> Mesh:
    """Return what a lathe makes of rows of radius and height [m], from the base up."""
    outline = np.asarray(profile, np.float64)
    return along_the_axis(lathe(outline, segments), outline, tile_m, crease_deg)


def along_the_axis(raw: RawMesh, outline: Floats, tile_m: float, crease_deg: float) -> Mesh:
    """Return what rows of radius and height [m] make as they turn, its fibres along the axis."""
    around = 2.0 * np.pi * float(outline[:, 0].max())
    length = float(np.linalg.norm(np.diff(outline, axis=0), axis=1).sum())
    uvs = raw.uvs[:, ::-1] * (length / tile_m, around / tile_m)
    return smooth_mesh(
        RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), crease_deg
    )


def swept(
    path: ArrayLike, radius: float | ArrayLike, *, sides: int = 10, tile_m: float = 1.0
) -> Mesh:
    """Return a round rod along a path (N, 3) [m]."""
    points = np.asarray(path, np.float64)
    raw = tube(points, radius, sides=sides)
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    around = 2.0 * np.pi * float(np.max(radius))
    uvs = raw.uvs[:, ::-1] * (length / tile_m, around / tile_m)
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles))


def extruded(
    outline: ArrayLike, height: float, *, bevel: float = 0.003, tile_m: float = 1.0
) -> Mesh:
    """Return an outline (N, 2) in x and y, counter-clockwise, raised to a height [m].

    Its grain runs along the longer of x and y.
    """
    raw = slab(outline, height, bevel, steps=2)
    flat = raw.positions
    long = int(np.ptp(flat[:, 1]) >= np.ptp(flat[:, 0]))
    uvs = flat[:, [long, 1 - long]] / tile_m + flat[:, [2]] * (0.0, 1.0) / tile_m
    return smooth_mesh(RawMesh(positions=flat, uvs=uvs, triangles=raw.triangles), 50.0)


def ribbon(
    profile: ArrayLike,
    width: float | ArrayLike,
    thickness: float,
    *,
    tile_m: float = 1.0,
    dish: float = 0.0,
    round_m: float = 0.0,
) -> Mesh:
    """Return a bent shell: a strip along a profile in x and z, as wide as `width` along y.

    Parameters
    ----------
    profile : (N, 2) array-like
        Its middle line: x and z [m]; the shell lies to its left.
    width : float or (N,) array-like
        [m].
    dish : float
        By which its sides rise above its middle [m].
    round_m : float
        By which its ends are rounded [m].
    """
    line = np.asarray(profile, np.float64)
    widths = np.broadcast_to(np.asarray(width, np.float64), (len(line),)).copy()
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    if round_m:
        for end in (along, along[-1] - along):
            near = np.clip(1.0 - end / round_m, 0.0, 1.0)
            widths -= 2.0 * round_m * (1.0 - np.sqrt(1.0 - near**2))
        widths = np.maximum(widths, 0.01)
    ahead = np.gradient(line, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
    across = np.linspace(-1.0, 1.0, 9)
    half = thickness / 2.0
    # A ring around the strip's section: below from right to left, above from left to right.
    u = np.concatenate([across, across[::-1]])
    lift = np.concatenate([np.full(9, -half), np.full(9, half)])
    lift[[0, 8, 9, 17]] *= 0.45
    y = u[None, :] * widths[:, None] / 2.0
    height = lift[None, :] + dish * (u**2)[None, :]
    rings = np.empty((len(line), 18, 3))
    rings[..., 0] = line[:, None, 0] + left[:, None, 0] * height
    rings[..., 1] = y
    rings[..., 2] = line[:, None, 1] + left[:, None, 1] * height
    raw = loft(rings)
    uvs = np.empty((len(raw.positions), 2))
    uvs[:, 0] = raw.uvs[:, 1] * along[-1] / tile_m
    uvs[:, 1] = raw.positions[:, 1] / tile_m
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 60.0)


def placed(
    mesh: Mesh, at: ArrayLike = (0.0, 0.0, 0.0), turn_deg: ArrayLike = (0.0, 0.0, 0.0)
) -> Mesh:
    """Return a mesh turned about the fixed axes x, y and z [deg], then shifted [m]."""
    angles = np.asarray(turn_deg, np.float64)
    positions, normals = mesh.positions.astype(np.float64), mesh.normals
    if angles.any():
        turn = Rotation.from_euler("xyz", angles, degrees=True)
        positions, normals = turn.apply(positions), turn.apply(normals).astype(np.float32)
    moved = (positions + np.asarray(at, np.float64)).astype(np.float32)
    return Mesh(positions=moved, normals=normals, uvs=mesh.uvs, triangles=mesh.triangles)


def with_uvs(mesh: Mesh, axes: tuple[int, int], low: ArrayLike, size: ArrayLike) -> Mesh:
    """Return a mesh with a picture laid over it, as one sees it who looks along the third axis."""
    places = (mesh.positions[:, axes] - np.asarray(low)) / np.asarray(size)
    return Mesh(
        positions=mesh.positions,
        normals=mesh.normals,
        uvs=places.astype(np.float32),
        triangles=mesh.triangles,
    )

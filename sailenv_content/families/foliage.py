"""Leaves and stems of plants, and the pots that they grow in."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.lathe import smooth_profile, vessel
from sailenv_content.families.materials import PieceMaterial, paint
from sailenv_content.families.shaping import Floats, swept, turned
from sailenv_content.procedural.forms import curve
from sailenv_ros.types.model import Mesh

__all__ = [
    "BARK",
    "DARK",
    "DEEP",
    "FRESH",
    "GREY",
    "LEAF_WIDTHS",
    "SOIL",
    "STEM",
    "bush",
    "leaf",
    "place_leaves",
    "planter",
    "stem",
    "tones",
]

SOIL = paint("#3a2d22", 0.95, 900.0)
BARK = paint("#6b5540", 0.9, 600.0)
STEM = paint("#5f7a3f", 0.6, 700.0)


def tones(*colours: str) -> tuple[PieceMaterial, ...]:
    """Return leaves of some colours."""
    return tuple(paint(c, 0.45, 400.0) for c in colours)


DEEP = tones("#24452a", "#2d5530", "#356238")
FRESH = tones("#4a7a36", "#5a8c40", "#6c9a4a")
GREY = tones("#6f8a6a", "#7d9878", "#8aa586")
DARK = tones("#1f3a2a", "#274a30", "#4a2f35")

LEAF_WIDTHS: dict[str, tuple[float, ...]] = {
    "oval": (0.05, 0.5, 0.85, 1.0, 0.95, 0.75, 0.4, 0.02),
    "lance": (0.1, 0.6, 0.95, 1.0, 0.85, 0.6, 0.3, 0.02),
    "heart": (0.35, 1.0, 0.98, 0.85, 0.65, 0.45, 0.22, 0.02),
    "strap": (0.6, 0.85, 0.95, 1.0, 0.95, 0.85, 0.6, 0.03),
    "leaflet": (0.25, 1.0, 0.75, 0.03),
    "lobed": (0.3, 1.0, 0.5, 0.98, 0.42, 0.85, 0.35, 0.6, 0.25, 0.02),
}
"""Half widths along a leaf, as shares of the greatest."""


def leaf(
    length: float,
    width: float,
    kind: str = "oval",
    *,
    droop: float = 0.3,
    fold: float = 0.15,
    wave: float = 0.0,
    stalk: float = 0.0,
) -> Mesh:
    """Return a leaf from the origin along x, its upper side at +z, closed by its back.

    Parameters
    ----------
    length, width : float
        [m].
    droop : float
        By which its tip bends down, as a share of its length.
    fold : float
        By which its edges rise above its middle rib, as a share of its width.
    wave : float
        Of its edges, as a share of its width.
    stalk : float
        Share of its length that is a thin stalk.
    """
    widths = np.array(LEAF_WIDTHS[kind])
    t = np.linspace(0.0, 1.0, len(widths))
    half = 0.5 * width * widths
    if stalk:
        t = np.concatenate([[0.0], stalk + (1.0 - stalk) * t])
        half = np.concatenate([[0.03 * width], half])
    angle = 2.0 * droop * t
    steps = np.diff(t, prepend=0.0) * length
    x, z = np.cumsum(steps * np.cos(angle)), -np.cumsum(steps * np.sin(angle))
    lift = fold * half * 2.0 + wave * width * np.sin(9.0 * t)
    lift = lift * (half > 0.1 * half.max())
    top = np.empty((len(t), 3, 3))
    for column, sign in enumerate((-1.0, 0.0, 1.0)):
        top[:, column, 0] = x
        top[:, column, 1] = sign * half
        top[:, column, 2] = z + (lift if sign else 0.0)
    points = top.reshape(-1, 3)
    low = np.arange(len(t) - 1)[:, None] * 3 + np.arange(2)
    a = low.reshape(-1)
    quads = np.stack([a, a + 3, a + 4, a + 1], -1)
    front = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    normals = _normals(points, front)
    uvs = np.stack([np.repeat(t, 3), np.tile([0.0, 0.5, 1.0], len(t))], -1)
    return Mesh(
        positions=np.concatenate([points, points]).astype(np.float32),
        normals=np.concatenate([normals, -normals]).astype(np.float32),
        uvs=np.concatenate([uvs, uvs]).astype(np.float32),
        triangles=np.concatenate([front, front[:, ::-1] + len(points)]).astype(np.uint32),
    )


def _normals(points: Floats, triangles: np.ndarray) -> Floats:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    total = np.zeros_like(points)
    for k in range(3):
        np.add.at(total, triangles[:, k], faces)
    total[:, 2] += 1e-9
    return np.asarray(total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-20))


def place_leaves(
    b: PieceBuilder,
    material: PieceMaterial,
    mesh: Mesh,
    at: ArrayLike,
    *,
    yaw_deg: ArrayLike,
    rise_deg: ArrayLike,
    roll_deg: ArrayLike = 0.0,
) -> None:
    """Add leaves that grow from (N, 3) places, in directions about z and above the horizon."""
    places = np.asarray(at, np.float64).reshape(-1, 3)
    count = len(places)
    angles = [
        np.broadcast_to(np.asarray(a, np.float64), (count,)) for a in (roll_deg, rise_deg, yaw_deg)
    ]
    turns = Rotation.from_euler("xyz", np.stack(angles, -1) * (1, -1, 1), degrees=True).as_matrix()
    positions = np.einsum("nij,vj->nvi", turns, mesh.positions) + places[:, None]
    normals = np.einsum("nij,vj->nvi", turns, mesh.normals)
    first = np.arange(count)[:, None, None] * len(mesh.positions)
    whole = Mesh(
        positions=positions.reshape(-1, 3).astype(np.float32),
        normals=normals.reshape(-1, 3).astype(np.float32),
        uvs=np.tile(mesh.uvs, (count, 1)),
        triangles=(mesh.triangles[None] + first).reshape(-1, 3).astype(np.uint32),
    )
    b.form(material, whole, collides="none", volume=2e-6 * count)


def bush(b: PieceBuilder, low: float, high: float, radius: float) -> None:
    """Let the leaves collide as one rounded body."""
    mid, t = (low + high) / 2, np.linspace(-np.pi / 2, np.pi / 2, 7)
    rows = np.stack([0.75 * radius * np.cos(t), mid + 0.42 * (high - low) * np.sin(t)], -1)
    rows[[0, -1], 0] = 0.0
    b.hull(turned(rows, segments=10), (0.0, 0.0, 0.0))


def stem(
    b: PieceBuilder,
    soil: float,
    tall: float,
    lean: float,
    thick: float,
    yaw: float,
    material: PieceMaterial = BARK,
) -> Floats:
    """Add a stem that bends; return places along it."""
    c, s = np.cos(yaw), np.sin(yaw)
    path = curve(
        [
            (0, 0, soil - 0.02),
            (0.15 * lean * c, 0.15 * lean * s, soil + 0.4 * tall),
            (lean * c, lean * s, soil + tall),
        ],
        24,
    )
    b.form(material, swept(path, np.linspace(thick, 0.5 * thick, 24), sides=9), collides="none")
    return path


def planter(
    b: PieceBuilder, material: PieceMaterial, radius: float, height: float, kind: str
) -> float:
    """Add a pot full of soil; return the height of the soil [m]."""
    profiles = {
        "cone": ((0.72, 0.0), (0.75, 0.02), (1.0, 1.0)),
        "cylinder": ((0.97, 0.0), (1.0, 0.03), (1.0, 1.0)),
        "round": ((0.6, 0.0), (0.9, 0.25), (1.0, 0.55), (0.85, 1.0)),
        "rim": ((0.7, 0.0), (0.88, 0.76), (1.0, 0.78), (1.0, 1.0)),
    }
    rows = np.array(profiles[kind]) * (radius, height)
    if kind == "round":
        rows = smooth_profile(rows, 16)
    b.form(material, vessel(rows, wall=0.05 * radius + 0.002, floor=0.4 * height, segments=36))
    level = 0.88 * height
    wall, low = 0.05 * radius + 0.003, level - 0.02
    inner, under = (float(np.interp(z, rows[:, 1], rows[:, 0])) - wall for z in (level, low))
    soil = [(0, low), (min(inner, under), low), (inner, level), (0.4 * inner, level + 0.008)]
    soil.append((0, level + 0.01))
    b.form(SOIL, turned(soil, segments=28), collides="none")
    return level

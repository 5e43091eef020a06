"""Ears and eyes of an animal: pieces of their own, set into its head."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.anatomy import Anatomy
from sailenv_content.animals.shape import EYE
from sailenv_content.people.pieces import vertex_normals
from sailenv_ros.types.geometry import Pose

__all__ = ["Piece", "ear", "eye"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

_ROWS, _ACROSS = 14, 9


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A closed mesh that one joint carries.

    Attributes
    ----------
    joint : str
    vertices, normals : (V, 3) float64
    uvs : (V, 2) float64
    triangles : (T, 3) int64
    """

    joint: str
    vertices: Doubles
    normals: Doubles
    uvs: Doubles
    triangles: Indices


def ear(anatomy: Anatomy, side: str) -> Piece:
    """Return an ear: two sheets, whose edges meet. The inner one has u above 0.5."""
    look, sign = anatomy.look, 1.0 if side == "L" else -1.0
    shape = _pricked if look.ears == "pricked" else _hanging
    middles, across, inwards, wide, cup = shape(look.kind)
    size = anatomy.head_m * look.ear_size
    t = np.linspace(-1.0, 1.0, _ACROSS)
    bend = np.sqrt(np.maximum(1.0 - t * t, 0.0))
    outer = middles[:, None] + wide[:, None, None] * (
        t[None, :, None] * across[:, None] - (cup[:, None] * bend)[..., None] * inwards[:, None]
    )
    thin = 0.030 * np.minimum(1.0, wide / wide.max() + 0.2)
    inner = outer + (thin[:, None] * bend[None])[..., None] * inwards[:, None]
    loops = np.concatenate([outer, inner[:, -2:0:-1]], axis=1)
    share = np.concatenate([np.linspace(0.02, 0.48, _ACROSS), np.linspace(0.56, 0.94, _ACROSS - 2)])
    rows = np.linspace(0.03, 0.97, _ROWS)
    uvs = np.stack(np.broadcast_arrays(share[None], rows[:, None]), axis=-1)
    count = loops.shape[1]
    ends = np.stack([loops[0].mean(axis=0), loops[-1].mean(axis=0)])
    vertices = np.concatenate([loops.reshape(-1, 3), ends]) * size * [1.0, sign, 1.0]
    vertices = vertices + anatomy[f"ear.{side}"]
    uvs = np.concatenate([uvs.reshape(-1, 2), [[0.25, 0.01], [0.25, 0.99]]])
    triangles = _lofted(_ROWS, count)
    if sign < 0.0:
        triangles = triangles[:, ::-1]
    corners = vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if float(np.einsum("tk,tk->", corners[:, 0], areas)) < float(
        np.einsum("k,tk->", vertices.mean(axis=0), areas)
    ):
        triangles = triangles[:, ::-1]
    normals = vertex_normals(vertices, triangles)
    return Piece(f"ear.{side}", vertices, normals, uvs, triangles)


Sheet = tuple[Doubles, Doubles, Doubles, Doubles, Doubles]
"""Rows of an ear: middles, directions across, directions in which the inner sheet looks, half
widths, and how much it is cupped; over the head's length."""


def _pricked(kind: str) -> Sheet:
    rise = np.linspace(0.0, 1.0, _ROWS)
    tall, broad = (0.56, 0.225) if kind == "cat" else (0.50, 0.165)
    lean = np.array([-0.02, 0.24, 1.0]) if kind == "cat" else np.array([-0.05, 0.14, 1.0])
    lean = lean / np.linalg.norm(lean)
    look = _turn(32.0 if kind == "cat" else 28.0, 0.0) @ np.array([1.0, 0.0, 0.12])
    look = look - (look @ lean) * lean
    look /= np.linalg.norm(look)
    across = np.cross(look, lean)
    middles = (rise * tall - 0.17)[:, None] * lean + 0.04 * (rise**2)[:, None] * look
    wide = broad * np.maximum(1.0 - rise**1.25, 0.0) ** 0.9 + 0.010
    # Its base lies within the skull.
    wide *= np.interp(rise, [0.0, 0.32], [0.45, 1.0])
    ones = np.ones((_ROWS, 1))
    return middles, -across * ones, look * ones, wide, 0.42 * np.ones(_ROWS)


def _hanging(kind: str) -> Sheet:
    share = np.linspace(0.0, 1.0, _ROWS)
    # Out of the skull, over, and down beside the cheek.
    out = np.interp(share, [0.0, 0.22, 0.45, 1.0], [-0.12, 0.035, 0.085, 0.10])
    down = np.interp(share, [0.0, 0.12, 0.25, 1.0], [-0.03, 0.025, 0.00, -0.56])
    ahead = np.interp(share, [0.0, 1.0], [0.0, 0.11])
    middles = np.column_stack([ahead, out, down])
    way = np.gradient(middles, axis=0)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    across = np.tile([1.0, 0.06, 0.0], (_ROWS, 1))
    across -= np.einsum("rk,rk->r", across, way)[:, None] * way
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    inwards = np.cross(across, way)
    inwards *= np.where(inwards[:, 1] > 0.0, -1.0, 1.0)[:, None]
    wide = 0.175 * np.interp(share, [0.0, 0.3, 0.6], [0.40, 0.82, 1.0])
    wide *= np.sqrt(np.clip(1.03 - np.clip((share - 0.6) / 0.4, 0.0, 1.0) ** 2, 0.0, 1.0))
    return middles, across, inwards, wide, 0.16 * np.ones(_ROWS)


def _lofted(rows: int, count: int) -> Indices:
    """Return the triangles between loops, and those of two fans at the ends."""
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(count), indexing="ij")
    a, b = row * count + column, row * count + (column + 1) % count
    c, d = a + count, b + count
    sides = np.stack([a, b, d, a, d, c], axis=-1).reshape(-1, 3)
    ring = np.arange(count)
    after = (ring + 1) % count
    first, last = rows * count, rows * count + 1
    top = (rows - 1) * count
    low = np.stack([np.full(count, first), after, ring], axis=-1)
    high = np.stack([np.full(count, last), top + ring, top + after], axis=-1)
    return np.concatenate([sides, low, high])


def eye(anatomy: Anatomy, side: str, *, rows: int = 10, count: int = 16) -> Piece:
    """Return an eyeball; its uvs have the pupil in the middle."""
    kind, sign = anatomy.look.kind, 1.0 if side == "L" else -1.0
    (x, y, z), radius, outwards = EYE[kind]
    polar, around = np.linspace(0.0, np.pi, rows), np.arange(count) / count * 2.0 * np.pi
    ring = np.stack([
        np.cos(polar)[1:-1, None] * np.ones(count),
        np.sin(polar)[1:-1, None] * np.cos(around),
        np.sin(polar)[1:-1, None] * np.sin(around),
    ], axis=-1).reshape(-1, 3)  # fmt: skip
    own = np.concatenate([ring, [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]])
    normals = own @ _turn(sign * outwards, -8.0).T
    middle = anatomy["head"] + anatomy.head_m * np.array([x, sign * y, z])
    vertices = middle + 0.97 * radius * anatomy.head_m * normals
    uvs = 0.5 + 0.5 * own[:, 1:] / np.maximum(1.0 + own[:, :1], 0.2)
    return Piece("head", vertices, normals, uvs, _lofted(rows - 2, count)[:, ::-1])


def _turn(yaw_deg: float, pitch_deg: float) -> Doubles:
    """Return the rotation of what looks to the left and down [deg]."""
    matrix = Pose.from_rpy_deg((0.0, 0.0, 0.0), (0.0, pitch_deg, yaw_deg)).matrix()
    return np.asarray(matrix[:3, :3], np.float64)

"""Hair: a cap over the scalp, and what hangs from it.

The cap is the scalp's skin, cut at the hairline and moved out; long hair is MakeHuman's hair, of
which what would hang before the face is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.landmarks import Landmarks
from sailenv_content.people.makehuman import BodyData
from sailenv_content.people.pieces import Cut, clipped, vertex_normals

__all__ = ["HAIRSTYLES", "Hairstyle", "hair_pieces"]

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hairstyle:
    """One way to wear hair.

    Attributes
    ----------
    thick_m : float
        Of the cap, at the crown [m].
    length_m : float
        Height to which hair hangs, as `Landmarks.height_m`; 0 for none that hangs [m].
    bun_m : float
        Radius of a bun behind the head; 0 for none [m].
    receded_m : float
        How much higher the hairline is in front and above [m].
    rough_m : float
        Of locks that stand out [m].
    """

    thick_m: float
    length_m: float = 0.0
    bun_m: float = 0.0
    receded_m: float = 0.0
    rough_m: float = 0.003


HAIRSTYLES: Mapping[str, Hairstyle] = MappingProxyType(
    {
        "shorn": Hairstyle(thick_m=0.004, rough_m=0.0005),
        "short": Hairstyle(thick_m=0.014),
        "full": Hairstyle(thick_m=0.026, rough_m=0.006),
        "afro": Hairstyle(thick_m=0.060, rough_m=0.007),
        "thin": Hairstyle(thick_m=0.006, receded_m=0.028, rough_m=0.001),
        "bob": Hairstyle(thick_m=0.016, length_m=0.60),
        "long": Hairstyle(thick_m=0.016, length_m=0.40),
        "bun": Hairstyle(thick_m=0.010, bun_m=0.042, rough_m=0.001),
    }
)


@dataclass(frozen=True, eq=False, slots=True)
class HairPiece:
    """Triangles of hair on a figure.

    Attributes
    ----------
    positions, normals : (N, 3) float64
    uvs : (N, 2) float64
    triangles : (T, 3) int64
    """

    positions: Doubles
    normals: Doubles
    uvs: Doubles
    triangles: NDArray[np.int64]


def hair_pieces(
    data: BodyData, marks: Landmarks, style: Hairstyle, vertices: Doubles, normals: Doubles
) -> list[HairPiece]:
    """Return the pieces of a hairstyle on a figure.

    Parameters
    ----------
    vertices : (V, 3) float64
        Of the figure and its helpers.
    normals : (V, 3) float64
        Of its skin.
    """
    size = float(np.ptp(vertices[data.groups["body"].triangles[:, 0], 2])) / 1.67
    pieces = [_cap(data, marks, style, vertices, normals, size)]
    if style.length_m:
        pieces.append(_hanging(data, marks, style, vertices))
    if style.bun_m:
        pieces.append(_bun(marks, vertices, style.bun_m * size))
    return pieces


def _cap(
    data: BodyData,
    marks: Landmarks,
    style: Hairstyle,
    vertices: Doubles,
    normals: Doubles,
    size: float,
) -> HairPiece:
    group = data.groups["body"]
    base = marks.base
    bald = style.receded_m * (
        1.6 * (base[:, 0] > -0.03) + np.clip((base[:, 2] - 0.77) / 0.03, 0, 1.5)
    )
    field = marks.scalp_m + bald
    head = (field[group.triangles] < 0.0).any(axis=1)
    cut = clipped(group.triangles[head], group.uv_triangles[head], field)
    places = cut.mixed(base)
    depth = np.clip(-cut.mixed(field) / 0.045, 0.0, 1.0)
    top = 0.45 + 0.55 * np.clip((places[:, 2] - 0.70) / 0.10, 0.0, 1.0)
    locks = np.sin(140.0 * places[:, 1] + 60.0 * places[:, 0]) * np.sin(90.0 * places[:, 2])
    thick = np.sqrt(depth) * (style.thick_m * top + style.rough_m * locks * depth) + 0.001
    out = cut.mixed(normals)
    positions = cut.mixed(vertices) + size * thick[:, None] * out
    around = np.arctan2(places[:, 1], -(places[:, 0] - 0.02))
    uvs = np.stack([around * 1.2, places[:, 2] * 6.0], axis=1)
    return HairPiece(positions, _turned(positions, cut), uvs, cut.triangles)


def _hanging(data: BodyData, marks: Landmarks, style: Hairstyle, vertices: Doubles) -> HairPiece:
    group = data.groups["helper-hair"]
    base = marks.base
    x, y, z = base.T
    # What hangs before the face, and what is longer than it is worn.
    front = np.where(x > 0.045, 0.078 - np.abs(y), -1.0)
    field = np.maximum(style.length_m - z, front)
    cut = clipped(group.triangles, group.uv_triangles, field)
    positions = cut.mixed(vertices)
    places = cut.mixed(base)
    # A second layer below closes the gaps between strands.
    normals = _turned(positions, cut)
    below = np.clip((0.64 - places[:, 2]) / 0.05, 0.0, 1.0)
    positions = positions + (0.004 + 0.022 * below[:, None]) * normals
    inner = positions - 0.012 * normals
    middle = vertices[np.unique(group.triangles)].mean(axis=0)
    inner[:, 1] = middle[1] + (inner[:, 1] - middle[1]) * 0.93
    uvs = np.stack([places[:, 1] * 14.0, places[:, 2] * 3.0], axis=1)
    return HairPiece(
        np.concatenate([positions, inner]),
        np.concatenate([normals, normals]),
        np.concatenate([uvs, uvs + 0.37]),
        np.concatenate([cut.triangles, cut.triangles + len(positions)]),
    )


def _bun(marks: Landmarks, vertices: Doubles, radius: float) -> HairPiece:
    rows, columns = 9, 14
    angles = np.linspace(0.0, np.pi, rows)[:, None]
    turns = np.linspace(0.0, 2.0 * np.pi, columns + 1)[None]
    directions = np.stack(
        [
            np.sin(angles) * np.cos(turns),
            np.sin(angles) * np.sin(turns),
            np.cos(angles) * np.ones_like(turns),
        ],
        axis=-1,
    ).reshape(-1, 3)
    base = marks.base
    behind = np.argmin(np.where(np.abs(base[:, 2] - 0.775) < 0.02, base[:, 0], 9.0)[:13380])
    positions = vertices[behind] + radius * (directions + np.array([-0.45, 0.0, 0.1]))
    positions[:, 1] -= vertices[behind, 1]
    place = np.arange(rows * (columns + 1)).reshape(rows, columns + 1)
    a, b, c, d = (place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:])
    triangles = np.concatenate(
        [np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3)]
    )
    uvs = np.stack([turns * np.ones_like(angles), angles * np.ones_like(turns)], axis=-1)
    return HairPiece(positions, directions, uvs.reshape(-1, 2) * 0.5, triangles)


def _turned(positions: Doubles, cut: Cut) -> Doubles:
    """Return unit normals, the same for vertices of one place."""
    _, place = np.unique(np.round(positions, 9), axis=0, return_inverse=True)
    place = place.reshape(-1)
    count = int(place.max(initial=-1)) + 1
    joined = np.zeros((count, 3))
    joined[place] = positions
    return vertex_normals(joined, place[cut.triangles])[place]

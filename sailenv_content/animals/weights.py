"""Weights of an animal's skin: by which joints each vertex moves.

Joints share a vertex by how near their solids are to it; the trunk is shared by the vertebrae along
it. The shares are evened out over the mesh, so that skin bends softly.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.anatomy import SPINE, Anatomy
from sailenv_content.animals.solids import Body

__all__ = ["dense_weights"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

_SOFT = 0.022
"""Distance over the height of the withers within which the share of a joint falls to 1 / e."""

_ROUNDS = 6
_BELLY_SHARE = 0.8


def dense_weights(anatomy: Anatomy, body: Body, vertices: Doubles, triangles: Indices) -> Doubles:
    """Return (V, J) shares of the joints, in their order in `Anatomy.joints`; sums are 1."""
    names = list(anatomy.joints)
    place = {name: number for number, name in enumerate(names)}
    away = np.full((len(vertices), len(names) + 1), 1e3)
    for solid in body.solids:
        if solid.removes:
            continue
        column = len(names) if solid.joint == "trunk" else place[solid.joint]
        near = ((vertices > solid.low) & (vertices < solid.high)).all(axis=1)
        away[near, column] = np.minimum(away[near, column], solid.at(vertices[near]))
    away = np.maximum(away - away.min(axis=1, keepdims=True), 0.0)
    shares = np.exp(-away / (_SOFT * anatomy.unit))
    dense, trunk = shares[:, :-1], shares[:, -1]
    dense[:, [place[name] for name in SPINE]] += trunk[:, None] * _along(anatomy, vertices)
    dense = _evened(dense / dense.sum(axis=1, keepdims=True), triangles)
    _breathe(anatomy, dense, vertices, place)
    for name in names:
        if "paw" in name:
            # Soles stand as a whole.
            dense[_stands(anatomy, name, vertices)] = np.eye(len(names))[place[name]]
    return np.asarray(dense / dense.sum(axis=1, keepdims=True), np.float64)


def _along(anatomy: Anatomy, vertices: Doubles) -> Doubles:
    """Return (V, 4): the shares of the vertebrae, by where they are along x."""
    places = np.array([anatomy[name][0] for name in SPINE])
    middles = np.append(0.5 * (places[1:] + places[:-1]), places[-1] + 0.05 * anatomy.unit)
    return np.column_stack([
        np.interp(vertices[:, 0], middles, row) for row in np.eye(len(SPINE))
    ])  # fmt: skip


def _breathe(anatomy: Anatomy, dense: Doubles, vertices: Doubles, place: dict[str, int]) -> None:
    """Let the belly take its part of what the vertebrae have."""
    x, _, z = (vertices / anatomy.unit).T
    reach = anatomy.look.length
    within = np.clip((0.34 * reach - x) / 0.12, 0.0, 1.0) * np.clip((x + 0.36 * reach) / 0.15, 0, 1)
    part = _BELLY_SHARE * within * np.clip((0.74 - z) / 0.14, 0.0, 1.0)
    spine = [place[name] for name in SPINE]
    dense[:, place["belly"]] += part * dense[:, spine].sum(axis=1)
    dense[:, spine] *= (1.0 - part)[:, None]


def _stands(anatomy: Anatomy, name: str, vertices: Doubles) -> NDArray[np.bool_]:
    unit, paw = anatomy.unit, anatomy[name]
    off = np.abs(vertices[:, :2] - paw[:2]).max(axis=1)
    return np.asarray((vertices[:, 2] < 0.035 * unit) & (off < 0.16 * unit))


def _evened(dense: Doubles, triangles: Indices) -> Doubles:
    from scipy.sparse import coo_matrix, diags

    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    size = len(dense)
    joined = coo_matrix((np.ones(len(pairs)), tuple(pairs.T)), shape=(size, size)).tocsr()
    joined = joined + joined.T
    mean = diags(1.0 / np.maximum(np.asarray(joined.sum(axis=1))[:, 0], 1.0)) @ joined
    for _ in range(_ROUNDS):
        dense = 0.5 * (dense + mean @ dense)
    return np.asarray(dense, np.float64)

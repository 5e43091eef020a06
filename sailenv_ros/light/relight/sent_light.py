"""Radiance of the sides of an object that can move, from the light on it.

What a wall sees of a curtain is its back, which is dark: one number for all of the object would be
wrong. So each of six sides of the body has its own, as in the ambient cube of McTaggart 2004,
"Half-Life 2 / Valve Source shading".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_scene import albedo_of_model
from sailenv_ros.native.relight_kernels import light_of_probes
from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.rays.self_occlusion import LEAST_WEIGHT, arriving_share, vertex_occlusion
from sailenv_ros.types.baked_light import ObjectLight, ProbeGrid
from sailenv_ros.types.digests import once
from sailenv_ros.types.model import Model

__all__ = ["sent_by_light", "sent_by_probes"]

Floats = NDArray[np.float32]

SIDES = 6
"""Of a body: +x, +y, +z, -x, -y, -z."""


def sent_by_probes(
    probes: Floats,
    grid: ProbeGrid,
    model: Model,
    scale: tuple[float, float, float],
    pose: NDArray[np.float64],
) -> Floats:
    """Return what an object sends out by the light in the air where it is.

    Parameters
    ----------
    probes : (Z, Y, X, 4, C) float32
        Red, green and blue of each layer.
    grid : ProbeGrid
    model : Model
    scale : (3,) tuple of float
    pose : (4, 4) float64
        World from body.

    Returns
    -------
    radiance : (6, C) float32
        Of its sides.
    """
    middle = pose[:3, :3] @ (np.asarray(model.middle) * scale) + pose[:3, 3]
    light = light_of_probes(
        probes, grid.origin_m, grid.spacing_m, np.tile(middle.astype(np.float32), (SIDES, 1)),
        np.ascontiguousarray(_facing(pose[:3, :3].T), np.float32), threads=1,
    )  # fmt: skip
    return _sent(light.reshape(SIDES, -1, 3), model)


def sent_by_light(light: ObjectLight, positions: Floats, normals: Floats, model: Model) -> Floats:
    """Return what an object sends out by the light on it.

    Parameters
    ----------
    light : ObjectLight
    positions, normals : (P, 3) float32
        Of points on its surface [m], world frame: a side is where those are that face its way.
    model : Model

    Returns
    -------
    radiance : (6, C) float32
        Of its sides.
    """
    facing = _facing(light.axes.astype(np.float64))
    counts = np.maximum(normals @ facing.T, 0.0) ** 2 + 1e-6
    middles = (counts.T @ positions) / counts.sum(axis=0)[:, None]
    terms = light.bounced + light.direct[:, :, None]
    of_sides = terms[:, 4:].reshape(len(terms), SIDES, 4, 3)
    at = np.concatenate([np.ones((SIDES, 1)), middles], axis=1)
    arrives = (
        terms[None, :, 0]
        + np.einsum("sx,lxc->slc", facing, terms[:, 1:4])
        + np.einsum("sk,lskc->slc", at, of_sides)
    )
    return _sent(arrives, model)


def _facing(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (6, 3): where sides face, by the axes of the body (3, 3)."""
    return np.concatenate([axes, -axes])


@once
def _given_back(model: Model) -> Floats:
    """Return (6, 3) float32: share of the light from around that each side of a model gives back.

    Less than its albedo where it hides itself; what is hidden is seldom seen, and counts less.
    """
    albedo = albedo_of_model(model)
    every = triangles_of(model)
    parts = zip(vertex_occlusion(model), model.parts, strict=True)
    hidden = np.concatenate([own[part.mesh.triangles].mean(axis=1) for own, part in parts])
    normals = every.normals.mean(axis=1)
    counts = (every.areas_m2 * np.maximum(1.0 - hidden, LEAST_WEIGHT))[:, None]
    counts = counts * np.maximum(np.concatenate([normals, -normals], axis=1), 0.0) ** 2
    shares = arriving_share(hidden[:, None], albedo.astype(np.float64)[None])
    sums = counts.sum(axis=0)[:, None]
    mean = np.where(sums > 0.0, counts.T @ shares / np.maximum(sums, 1e-30), 1.0)
    return (mean * albedo).astype(np.float32)


def _sent(arrives: NDArray[np.floating], model: Model) -> Floats:
    """Return (6, C) float32: radiance, by irradiance / pi (6, L, 3)."""
    sent = np.maximum(arrives, 0.0) * _given_back(model)[:, None]
    return np.ascontiguousarray(sent.reshape(SIDES, -1), np.float32)

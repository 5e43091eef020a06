"""First hits of rays, in plain NumPy: every ray is tried with every triangle, without a tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_kernels import RayHits

EDGE = 1e-9
"""Tolerance beside a triangle, in its own coordinates, within which a ray still hits its edge."""

Doubles = NDArray[np.float64]


def cast_rays(
    models: list[tuple[Doubles, NDArray[np.bool_]]],
    model_from_world: Doubles,
    model_of_instance: NDArray[np.int32],
    origins: Doubles,
    directions: Doubles,
    nearest: Doubles,
) -> RayHits:
    """Find what rays meet first; see `native.ray_kernels.cast_rays`.

    Parameters
    ----------
    models : list of tuple
        (T, 3, 3) corners of each model's triangles, and which of them have two sides.
    """
    rays = len(origins)
    hits = RayHits(
        distance=np.full(rays, np.inf),
        instance=np.full(rays, -1, np.int32),
        triangle=np.full(rays, -1, np.int64),
        weights=np.zeros((rays, 2)),
    )
    firsts = np.concatenate([[0], np.cumsum([len(corners) for corners, _ in models])])
    for instance, m in enumerate(model_from_world):
        o = [r[0] * origins[:, 0] + r[1] * origins[:, 1] + r[2] * origins[:, 2] + r[3] for r in m]
        d = [r[0] * directions[:, 0] + r[1] * directions[:, 1] + r[2] * directions[:, 2] for r in m]
        corners, two_sided = models[model_of_instance[instance]]
        for number, triangle in enumerate(corners):
            distance, second, third = _meet(o, d, triangle, bool(two_sided[number]))
            met = (distance > nearest) & (distance < hits.distance)
            hits.distance[met] = distance[met]
            hits.instance[met] = instance
            hits.triangle[met] = firsts[model_of_instance[instance]] + number
            hits.weights[met] = np.stack([second, third], axis=-1)[met]
    return hits


def glazing_transmittance(cosine: NDArray[np.floating]) -> Doubles:
    """Return how much light clear double glazing lets through: 0.85 of what meets it head-on.

    Fresnel's equations for an index of 1.5, both polarisations alike, with all that goes to and
    fro between the two faces of each of the two sheets.

    Parameters
    ----------
    cosine : (R,) float
        Of the angle between the ray and the pane's normal, 0 to 1.
    """
    c = np.asarray(cosine, np.float64)
    inside = np.sqrt(1.0 - (1.0 - np.square(c)) / 1.5**2)
    across = (c - 1.5 * inside) / (c + 1.5 * inside)
    along = (1.5 * c - inside) / (1.5 * c + inside)
    mirrored = 0.5 * (np.square(across) + np.square(along))
    return np.asarray(np.square((1.0 - mirrored) / (1.0 + mirrored)))


def _meet(
    o: list[Doubles], d: list[Doubles], corners: Doubles, both: bool
) -> tuple[Doubles, Doubles, Doubles]:
    """Return where rays meet a triangle (nan for not at all), and the weights of its corners.

    T. Möller, B. Trumbore, "Fast, minimum storage ray-triangle intersection", 1997.
    """
    ab, ac = corners[1] - corners[0], corners[2] - corners[0]
    p = _cross(d, list(ac))
    determinant = ab[0] * p[0] + ab[1] * p[1] + ab[2] * p[2]
    ao = [o[axis] - corners[0, axis] for axis in range(3)]
    q = _cross(ao, list(ab))
    with np.errstate(all="ignore"):
        second = (ao[0] * p[0] + ao[1] * p[1] + ao[2] * p[2]) / determinant
        third = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant
        distance = (ac[0] * q[0] + ac[1] * q[1] + ac[2] * q[2]) / determinant
        faces = (determinant != 0.0) if both else determinant > 0.0
        met = faces & (second >= -EDGE) & (second <= 1.0 + EDGE)
        met &= (third >= -EDGE) & (second + third <= 1.0 + EDGE)
    return np.where(met, distance, np.nan), second, third


def _cross(a: list[Doubles], b: list[Doubles]) -> list[Doubles]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]

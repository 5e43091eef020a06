"""Flat parts of models that mirror like glass that is silvered. From a `Model` to `MirrorFace`s."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Model, ModelPart

__all__ = ["CATEGORY", "MirrorFace", "mirror_face", "mirror_faces"]

FLAT = 0.05
"""A mirror is thinner than this share of its shorter side."""

LEAST_SIDE_M = 0.1
LEAST_METALLIC, MOST_ROUGHNESS = 0.9, 0.1

CATEGORY = "mirror"
"""Category of objects in which any flat metal is a mirror, whatever its roughness."""

SILVERED = 0.9
"""Least reflectance of such a mirror in its brightest channel, as of silver behind glass: models
give their mirrors the grey of what they happen to reflect."""


@dataclass(frozen=True, eq=False, slots=True)
class MirrorFace:
    """A flat part of a model that mirrors.

    Attributes
    ----------
    part : int
        Its place in the model.
    axis : int
        Along which it is thin.
    low, high : (3,) float64
        Its corners in the model's frame before scaling [m].
    tint : (3,) float32
        What it mirrors is multiplied by this.
    """

    part: int
    axis: int
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    tint: NDArray[np.float32]


def mirror_faces(model: Model, category: str) -> tuple[MirrorFace, ...]:
    """Return the parts that mirror of a model in an object of some category."""
    found = (mirror_face(number, part, category) for number, part in enumerate(model.parts))
    return tuple(face for face in found if face is not None)


def mirror_face(number: int, part: ModelPart, category: str) -> MirrorFace | None:
    """Return what part `number` mirrors as; None if it is none of a mirror's."""
    look, points, silvered = part.material, part.mesh.positions, category == CATEGORY
    rough = look.metallic_roughness_texture is not None or look.normal_texture is not None
    if look.alpha != "opaque" or look.metallic < LEAST_METALLIC or rough or not len(points):
        return None
    if look.roughness > MOST_ROUGHNESS and not silvered:
        return None
    low, high = points.min(axis=0).astype(np.float64), points.max(axis=0).astype(np.float64)
    size = high - low
    thin, short, _ = np.argsort(size, kind="stable")
    if size[short] < LEAST_SIDE_M or size[thin] > FLAT * size[short]:
        return None
    at = points[:, thin]
    if not ((at - low[thin] < 1e-3) | (high[thin] - at < 1e-3)).all():
        return None
    tint = np.asarray(look.base_colour[:3], np.float32)
    brightest = float(tint.max())
    if silvered and brightest > 0.0:
        tint = tint * np.float32(max(SILVERED / brightest, 1.0))
    return MirrorFace(number, int(thin), low, high, tint)

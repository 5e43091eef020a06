"""Frames for walls: four bars with a profile, and a back; the wall is at x = 0."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.materials import PieceMaterial, paint
from sailenv_content.families.shaping import board, placed, with_uvs
from sailenv_ros.types.model import Mesh

__all__ = ["frame", "pictured"]

BACK = paint("#6b5a45", 0.9)


def frame(
    b: PieceBuilder,
    material: PieceMaterial,
    width: float,
    height: float,
    *,
    bar: float,
    depth: float,
    step: PieceMaterial | None = None,
) -> None:
    """Add bars around a rectangle of an outer width and height, its base at z = 0, and a back.

    Parameters
    ----------
    step : PieceMaterial or None
        Of a thinner bar inside the first.
    """
    x = depth / 2
    for sign in (-1.0, 1.0):
        at = (x, sign * (width - bar) / 2, height / 2)
        b.box(material, (depth, bar, height), at, bevel=0.2 * bar)
        at = (x, 0.0, height / 2 + sign * (height - bar) / 2)
        b.box(material, (depth, width - 2 * bar, bar), at, bevel=0.2 * bar)
        if step is not None:
            thin = 0.3 * bar
            at = (0.42 * depth, sign * (width - 2 * bar - thin) / 2, height / 2)
            b.box(step, (0.6 * depth, thin, height - 2 * bar), at, bevel=0.2 * thin)
            at = (0.42 * depth, 0.0, height / 2 + sign * (height - 2 * bar - thin) / 2)
            b.box(step, (0.6 * depth, width - 2 * bar - 2 * thin, thin), at, bevel=0.2 * thin)
    size = (0.004, width - bar, height - bar)
    b.box(BACK, size, (0.003, 0.0, height / 2), bevel=0.0005, collides=False)


def pictured(width: float, height: float, z: float, x: float, thick: float = 0.004) -> Mesh:
    """Return a board whose front, at x, shows a picture; its middle is at a height."""
    mesh = placed(board((thick, width, height), bevel=0.0005), (x - thick / 2, 0.0, z))
    return with_uvs(mesh, (1, 2), (-width / 2, z - height / 2), (width, height))

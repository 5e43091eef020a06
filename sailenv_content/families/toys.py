"""Colours and soft forms that toys share."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.materials import PieceMaterial, paint
from sailenv_content.procedural.forms import ellipsoid
from sailenv_ros.assets.meshes import smooth_mesh

__all__ = ["BLACK", "GAY", "blob", "lacquer"]

BLACK = paint("#17181a", 0.3)


def lacquer(colour: str) -> PieceMaterial:
    """Return a lacquer on wood."""
    return paint(colour, 0.35, 550.0)


GAY = tuple(
    lacquer(c)
    for c in (
        "#b83a2e",
        "#d9a52f",
        "#2f6ea3",
        "#4c8a4a",
        "#d9702f",
        "#7a4a8a",
        "#e6dfd0",
        "#3aa0a0",
    )
)


def blob(
    b: PieceBuilder,
    material: PieceMaterial,
    radii: tuple[float, float, float],
    at: tuple[float, float, float],
    *,
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0),
    collides: bool = True,
) -> None:
    """Add an ellipsoid."""
    mesh = smooth_mesh(ellipsoid(radii, (0.0, 0.0, 0.0), 20))
    b.form(material, mesh, at, turn=turn, collides="hull" if collides else "none")

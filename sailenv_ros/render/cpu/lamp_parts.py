"""Parts of lamps in a table of parts: what they look like while they glow."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.scene.material_factors import MaterialFactors
from sailenv_ros.types.model import Material, Model

__all__ = ["let_glow"]


def let_glow(
    table: NDArray[np.void],
    row: int,
    model: Model,
    look: Callable[[Material], MaterialFactors],
    *,
    see_through: bool = False,
) -> None:
    """Write how those parts of a lamp look that glow.

    Parameters
    ----------
    table : (P,) PART
        Of see-through parts or of all others, as `see_through` says.
    row : int
        Of the instance.
    model : Model
    look : callable
        Gives the numbers of a material that glows.
    """
    parts = [part for part in model.parts if (part.material.alpha == "blend") == see_through]
    places = np.flatnonzero(table["instance"] == row)
    for place, part in zip(places, parts, strict=True):
        if any(part.material.glow):
            factors = look(part.material)
            table["colour"][place] = factors.colour
            table["emission"][place] = factors.emission

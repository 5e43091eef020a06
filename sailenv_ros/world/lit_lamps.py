"""Assigns lights to lamps: the places in a scene in, names of lights out.

Scenes describe lights and furniture apart. A lamp (an object with a material that glows) is on by
the lights that are in it, so its shade goes dark when they are switched off or taken away, and
when the lamp is carried off.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.lights import LAMP_TYPES, Light
from sailenv_ros.world.labelled_pieces import LabelledPiece

__all__ = ["REACH_M", "is_lamp", "lit_by"]

REACH_M = 0.5
"""A light is in the nearest lamp if it is no farther from the box around it [m].

Lights of flat ceiling lamps lie a hand below them, so that the ceiling is lit evenly.
"""


def is_lamp(piece: LabelledPiece) -> bool:
    """Return whether a piece is the body of an object with a material that glows."""
    return piece.part is None and piece.body.placement.asset.model.is_lamp


def lit_by(
    pieces: Sequence[LabelledPiece],
    world_from_body: NDArray[np.float64],
    lights: Sequence[Light],
) -> Mapping[int, tuple[str, ...]]:
    """Find the lights of each lamp.

    Parameters
    ----------
    pieces : sequence of LabelledPiece
    world_from_body : (N, 4, 4) float64
        A row for each piece.
    lights : sequence of Light

    Returns
    -------
    names : mapping of int to tuple of str
        Of the lights in each lamp, by the id of its body; lamps without any are left out. A light
        is in one lamp at most: the nearest, of equally near ones that of the lowest id.
    """
    lamps = [
        (piece, pose) for piece, pose in zip(pieces, world_from_body, strict=True) if is_lamp(piece)
    ]
    found: dict[int, tuple[str, ...]] = {}
    if not lamps:
        return found
    for light in lights:
        if light.type not in LAMP_TYPES:
            continue
        far = [_distance(piece, pose, light) for piece, pose in lamps]
        nearest = int(np.argmin(far))
        if far[nearest] <= REACH_M:
            body_id = lamps[nearest][0].body_id
            found[body_id] = (*found.get(body_id, ()), light.name)
    return found


def _distance(piece: LabelledPiece, pose: NDArray[np.float64], light: Light) -> float:
    """Return how far a light is from the box around a lamp [m]; 0 within."""
    placement = piece.body.placement
    own = pose[:3, :3].T @ (np.asarray(light.position_m) - pose[:3, 3])
    low, high = placement.asset.model.bounds() * np.asarray(placement.scale)
    return float(np.linalg.norm(own - np.clip(own, low, high)))

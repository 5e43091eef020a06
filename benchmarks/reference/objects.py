"""How near objects that can move come to the path tracer in their mean colours, in words.

Rows of `compare` in, their `objects` being what `measure.py` found, lines of text out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["NEAR_DELTA_E", "lines_on_objects", "movable_ids", "share_near"]

NEAR_DELTA_E, FAR_DELTA_E = 2.5, 5.0
"""Differences (CIE DE2000) of which the shares are told."""

WORST = 8

PARTS = "lightness", "chroma", "hue"
"""In which a colour differs, as `measure.py` names them."""

Row = dict[str, Any]


def movable_ids(snapshot: WorldSnapshot) -> NDArray[np.int64]:
    """Return the ids of what has no place in the light map: all that can move."""
    instances = snapshot.contents.instances
    return np.array([drawn.instance.id for drawn in instances if not drawn.is_baked], np.int64)


def share_near(things: Sequence[Row], most: float) -> float:
    """Return the share of objects whose mean colour differs by no more; 1 of none."""
    return float(np.mean([thing["delta_e"] <= most for thing in things])) if things else 1.0


def lines_on_objects(rows: Sequence[Row]) -> list[str]:
    """Return the shares of all objects, and which differ most; nothing where there are none."""
    things = [{**thing, "view": row["view"]} for row in rows for thing in row["objects"]]
    if not things:
        return []
    near, far = (share_near(things, most) for most in (NEAR_DELTA_E, FAR_DELTA_E))
    median = float(np.median([thing["delta_e"] for thing in things]))
    worst = sorted(things, key=lambda thing: -float(thing["delta_e"]))[:WORST]
    listed = ", ".join(
        f"{thing['view']}/{thing['name']} {thing['delta_e']:.1f}"
        f" ({' '.join(f'{thing[part]:+.0f}' for part in PARTS)})"
        for thing in worst
    )
    parts = ", ".join(f"{part} {np.mean([thing[part] for thing in things]):+.1f}" for part in PARTS)
    return [
        f"{len(things)} objects that can move: ΔE2000 ≤ {NEAR_DELTA_E} {near:.0%}, "
        f"≤ {FAR_DELTA_E} {far:.0%}, median {median:.1f}",
        f"on average ours is off by {parts}",
        f"farthest ({', '.join(PARTS)}): {listed}",
    ]

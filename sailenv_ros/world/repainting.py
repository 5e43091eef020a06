"""Another look for what stands still: nothing to the engine."""

from __future__ import annotations

from dataclasses import replace

from sailenv_ros.world.bodies import Body
from sailenv_ros.world.placement import Placement

__all__ = ["repaint"]

_FELT = ("collision", "mass_kg", "centre_of_mass_m", "parts", "moving", "rig", "inertia")
"""Of an asset: what is more than its looks."""


def repaint(body: Body, placement: Placement) -> bool:
    """Give a body the looks of another placement if these are all that differs; tell if so.

    The engine knows nothing of them: it keeps the body, and what rests upon it sleeps on.
    """
    mine = body.placement
    old, new = mine.asset, placement.asset
    alike = replace(placement, asset=old, entry=mine.entry, pose=mine.pose) == mine
    if not mine.static or old.rig is not None or not alike:
        return False
    if any(getattr(old, name) != getattr(new, name) for name in _FELT):
        return False
    body.placement = replace(placement, pose=body.pose())
    return True

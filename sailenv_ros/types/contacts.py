"""Contacts: where bodies touch, and how hard; made by `world/`, told to clients."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Contact"]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """Two bodies that touched, in the world frame.

    Attributes
    ----------
    first, second : int
        Instance ids, the first of which is the lower; 0 stands for a mover.
    mover, other_mover : str
        Names of the movers where the first, or both, are movers; else empty.
    position_m : (3,) tuple of float
        Of the point where the impulse was strongest [m].
    normal : (3,) tuple of float
        Unit vector there that points from the second body to the first.
    impulse_n_s : float
        What the second gave the first along its normals, over the time that was asked for [N s].
    depth_m : float
        How deep the two stood in one another there; below 0 for a gap [m].
    sim_time_ns : int
        End of the step of the strongest impulse [ns].
    """

    first: int
    second: int
    mover: str = ""
    other_mover: str = ""
    position_m: Vector3
    normal: Vector3
    impulse_n_s: float
    depth_m: float
    sim_time_ns: int

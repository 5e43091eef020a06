"""Facts of a scene beside its frames: contacts, contents, openings, materials, free space.

Made by `simulation.scene_facts`; a plain value that can be sent and kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sailenv_ros.space.free_space import FreeSpace

__all__ = ["NO_FACTS", "Gap", "Opening", "SceneFacts"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap:
    """The space between two objects that are near each other.

    Attributes
    ----------
    gap_m : float
        Shortest distance between their collision shapes; below 0 where they overlap [m].
    rise : float
        z component of the direction from the other object to this one there, -1 to 1.
    """

    gap_m: float
    rise: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Opening:
    """How far something on a joint is open.

    Attributes
    ----------
    whole : int
        Id of the object that it is a part of; its own if it is none.
    position : float
        From where it is shut [rad] or [m].
    share : float
        Of the way to its far end, 0 to 1.
    """

    whole: int
    position: float
    share: float


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SceneFacts:
    """Facts of one instant; ids are those of the instance view, of whole objects.

    Attributes
    ----------
    sim_time_ns : int
        Of the instant [ns].
    gaps : mapping of (int, int) to Gap
        Of pairs that are nearer than `NEAR_M` of `simulation.scene_facts`, in both orders.
    enclosed : mapping of (int, int) to int
        Of what has its middle within another's box: in how many of the six directions of that
        box's axes its middle sees that object's collision shapes. Only where they are below it,
        and in five directions or six.
    openings : mapping of int to Opening
        Of what moves on a joint with limits.
    materials : mapping of int to mapping of str to float
        Shares of an object's surface by `MATERIAL_WORDS`; those of unknown materials by "".
    spaces : tuple of FreeSpace
        Where robots of some widths can stand.
    """

    sim_time_ns: int
    gaps: Mapping[tuple[int, int], Gap] = field(default_factory=dict)
    enclosed: Mapping[tuple[int, int], int] = field(default_factory=dict)
    openings: Mapping[int, Opening] = field(default_factory=dict)
    materials: Mapping[int, Mapping[str, float]] = field(default_factory=dict)
    spaces: tuple[FreeSpace, ...] = ()


NO_FACTS = SceneFacts(sim_time_ns=0)
"""Nothing is known beside the frame."""

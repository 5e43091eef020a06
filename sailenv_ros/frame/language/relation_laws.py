"""When a relation between two objects of a frame holds, and the numbers that it follows from.

Each law leaves a gap between what holds and what clearly does not: near its bounds nothing is said.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.language.scene_facts import NO_FACTS, SceneFacts
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.space.outlines import Solid
from sailenv_ros.space.solid_distances import solid_distance_m

__all__ = ["OPEN_SHARE", "RELATIONS", "SHUT_SHARE", "Numbers", "View", "holds"]

RESTS_M = 0.03
"""Greatest distance between the bottom of what lies on something and the top of that [m]."""

FURTHER = 1.15
"""Factor by which two distances or heights differ where one is said to be the greater."""

APART_SHARE = 0.02
"""Share of the picture's width between two objects of which one is said to be left of the other."""

TOUCHES_M = 0.005
"""Greatest gap between things that touch [m]."""

BEARING = 0.7
"""Least z component of the direction from what supports something to that."""

BESIDE_M = 0.5
"""Greatest distance across the floor between things that are beside each other [m]."""

BESIDE_SHARE = 0.5
"""Least share of the lower one's height at which both are, of things beside each other."""

HIDES_SHARE = 0.5
"""Least share of the width of what is behind something that is seen above or at the sides of it."""

OPEN_SHARE, SHUT_SHARE = 0.1, 0.01
"""Share of its way from which something is open, and up to which it is shut."""

Numbers = Mapping[str, float]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class View:
    """Camera and facts that relations follow from, beside the objects themselves.

    Attributes
    ----------
    width : int
        Of the picture [px].
    camera_m : (3,) float64
        Where the camera is in the world [m].
    forward : (3,) float64
        Unit vector along which it looks.
    facts : SceneFacts
        Of the frame's instant; `NO_FACTS` where nothing but the frame is known.
    stamp_ns : int
        Simulated time of the frame [ns].
    """

    width: int
    camera_m: NDArray[np.float64]
    forward: NDArray[np.float64]
    facts: SceneFacts = NO_FACTS
    stamp_ns: int = 0


def holds(kind: str, first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    """Return the numbers that a relation follows from; None if it is not so, or not clearly."""
    return _LAWS[kind](first, second, view)


def _on(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    gap = first.bottom_m - second.top_m
    if not (first.is_upright and second.is_upright and abs(gap) <= RESTS_M):
        return None
    own = np.ptp(first.corners_m[:, :2], axis=0).prod()
    if not _is_over(first, second) or own >= second.size_m[_sides(second)].prod():
        return None
    return {"gap_m": gap, "bottom_m": first.bottom_m, "top_m": second.top_m}


def _is_over(first: SeenObject, second: SeenObject) -> bool:
    """Return whether the middle of one is over or under the other's box, which is upright."""
    offset = np.abs(second.turn.T @ (first.middle_m - second.middle_m))
    sides = _sides(second)
    return bool((offset[sides] <= second.size_m[sides] / 2.0).all())


def _sides(one: SeenObject) -> list[int]:
    """Return the two axes of an upright box that lie flat."""
    upright = int(np.argmax(np.abs(one.turn[2])))
    return [axis for axis in range(3) if axis != upright]


def _in(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    met = view.facts.enclosed.get((first.id, second.id))
    return None if met is None else {"directions": float(met)}


def _holds(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    return _in(second, first, view)


def _touching(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    gap = view.facts.gaps.get((first.id, second.id))
    if gap is None or gap.gap_m > TOUCHES_M:
        return None
    return {"gap_m": gap.gap_m}


def _supports(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    gap = view.facts.gaps.get((second.id, first.id))
    if gap is None or gap.gap_m > TOUCHES_M or gap.rise < BEARING:
        return None
    return {"gap_m": gap.gap_m, "rise": gap.rise}


def _beside(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    shared = min(first.top_m, second.top_m) - max(first.bottom_m, second.bottom_m)
    share = shared / max(min(first.height_m, second.height_m), 1e-9)
    reach = BESIDE_M + 0.5 * float(np.linalg.norm(first.size_m) + np.linalg.norm(second.size_m))
    if share < BESIDE_SHARE or np.linalg.norm(first.middle_m - second.middle_m) > reach:
        return None
    if not (first.is_upright and second.is_upright):
        return None
    if _is_over(first, second) or _is_over(second, first):
        return None
    flat = (Solid(one.corners_m * (1.0, 1.0, 0.0)) for one in (first, second))
    gap = solid_distance_m(next(flat), next(flat))
    return {"gap_m": gap, "share": share} if gap <= BESIDE_M else None


def _behind(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    left, right = max(first.box[0], second.box[0]), min(first.box[2], second.box[2])
    width = first.box[2] - first.box[0] + 1
    share = (right - left + 1) / width
    nearest = float(np.linalg.norm(first.corners_m - view.camera_m, axis=1).min())
    farthest = float(np.linalg.norm(second.corners_m - view.camera_m, axis=1).max())
    if share < HIDES_SHARE or nearest <= farthest:
        return None
    return {"share": share, "nearest_m": nearest, "farthest_m": farthest}


def _open(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    """Something is open by itself: both objects are the same one."""
    if first.id != second.id:
        return None
    found = [one for one in view.facts.openings.values() if one.whole == first.id]
    widest = max(found, key=lambda one: one.share, default=None)
    if widest is None or widest.share < OPEN_SHARE:
        return None
    return {"share": widest.share, "position": widest.position}


def _left_of(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    gap = second.box[0] - first.box[2]
    return {"gap_px": float(gap)} if gap >= APART_SHARE * view.width else None


def _right_of(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    return _left_of(second, first, view)


def _nearer(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    near, far = (one.distance_to_box_m(view.camera_m) for one in (first, second))
    if first.distance_m * FURTHER > second.distance_m or near >= far:
        return None
    return {"distance_m": first.distance_m, "other_m": second.distance_m}


def _taller(first: SeenObject, second: SeenObject, view: View) -> Numbers | None:
    upright = first.is_upright and second.is_upright
    if not upright or first.height_m < second.height_m * FURTHER:
        return None
    return {"height_m": first.height_m, "other_m": second.height_m}


_LAWS: Mapping[str, Callable[[SeenObject, SeenObject, View], Numbers | None]] = MappingProxyType(
    {
        "on": _on,
        "in": _in,
        "holds": _holds,
        "touching": _touching,
        "supports": _supports,
        "beside": _beside,
        "behind": _behind,
        "open": _open,
        "left of": _left_of,
        "right of": _right_of,
        "nearer than": _nearer,
        "taller than": _taller,
    }
)

RELATIONS = tuple(_LAWS)
"""Kinds of relations."""

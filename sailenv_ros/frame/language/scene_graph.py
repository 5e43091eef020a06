"""Relations between the objects of a frame, with the numbers that they follow from."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language.seen_objects import SeenObject, seen_objects, seen_parts

__all__ = ["RELATIONS", "Relation", "SceneGraph", "holds", "scene_graph"]

RESTS_M = 0.03
"""Greatest distance between the bottom of what lies on something and the top of that [m]."""

FURTHER = 1.15
"""Factor by which two distances or heights differ where one is said to be the greater."""

UPRIGHT = 0.999
"""Least cosine between an axis of what carries something and the vertical."""

APART_SHARE = 0.02
"""Share of the picture's width between two objects of which one is said to be left of the other."""

Numbers = Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Relation:
    """A relation between two objects.

    Attributes
    ----------
    kind : str
        One of `RELATIONS`.
    subject, object : int
        Ids of the objects: the subject is left of the object, or on it.
    values : mapping of str to float
        Numbers that it follows from.
    """

    kind: str
    subject: int
    object: int
    values: Numbers


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SceneGraph:
    """Objects and relations of a frame.

    Attributes
    ----------
    width : int
        Of the picture [px].
    objects : mapping of int to SeenObject
        By id, in ascending order; those that are not clear too.
    relations : tuple of Relation
        Between clear objects.
    parts : frozenset of str
        Categories of parts that are seen; see `seen_parts`.
    """

    width: int
    objects: Mapping[int, SeenObject]
    relations: tuple[Relation, ...]
    parts: frozenset[str] = frozenset()

    @property
    def clear(self) -> tuple[SeenObject, ...]:
        """The objects that are seen clearly."""
        return tuple(one for one in self.objects.values() if one.clear)

    def of(self, kind: str, subject: int) -> tuple[Relation, ...]:
        """Return the relations of one kind that an object has to others."""
        return tuple(r for r in self.relations if r.kind == kind and r.subject == subject)


def scene_graph(frame: Frame) -> SceneGraph:
    """Return the graph of a frame; errors as of `seen_objects`."""
    objects = seen_objects(frame)
    width = frame.views["instance"].shape[1]
    clear = [one for one in objects if one.clear]
    return SceneGraph(
        width=width,
        objects=MappingProxyType({one.id: one for one in objects}),
        relations=tuple(_relations(clear, width)),
        parts=seen_parts(frame),
    )


def holds(kind: str, first: SeenObject, second: SeenObject, width: int) -> Numbers | None:
    """Return the numbers that a relation follows from; None if it is not so, or not clearly."""
    return _LAWS[kind](first, second, width)


def _relations(objects: list[SeenObject], width: int) -> Iterator[Relation]:
    for kind in RELATIONS:
        for first, second in itertools.permutations(objects, 2):
            values = holds(kind, first, second, width)
            if values is not None:
                yield Relation(kind=kind, subject=first.id, object=second.id, values=values)


def _on(first: SeenObject, second: SeenObject, width: int) -> Numbers | None:
    gap = first.bottom_m - second.top_m
    if abs(gap) > RESTS_M or not _is_over(first, second):
        return None
    return {"gap_m": gap, "bottom_m": first.bottom_m, "top_m": second.top_m}


def _is_over(first: SeenObject, second: SeenObject) -> bool:
    """Return whether the middle of one is over the other's box, which is the larger one."""
    upright = int(np.argmax(np.abs(second.turn[2])))
    if abs(second.turn[2, upright]) < UPRIGHT:
        return False
    offset = second.turn.T @ (first.middle_m - second.middle_m)
    sides = [axis for axis in range(3) if axis != upright]
    if any(abs(offset[axis]) > second.size_m[axis] / 2.0 for axis in sides):
        return False
    own = np.ptp(first.corners_m[:, :2], axis=0)
    return bool(own.prod() < second.size_m[sides].prod())


def _left_of(first: SeenObject, second: SeenObject, width: int) -> Numbers | None:
    gap = second.box[0] - first.box[2]
    return {"gap_px": float(gap)} if gap >= APART_SHARE * width else None


def _right_of(first: SeenObject, second: SeenObject, width: int) -> Numbers | None:
    return _left_of(second, first, width)


def _nearer(first: SeenObject, second: SeenObject, width: int) -> Numbers | None:
    if first.distance_m * FURTHER > second.distance_m:
        return None
    return {"distance_m": first.distance_m, "other_m": second.distance_m}


def _taller(first: SeenObject, second: SeenObject, width: int) -> Numbers | None:
    if first.height_m < second.height_m * FURTHER:
        return None
    return {"height_m": first.height_m, "other_m": second.height_m}


_LAWS: Mapping[str, Callable[[SeenObject, SeenObject, int], Numbers | None]] = {
    "on": _on,
    "left of": _left_of,
    "right of": _right_of,
    "nearer than": _nearer,
    "taller than": _taller,
}

RELATIONS = tuple(_LAWS)
"""Kinds of relations: support, places in the picture, distances from the camera, heights."""

"""Objects of a frame and the relations between them, with the numbers that these follow from."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language.relation_laws import RELATIONS, Numbers, View, holds
from sailenv_ros.frame.language.scene_facts import NO_FACTS, SceneFacts
from sailenv_ros.frame.language.seen_objects import SeenObject, seen_objects, seen_parts

__all__ = ["Relation", "SceneGraph", "scene_graph"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Relation:
    """A relation between two objects.

    Attributes
    ----------
    kind : str
        One of `RELATIONS`.
    subject, object : int
        Ids of the objects: the subject is left of the object, or on it. What is ``open`` is both.
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
    view : View
        Of the camera, with the facts that are known beside the frame.
    objects : mapping of int to SeenObject
        By id, in ascending order; those that are not clear too.
    relations : tuple of Relation
        Between clear objects.
    parts : frozenset of str
        Categories of parts that are seen; see `seen_parts`.
    """

    view: View
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


def scene_graph(frame: Frame, facts: SceneFacts | None = None) -> SceneGraph:
    """Return the graph of a frame.

    Parameters
    ----------
    frame : Frame
    facts : SceneFacts or None
        Of its instant; None takes those of the frame, if a shutter that rolled did not end later.
        Without any, nothing touches, supports or holds another thing, is in it, or is open.

    Raises
    ------
    InvalidRequest
        If the facts are of another instant; see `seen_objects` for others.
    """
    if facts is not None and facts.sim_time_ns != frame.stamp_ns:
        accepted = f"the frame's, {frame.stamp_ns} ns"
        raise InvalidRequest("time of the facts", f"{facts.sim_time_ns} ns", accepted)
    known = facts or frame.facts or NO_FACTS
    known = known if known.sim_time_ns == frame.stamp_ns else NO_FACTS
    objects = seen_objects(frame, known)
    pose = frame.camera.world_from_camera
    view = View(
        width=frame.views["instance"].shape[1],
        camera_m=pose[:3, 3],
        forward=pose[:3, 2],
        facts=known,
        stamp_ns=frame.stamp_ns,
    )
    clear = [one for one in objects if one.clear]
    return SceneGraph(
        view=view,
        objects=MappingProxyType({one.id: one for one in objects}),
        relations=tuple(_relations(clear, view)),
        parts=seen_parts(frame),
    )


def _relations(objects: Sequence[SeenObject], view: View) -> Iterator[Relation]:
    for kind in RELATIONS:
        for first, second in itertools.product(objects, repeat=2):
            if (first is second) != (kind == "open"):
                continue
            values = holds(kind, first, second, view)
            if values is not None:
                yield Relation(kind=kind, subject=first.id, object=second.id, values=values)

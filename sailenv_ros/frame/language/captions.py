"""Captions: which things a frame shows, the largest first, and what lies on what."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sailenv_ros.frame.language.scene_graph import Relation, SceneGraph
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.wording import counted, listed, named

__all__ = ["Caption", "caption"]

MOST_CATEGORIES, MOST_SUPPORTS = 8, 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Caption:
    """A description of a frame.

    Attributes
    ----------
    text : str
    objects : tuple of int
        Ids of the objects that it names.
    relations : tuple of Relation
        Those that it tells, with their numbers.
    """

    text: str
    objects: tuple[int, ...]
    relations: tuple[Relation, ...]


def caption(graph: SceneGraph, *, place: str = "room") -> Caption:
    """Describe a frame.

    Parameters
    ----------
    graph : SceneGraph
    place : str
        Kind of the room, in words.

    Returns
    -------
    caption : Caption
        Up to eight categories, each counted where all of its objects are seen clearly, and up to
        three times what lies on what.
    """
    of: dict[str, list[SeenObject]] = {}
    for one in graph.objects.values():
        if one.category not in graph.parts:
            of.setdefault(one.category, []).append(one)
    shown = {name: all_ for name, all_ in of.items() if any(one.clear for one in all_)}
    largest = sorted(shown, key=lambda name: -sum(one.pixels for one in shown[name]))
    told = largest[:MOST_CATEGORIES]
    things = [_things(name, shown[name]) for name in told]
    subject = f"{named(place, definite=False)}".capitalize()
    sentences = [f"{subject} with {listed(things)}." if things else f"{subject}."]
    relations = _supports(graph, told)
    for relation in relations:
        on, carrier = graph.objects[relation.subject], graph.objects[relation.object]
        sentences.append(
            f"{named(on.category, definite=False).capitalize()} is on {named(carrier.category)}."
        )
    objects = tuple(one.id for name in told for one in shown[name] if one.clear)
    return Caption(text=" ".join(sentences), objects=objects, relations=tuple(relations))


def _things(category: str, all_: Sequence[SeenObject]) -> str:
    if len({one.colour for one in all_}) == 1 and all_[0].colour:
        category = f"{all_[0].colour} {category}"
    if not all(one.clear for one in all_) and len(all_) > 1:
        return counted(category, None)
    return counted(category, len(all_))


def _supports(graph: SceneGraph, told: Sequence[str]) -> list[Relation]:
    """Return what lies on the only one of its category, one of a category each."""
    categories = [one.category for one in graph.objects.values()]
    found: dict[str, Relation] = {}
    for one in graph.relations:
        carrier = graph.objects[one.object].category
        own = graph.objects[one.subject].category
        known = own in told and carrier in told and own != carrier
        if one.kind == "on" and known and categories.count(carrier) == 1:
            found.setdefault(own, one)
    return list(found.values())[:MOST_SUPPORTS]

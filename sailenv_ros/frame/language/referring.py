"""Expressions that are true of exactly one object that a frame shows.

An expression is a category and a condition. It is kept only if the condition holds for its object,
and clearly does not for every other object of the category, those that are hardly seen included.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from sailenv_ros.frame.language.relation_laws import holds
from sailenv_ros.frame.language.scene_graph import SceneGraph
from sailenv_ros.frame.language.seen_objects import NOT_OF_COLOUR, SeenObject
from sailenv_ros.frame.language.wording import named

__all__ = ["Referring", "referring_expressions"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Referring:
    """An expression and the one object that it is true of.

    Attributes
    ----------
    text : str
        ``the cup on the table``
    object : int
        Id of the object.
    category : str
    values : mapping of int to mapping of str to float
        Numbers for each object of the category, by id: they tell it from the others.
    """

    text: str
    object: int
    category: str
    values: Mapping[int, Mapping[str, float]]


def referring_expressions(graph: SceneGraph) -> tuple[Referring, ...]:
    """Return the expressions that are true of one object each, in the order of the ids."""
    return tuple(
        found
        for target in graph.clear
        if target.category not in graph.parts
        for found in _of(target, graph)
    )


def _of(target: SeenObject, graph: SceneGraph) -> Iterator[Referring]:
    rivals = [
        one
        for one in graph.objects.values()
        if one.category == target.category and one.id != target.id
    ]
    name = named(target.category)
    if not rivals:
        values = {target.id: {"pixels": float(target.pixels)}}
        yield Referring(text=name, object=target.id, category=target.category, values=values)
        return
    for kind, (text, measure, needs_clear) in _FOREMOST.items():
        # Where something hardly seen ends in the picture is not known.
        if needs_clear and not all(one.clear for one in rivals):
            continue
        if all(holds(kind, target, one, graph.view) is not None for one in rivals):
            yield Referring(
                text=text.format(target.category),
                object=target.id,
                category=target.category,
                values={one.id: measure(one) for one in (target, *rivals)},
            )
    if target.colour and all(_is_not(target.colour, one) for one in rivals):
        yield Referring(
            text=f"the {target.colour} {target.category}",
            object=target.id,
            category=target.category,
            values={one.id: {"share": one.colours[target.colour]} for one in (target, *rivals)},
        )
    for relation in graph.of("on", target.id):
        carrier = graph.objects[relation.object]
        same = [one for one in graph.objects.values() if one.category == carrier.category]
        alone = len(same) == 1 and carrier.category not in graph.parts
        # What lies on it may look as if it did not; far from it is clear.
        if alone and all(_is_off(one, carrier) for one in rivals):
            yield Referring(
                text=f"{name} on {named(carrier.category)}",
                object=target.id,
                category=target.category,
                values={one.id: {"bottom_m": one.bottom_m, "top_m": carrier.top_m}
                        for one in (target, *rivals)},
            )  # fmt: skip


def _place(one: SeenObject) -> Mapping[str, float]:
    return {"left_px": float(one.box[0]), "right_px": float(one.box[2])}


_FOREMOST: Mapping[str, tuple[str, Callable[[SeenObject], Mapping[str, float]], bool]] = {
    "nearer than": (
        "the {} nearest to the camera", lambda one: {"value_m": one.distance_m}, False,
    ),
    "taller than": ("the tallest {}", lambda one: {"value_m": one.height_m}, False),
    "left of": ("the leftmost {}", _place, True),
    "right of": ("the rightmost {}", _place, True),
}  # fmt: skip
"""Expression for what has a relation to all others of its category, the numbers that tell it, and
whether the others have to be clear."""


def _is_not(colour: str, one: SeenObject) -> bool:
    """Return whether something is seen well, and has hardly any pixel of a colour."""
    return one.clear and one.colours[colour] <= NOT_OF_COLOUR


def _is_off(one: SeenObject, carrier: SeenObject) -> bool:
    """Return whether something clearly lies elsewhere: its bottom is far from the carrier's top."""
    return abs(one.bottom_m - carrier.top_m) > 0.1

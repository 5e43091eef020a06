"""Questions about two objects: nearer, taller, on which side, how far apart, touching."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping

import numpy as np

from sailenv_ros.frame.language.asking import Asker, Question, balanced_pairs
from sailenv_ros.frame.language.relation_laws import holds
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.wording import metres

__all__ = ["FACING", "pair_questions"]

FACING = frozenset(("chair", "couch", "toilet", "person", "tv", "wardrobe", "refrigerator"))
"""Categories whose front people agree on: their x axis."""

LEAST_BEARING, MOST_BEARING = math.radians(30.0), math.radians(150.0)
"""Angles from the front between which something is at one side [rad]."""

APART_M = 0.02
"""Gap above which things clearly do not touch [m]."""

_KINDS: Mapping[str, str] = {"nearer": "nearer than", "taller": "taller than", "side": "left of"}


def pair_questions(asker: Asker) -> Iterator[Question]:
    """Yield one question of each kind for each object that has a name, about another one."""
    for kind, relation in _KINDS.items():
        for first, second in _drawn_pairs(asker, relation):
            yield _either(asker, kind, relation, first, second)
    for first, second in _drawn_pairs(asker, ""):
        gap = float(np.linalg.norm(first.middle_m - second.middle_m))
        proof = {"id": first.id, "other": float(second.id), "apart_m": gap}
        yield asker.ask("apart", metres(gap), (first, second), proof, value=gap)
    sides = [one for pair in _drawn_pairs(asker, "") for one in _side_from(asker, *pair)]
    left = [one for one in sides if one.answer == "left"]
    yield from balanced_pairs(asker, left, [one for one in sides if one.answer == "right"])
    touching = [_touch(asker, *pair, "yes") for pair in _drawn_pairs(asker, "touching")]
    apart = [
        _touch(asker, first, second, "no")
        for first, second in _drawn_pairs(asker, "")
        if _are_apart(asker, first, second)
    ]
    yield from balanced_pairs(asker, touching, apart if asker.graph.view.facts.gaps else [])


def _drawn_pairs(asker: Asker, relation: str) -> Iterator[tuple[SeenObject, SeenObject]]:
    """Yield random pairs that have a relation; each object is in one of them at most."""
    objects, rng = asker.named, asker.rng
    asked: Counter[int] = Counter()
    for place in rng.permutation(len(objects)).tolist():
        for other in rng.permutation(len(objects)).tolist():
            first, second = objects[place], objects[other]
            if place == other or asked[first.id] or asked[second.id]:
                continue
            if not relation or holds(relation, first, second, asker.graph.view) is not None:
                asked.update((first.id, second.id))
                yield first, second


def _either(
    asker: Asker, kind: str, relation: str, first: SeenObject, second: SeenObject
) -> Question:
    """Ask about two objects of which the first has the relation, in either order."""
    values = holds(relation, first, second, asker.graph.view) or {}
    proof = {"id": first.id, "other": float(second.id), **values}
    swapped = bool(asker.rng.integers(2))
    answer = asker.names[first.id]
    if kind == "side":
        answer = "right" if swapped else "left"
    return asker.ask(kind, answer, (second, first) if swapped else (first, second), proof)


def _side_from(asker: Asker, first: SeenObject, second: SeenObject) -> Iterator[Question]:
    """Ask where the first is, seen from the second, which has a front."""
    if second.category not in FACING:
        return
    x, y, _ = (second.turn.T @ (first.middle_m - second.middle_m)).tolist()
    bearing = math.atan2(y, x)
    clear = LEAST_BEARING <= abs(bearing) <= MOST_BEARING
    if second.is_upright and clear and math.hypot(x, y) > max(second.size_m[:2]):
        proof = {"id": first.id, "from": float(second.id), "left_deg": math.degrees(bearing)}
        side = "left" if bearing > 0.0 else "right"
        yield asker.ask("side_from", side, (first, second), proof)


def _are_apart(asker: Asker, first: SeenObject, second: SeenObject) -> bool:
    gap = asker.graph.view.facts.gaps.get((first.id, second.id))
    return gap is None or gap.gap_m > APART_M


def _touch(asker: Asker, first: SeenObject, second: SeenObject, answer: str) -> Question:
    gap = asker.graph.view.facts.gaps.get((first.id, second.id))
    told = {} if gap is None else {"gap_m": gap.gap_m}
    proof = {"id": first.id, "other": float(second.id), **told}
    return asker.ask("touch", answer, (first, second), proof)

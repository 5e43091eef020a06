"""Questions about one object: distance, height, colour, material, what hides or carries it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sailenv_ros.frame.language.asking import Asker, Fact, Question, balanced_pairs
from sailenv_ros.frame.language.relation_laws import SHUT_SHARE
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.wording import metres, per_cent

__all__ = ["single_questions"]

STEP_MARGIN = 0.3
"""How far a number may be from the middle of its step, of which half would be the next one."""

_CARRIED = {"support": "on", "inside": "in"}


def single_questions(asker: Asker) -> Iterator[Question]:
    """Yield the questions about each object that has a name."""
    opened: list[Question] = []
    shut: list[Question] = []
    for one in asker.named:
        yield _length(asker, "distance", one, one.distance_m)
        if one.is_upright and metres(one.least_height_m) == metres(one.height_m):
            yield _length(asker, "height", one, one.height_m)
        if one.colour and one.colour not in asker.names[one.id]:
            share = one.colours[one.colour]
            proof: Fact = {"id": one.id, "colour": one.colour, "share": share}
            yield asker.ask("colour", one.colour, (one,), proof)
        if one.material:
            share = one.materials[one.material]
            proof = {"id": one.id, "material": one.material, "share": share}
            yield asker.ask("material", one.material, (one,), proof)
        yield from _hidden(asker, one)
        for kind, relation in _CARRIED.items():
            yield from _carrier(asker, kind, relation, one)
        state = _opening(asker, one)
        if state is not None:
            (opened if state.answer == "open" else shut).append(state)
    yield from balanced_pairs(asker, opened, shut)


def _length(asker: Asker, kind: str, one: SeenObject, value: float) -> Question:
    return asker.ask(kind, metres(value), (one,), {"id": one.id, f"{kind}_m": value}, value=value)


def _hidden(asker: Asker, one: SeenObject) -> Iterator[Question]:
    if not math.isnan(one.hidden) and abs(10.0 * one.hidden - round(10.0 * one.hidden)) < (
        STEP_MARGIN
    ):
        proof = {"id": one.id, "pixels": one.pixels, "hidden": one.hidden}
        yield asker.ask("hidden", per_cent(one.hidden), (one,), proof, value=one.hidden)


def _carrier(asker: Asker, kind: str, relation: str, one: SeenObject) -> Iterator[Question]:
    found = asker.graph.of(relation, one.id)
    if len(found) == 1 and found[0].object in asker.names:
        carrier = asker.graph.objects[found[0].object]
        proof = {"id": one.id, relation: float(carrier.id), **found[0].values}
        yield asker.ask(kind, asker.names[carrier.id], (one, carrier), proof)


def _opening(asker: Asker, one: SeenObject) -> Question | None:
    openings = asker.graph.view.facts.openings.values()
    shares = [opening.share for opening in openings if opening.whole == one.id]
    if not shares:
        return None
    proof = {"id": one.id, "share": max(shares)}
    if asker.graph.of("open", one.id):
        return asker.ask("open", "open", (one,), proof)
    return asker.ask("open", "shut", (one,), proof) if max(shares) <= SHUT_SHARE else None

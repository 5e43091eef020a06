"""Questions about what is in another place than in the picture before."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from sailenv_ros.frame.language.asking import Asker, Question, balanced_pairs
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.wording import listed, metres

__all__ = ["change_questions"]

MOVED_M, STILL_M = 0.02, 0.002
"""How far the middle of what has moved has gone at least, of what has not at most [m]."""

TURNED, NOT_TURNED = math.radians(5.0), math.radians(0.5)
"""The same for turns [rad]."""

MOST_NAMED = 3
"""Most objects that one answer names."""


def change_questions(asker: Asker, before: Mapping[int, SeenObject]) -> Iterator[Question]:
    """Yield questions about what both pictures show clearly."""
    both = [one for one in asker.named if one.id in before and before[one.id].clear]
    moved, still, unclear = [], [], False
    for one in both:
        way, turn = _motion(before[one.id], one)
        proof = {"id": one.id, "way_m": way, "turn_deg": math.degrees(turn)}
        if way >= MOVED_M or turn >= TURNED:
            moved.append((one, asker.ask("moved", "yes", (one,), proof)))
            if way >= MOVED_M:
                yield asker.ask("travel", metres(way), (one,), proof, value=way)
        elif way <= STILL_M and turn <= NOT_TURNED:
            still.append(asker.ask("moved", "no", (one,), proof))
        else:
            unclear = True
    yield from balanced_pairs(asker, [question for _, question in moved], still)
    # What both show, but has no name of its own or is hardly seen, would be missing.
    told = {one.id for one in both}
    missing = [one for id_, one in asker.graph.objects.items() if id_ in before and id_ not in told]
    rests = all(sum(_motion(before[one.id], one)) <= STILL_M for one in missing)
    if 1 <= len(moved) <= MOST_NAMED and rests and not unclear:
        objects = [one for one, _ in moved]
        names = sorted(asker.names[one.id] for one in objects)
        facts = [fact for _, question in moved for fact in question.proof]
        yield asker.ask("change", listed(names), objects, facts)


def _motion(before: SeenObject, now: SeenObject) -> tuple[float, float]:
    """Return how far the middle of an object went [m], and by which angle it turned [rad]."""
    way = float(np.linalg.norm(now.middle_m - before.middle_m))
    cosine = 0.5 * (float(np.trace(now.turn @ before.turn.T)) - 1.0)
    return way, math.acos(min(max(cosine, -1.0), 1.0))

"""Questions on a frame, their answers, and the facts from which these follow.

A question is asked only where its answer is clear: categories of which something is hardly seen,
objects that several expressions fit, and differences below the graph's bounds are left out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sailenv_ros.frame.language.referring import referring_expressions
from sailenv_ros.frame.language.scene_graph import SceneGraph, holds
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.wording import PHRASES, metres, named, plural

__all__ = ["QUESTION_KINDS", "Question", "questions"]

QUESTION_KINDS = tuple(PHRASES)

Fact = Mapping[str, float | str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """A question with its answer and proof.

    Attributes
    ----------
    kind : str
        One of `QUESTION_KINDS`.
    text, answer : str
    value : float or None
        Of a count or a length [m]; the answer is that in words.
    objects : tuple of int
        Ids of the objects that it is about.
    proof : tuple of mapping
        The facts from which the answer follows: ``id`` and numbers by their names.
    """

    kind: str
    text: str
    answer: str
    value: float | None = None
    objects: tuple[int, ...] = ()
    proof: tuple[Fact, ...] = ()


def questions(
    graph: SceneGraph, *, seed: int = 0, absent: Iterable[str] = ()
) -> tuple[Question, ...]:
    """Return questions on a frame.

    Parameters
    ----------
    graph : SceneGraph
    seed : int
        Draws phrasings, the order of two objects, and which of `absent` are asked for.
    absent : iterable of str
        Categories that other pictures show: as many as are here are asked for, so that yes and no
        are equally frequent. None are asked for without.

    Returns
    -------
    questions : tuple of Question
        The same ones for the same graph, seed and categories.
    """
    asker = _Asker(graph, np.random.default_rng(seed))
    return tuple(asker.all(sorted(set(absent))))


class _Asker:
    def __init__(self, graph: SceneGraph, rng: np.random.Generator) -> None:
        self._graph, self._rng = graph, rng
        self._of: dict[str, list[SeenObject]] = {}
        for one in graph.objects.values():
            self._of.setdefault(one.category, []).append(one)
        # The shortest expression of each object is the one that people use.
        self._names: dict[int, str] = {}
        for found in referring_expressions(graph):
            present = self._names.get(found.object)
            if present is None or len(found.text) < len(present):
                self._names[found.object] = found.text

    def all(self, absent: list[str]) -> Iterator[Question]:
        yield from self._existence(absent)
        yield from self._counts()
        named_objects = [one for one in self._graph.clear if one.id in self._names]
        for one in named_objects:
            yield self._length("distance", one, one.distance_m)
            yield self._length("height", one, one.height_m)
            yield from self._colour(one)
            yield from self._support(one)
        yield from self._pairs(named_objects)

    def _existence(self, absent: list[str]) -> Iterator[Question]:
        here = [name for name, all_ in self._of.items() if any(one.clear for one in all_)]
        missing = [n for n in absent if n not in self._of and n not in self._graph.parts]
        count = min(len(here), len(missing))
        chosen = self._rng.permutation(len(missing))[:count].tolist()
        for name in self._rng.permutation(here)[: count or len(here)].tolist():
            first = next(one for one in self._of[name] if one.clear)
            yield self._asked(
                "existence", "yes", (first,), a=named(name, definite=False),
                proof=({"id": first.id, "pixels": first.pixels},),
            )  # fmt: skip
        for name in (missing[place] for place in chosen):
            fact = {"category": name, "pixels": 0}
            yield self._asked("existence", "no", (), a=named(name, definite=False), proof=(fact,))

    def _counts(self) -> Iterator[Question]:
        for name, all_ in self._of.items():
            if name not in self._graph.parts and all(one.clear for one in all_):
                yield self._asked(
                    "count", str(len(all_)), tuple(all_), value=float(len(all_)),
                    many=plural(name),
                    proof=tuple({"id": one.id, "pixels": one.pixels} for one in all_),
                )  # fmt: skip

    def _length(self, kind: str, one: SeenObject, value: float) -> Question:
        return self._asked(
            kind, metres(value), (one,), value=value, the=self._names[one.id],
            proof=({"id": one.id, f"{kind}_m": value},),
        )  # fmt: skip

    def _colour(self, one: SeenObject) -> Iterator[Question]:
        if one.colour and one.colour not in self._names[one.id]:
            share = one.colours[one.colour]
            fact: Fact = {"id": one.id, "colour": one.colour, "share": share}
            yield self._asked("colour", one.colour, (one,), the=self._names[one.id], proof=(fact,))

    def _support(self, one: SeenObject) -> Iterator[Question]:
        found = self._graph.of("on", one.id)
        if len(found) == 1 and found[0].object in self._names:
            carrier = self._graph.objects[found[0].object]
            yield self._asked(
                "support", self._names[carrier.id], (one, carrier), the=self._names[one.id],
                proof=({"id": one.id, "on": float(carrier.id), **found[0].values},),
            )  # fmt: skip

    def _pairs(self, objects: list[SeenObject]) -> Iterator[Question]:
        """Yield one question of each kind for each object, about another one."""
        kinds = {"nearer": "nearer than", "taller": "taller than", "side": "left of"}
        for kind, relation in kinds.items():
            asked: Counter[int] = Counter()
            for place in self._rng.permutation(len(objects)).tolist():
                for other in self._rng.permutation(len(objects)).tolist():
                    first, second = objects[place], objects[other]
                    if place == other or asked[first.id] or asked[second.id]:
                        continue
                    values = holds(relation, first, second, self._graph.width)
                    if values is not None:
                        asked.update((first.id, second.id))
                        yield self._pair(kind, first, second, values)

    def _pair(
        self, kind: str, first: SeenObject, second: SeenObject, values: Mapping[str, float]
    ) -> Question:
        """Ask about two objects of which the first has the relation, in either order."""
        proof = ({"id": first.id, "other": float(second.id), **values},)
        swapped = bool(self._rng.integers(2))
        one, two = (second, first) if swapped else (first, second)
        answer = self._names[first.id]
        if kind == "side":
            answer = "right" if swapped else "left"
        return self._asked(
            kind, answer, (one, two), the=self._names[one.id], other=self._names[two.id],
            proof=proof,
        )  # fmt: skip

    def _asked(
        self,
        kind: str,
        answer: str,
        objects: tuple[SeenObject, ...],
        *,
        value: float | None = None,
        proof: tuple[Fact, ...],
        **words: str,
    ) -> Question:
        phrases = PHRASES[kind]
        text = phrases[int(self._rng.integers(len(phrases)))].format(**words)
        return Question(
            kind=kind, text=text, answer=answer, value=value,
            objects=tuple(one.id for one in objects), proof=proof,
        )  # fmt: skip

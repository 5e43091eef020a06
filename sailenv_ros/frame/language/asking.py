"""A question with its answer and proof, and what all kinds of questions are asked with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from sailenv_ros.frame.language.referring import referring_expressions
from sailenv_ros.frame.language.scene_graph import SceneGraph
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.wording import PHRASES

__all__ = ["QUESTION_KINDS", "Asker", "Fact", "Question", "balanced_pairs"]

QUESTION_KINDS = tuple(PHRASES)

Fact: TypeAlias = Mapping[str, "float | str | Sequence[Sequence[float]]"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """A question with its answer and proof.

    Attributes
    ----------
    kind : str
        One of `QUESTION_KINDS`.
    text, answer : str
    value : float or None
        Of a count, a share or a length [m]; the answer is that in words.
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


class Asker:
    """Names, phrasings and chance for the questions on one frame.

    Parameters
    ----------
    graph : SceneGraph
    rng : numpy.random.Generator
        Draws phrasings and orders.

    Attributes
    ----------
    names : mapping of int to str
        The shortest expression that is true of each object alone, by ids.
    named : tuple of SeenObject
        Clear objects that have one.
    """

    def __init__(self, graph: SceneGraph, rng: np.random.Generator) -> None:
        self.graph, self.rng = graph, rng
        self.names: dict[int, str] = {}
        for found in referring_expressions(graph):
            present = self.names.get(found.object)
            if present is None or len(found.text) < len(present):
                self.names[found.object] = found.text
        self.named = tuple(one for one in graph.clear if one.id in self.names)

    def ask(
        self,
        kind: str,
        answer: str,
        objects: Sequence[SeenObject],
        proof: Fact | Sequence[Fact],
        *,
        value: float | None = None,
        **words: str,
    ) -> Question:
        """Return a question in one of its phrasings; the first two objects are named in it."""
        told = {
            word: self.names[one.id]
            for word, one in zip(("the", "other"), objects, strict=False)
            if one.id in self.names
        }
        phrases = PHRASES[kind]
        text = phrases[int(self.rng.integers(len(phrases)))].format(**{**told, **words})
        facts = (proof,) if isinstance(proof, Mapping) else tuple(proof)
        ids = tuple(one.id for one in objects)
        return Question(kind=kind, text=text, answer=answer, value=value, objects=ids, proof=facts)


def balanced_pairs(
    asker: Asker, first: Sequence[Question], second: Sequence[Question]
) -> list[Question]:
    """Return as many questions with the one answer as with the other, drawn at random."""
    count = min(len(first), len(second))
    return [
        group[place]
        for group in (first, second)
        for place in sorted(asker.rng.permutation(len(group))[:count].tolist())
    ]

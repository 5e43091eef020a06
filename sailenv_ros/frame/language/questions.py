"""Questions on a frame, their answers, and the facts from which these follow.

A question is asked only where its answer is clear. Left out are: categories of which something is
hardly seen, objects that no expression is true of alone, differences below the bounds of
`relation_laws`, and numbers near the border between two answers. Of two possible answers each is
asked for equally often; `balance` does so over all questions of a data set.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from sailenv_ros.frame.language.asking import QUESTION_KINDS, Asker, Question, balanced_pairs
from sailenv_ros.frame.language.change_questions import change_questions
from sailenv_ros.frame.language.pair_questions import pair_questions
from sailenv_ros.frame.language.scene_graph import SceneGraph
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.frame.language.single_questions import single_questions
from sailenv_ros.frame.language.walk_questions import walk_questions
from sailenv_ros.frame.language.wording import named, plural

__all__ = ["QUESTION_KINDS", "Question", "questions"]


def questions(
    graph: SceneGraph,
    *,
    seed: int = 0,
    absent: Iterable[str] = (),
    before: Mapping[int, SeenObject] | None = None,
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
    before : mapping of int to SeenObject or None
        What the picture before showed, of the same epoch: asks what has changed since.

    Returns
    -------
    questions : tuple of Question
        The same ones for the same graph, seed and categories.
    """
    asker = Asker(graph, np.random.default_rng(seed))
    return tuple(_all(asker, sorted(set(absent)), before))


def _all(
    asker: Asker, absent: list[str], before: Mapping[int, SeenObject] | None
) -> Iterator[Question]:
    of: dict[str, list[SeenObject]] = {}
    for one in asker.graph.objects.values():
        of.setdefault(one.category, []).append(one)
    yield from _existence(asker, of, absent)
    for name, all_ in of.items():
        if name not in asker.graph.parts and all(one.clear for one in all_):
            yield asker.ask(
                "count", str(len(all_)), all_,
                [{"id": one.id, "pixels": one.pixels} for one in all_],
                value=float(len(all_)), many=plural(name),
            )  # fmt: skip
    yield from single_questions(asker)
    yield from pair_questions(asker)
    yield from walk_questions(asker)
    if before is not None:
        yield from change_questions(asker, before)


def _existence(
    asker: Asker, of: dict[str, list[SeenObject]], absent: list[str]
) -> Iterator[Question]:
    clear = {name: next((one for one in all_ if one.clear), None) for name, all_ in of.items()}
    here = [
        asker.ask(
            "existence", "yes", (first,), {"id": first.id, "pixels": first.pixels},
            a=named(name, definite=False),
        )
        for name, first in clear.items()
        if first is not None
    ]  # fmt: skip
    missing = [
        asker.ask(
            "existence", "no", (), {"category": name, "pixels": 0},
            a=named(name, definite=False),
        )
        for name in absent
        if name not in of and name not in asker.graph.parts
    ]  # fmt: skip
    yield from balanced_pairs(asker, here, missing) if missing else here

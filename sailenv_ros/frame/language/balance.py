"""Equally many questions with each answer, so that guessing the commonest one is no help."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

__all__ = ["balanced"]


def balanced(answers: Sequence[tuple[str, str]], seed: int = 0) -> list[int]:
    """Choose questions so that each answer of a kind is equally frequent.

    Answers that are rarer than a bound are left out, and so many of all others are drawn as the
    rarest of them has. The bound is the one with the greatest product of how many each has and how
    many others there are: a kind with one answer alone is left out. Where the question names the
    choices, as for `NAMES_CHOICES`, nothing is left out.

    Parameters
    ----------
    answers : sequence of (str, str)
        Kind and answer of each question.
    seed : int
        Draws those that are kept.

    Returns
    -------
    places : list of int
        Of the kept questions, ascending.
    """
    rng = np.random.default_rng(seed)
    of: dict[str, dict[str, list[int]]] = defaultdict(lambda: defaultdict(list))
    kept: list[int] = []
    for place, (kind, answer) in enumerate(answers):
        if kind in NAMES_CHOICES:
            kept.append(place)
        else:
            of[kind][answer].append(place)
    for places in of.values():
        counts = sorted((len(own) for own in places.values()), reverse=True)
        each = max(counts, key=lambda count: count * (sum(c >= count for c in counts) - 1))
        for own in places.values():
            if len(own) >= each and len(counts) > 1:
                kept += [own[k] for k in rng.permutation(len(own))[:each].tolist()]
    return sorted(kept)


NAMES_CHOICES = frozenset(("nearer", "taller"))
"""Kinds whose questions name two objects, one of which is the answer; their order is drawn."""

"""English words for facts: articles, numbers, several phrasings of each question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["PHRASES", "counted", "listed", "metres", "named", "plural"]

PHRASES: Mapping[str, Sequence[str]] = {
    "existence": ("Is there {a} in the picture?", "Do you see {a}?", "Can {a} be seen?"),
    "count": (
        "How many {many} are in the picture?",
        "How many {many} can you see?",
        "What is the number of {many} in view?",
    ),
    "distance": (
        "How far away is {the}, in metres?",
        "What is the distance from the camera to {the} in metres?",
    ),
    "height": ("How tall is {the}, in metres?", "What is the height of {the} in metres?"),
    "colour": ("What colour is {the}?", "Which colour does {the} have?"),
    "nearer": (
        "Which is nearer to the camera, {the} or {other}?",
        "Is {the} or {other} closer to the camera?",
    ),
    "taller": ("Which is taller, {the} or {other}?", "Is {the} or {other} taller?"),
    "side": (
        "Is {the} left or right of {other}?",
        "On which side of {other} is {the}, left or right?",
    ),
    "support": ("What is {the} on?", "What does {the} stand or lie on?"),
}
"""Phrasings of each kind of question, of which one is drawn."""

_NUMBERS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")

_VOWELS = "aeiou"
_IRREGULAR = {"knife": "knives", "shelf": "shelves", "dish": "dishes", "glasses": "glasses"}


def named(category: str, *, definite: bool = True) -> str:
    """Return a category with its article: ``the cup``, or ``an apple``."""
    if definite:
        return f"the {category}"
    return f"{'an' if category[0] in _VOWELS else 'a'} {category}"


def plural(category: str) -> str:
    """Return a category in the plural."""
    head, space, last = category.rpartition(" ")
    if last in _IRREGULAR:
        return f"{head}{space}{_IRREGULAR[last]}"
    if last.endswith(("s", "x", "sh", "ch")):
        return f"{category}es"
    if last.endswith("y") and last[-2] not in _VOWELS:
        return f"{category[:-1]}ies"
    return f"{category}s"


def counted(category: str, count: int | None) -> str:
    """Return so many of a category in words: ``a cup``, ``two cups``; some if None."""
    if count == 1:
        return named(category, definite=False)
    if count is None:
        return f"some {plural(category)}"
    few = 2 <= count < 2 + len(_NUMBERS)
    return f"{_NUMBERS[count - 2] if few else 'many'} {plural(category)}"


def listed(things: Sequence[str]) -> str:
    """Return things as a sentence lists them: ``a desk, two cups and a lamp``."""
    *first, last = things
    return f"{', '.join(first)} and {last}" if first else last


def metres(value: float) -> str:
    """Return a length in words, to the centimetre below one metre and to the decimetre above."""
    return f"{value:.2f} m" if value < 1.0 else f"{value:.1f} m"

"""English words for facts: articles, numbers, several phrasings of each question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["PHRASES", "counted", "listed", "metres", "named", "per_cent", "plural"]

PHRASES: Mapping[str, Sequence[str]] = {
    "existence": ("Is there {a} in the picture?", "Do you see {a}?", "Can {a} be seen?"),
    "count": (
        "How many {many} are in the picture?",
        "How many {many} can you see?",
        "What is the number of {many} in view?",
    ),
    "distance": (
        "How far is the middle of {the} from the camera, in metres?",
        "What is the distance from the camera to the middle of {the} in metres?",
        "How many metres lie between the camera and the middle of {the}?",
    ),
    "apart": (
        "How far apart are the middles of {the} and {other}, in metres?",
        "What is the distance in metres between the middles of {the} and {other}?",
    ),
    "height": (
        "How tall is {the}, in metres?",
        "What is the height of {the} in metres?",
        "How many metres does {the} measure from its lowest to its highest point?",
    ),
    "colour": (
        "What colour is {the}?",
        "Which colour does {the} have?",
        "What is the colour of {the}?",
    ),
    "material": (
        "What is {the} mostly made of?",
        "Which material is {the} mostly made of?",
        "What is the main material of {the}?",
    ),
    "hidden": (
        "How much of {the} do other things hide within the picture, to the nearest ten per cent?",
        "To the nearest ten per cent, which share of {the} within the picture is hidden?",
    ),
    "nearer": (
        "Which is nearer to the camera, {the} or {other}?",
        "Is {the} or {other} closer to the camera?",
    ),
    "taller": ("Which is taller, {the} or {other}?", "Is {the} or {other} taller?"),
    "side": (
        "Is {the} left or right of {other}?",
        "On which side of {other} is {the}, left or right?",
    ),
    "side_from": (
        "Seen from {other}, looking to its front, is {the} on the left or on the right?",
        "If you looked ahead from {other}, would {the} be on your left or right?",
    ),
    "support": ("What is {the} on?", "What does {the} stand or lie on?"),
    "inside": ("What is {the} in?", "Which object is {the} inside of?"),
    "touch": ("Do {the} and {other} touch?", "Is {the} in contact with {other}?"),
    "open": ("Is {the} open or shut?", "Does {the} stand open, or is it shut?"),
    "reach": (
        "Can a robot that is {robot} get from below the camera to within half a metre of {the}?",
        "A robot is {robot}. Is there a way for it from below the camera to {the}, within 0.5 m?",
    ),
    "path": (
        "A robot that is {robot} goes from below the camera to {the}. Along its shortest way, does "
        "it begin to the left, to the right, ahead or backwards?",
        "From below the camera, where does the shortest way to {the} begin for a robot that is "
        "{robot}: left, right, ahead or backwards?",
    ),
    "moved": (
        "Has {the} moved since the picture before?",
        "Is {the} in another place than when the picture before was taken?",
    ),
    "travel": (
        "By how many metres has {the} moved since the picture before?",
        "How far is {the} from where it was in the picture before, in metres?",
    ),
    "change": (
        "What has moved in the room since the picture before, of what both pictures show?",
        "Which of the things in both pictures have moved between them?",
    ),
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


def per_cent(share: float) -> str:
    """Return a share in words, to the nearest ten per cent."""
    return f"{10 * round(10.0 * share)} %"


def metres(value: float) -> str:
    """Return a length in words, to the centimetre below one metre and to the decimetre above."""
    return f"{value:.2f} m" if value < 1.0 else f"{value:.1f} m"

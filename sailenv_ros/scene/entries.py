"""Objects described outside a scene file, checked as those inside one.

Plain mappings with the keys of a scene's `objects` in, `ObjectSpec`s out, or an `InvalidEntry`
with every error. Knows no file; what exists is told by a `SceneKnowledge`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import count, islice
from typing import Any

from pydantic import ValidationError

from sailenv_ros.errors import InvalidEntry, InvalidRequest
from sailenv_ros.scene.knowledge import SceneKnowledge
from sailenv_ros.scene.scene_diagnostics import Diagnostic, diagnose
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.spec_lessons import LessonsSpec
from sailenv_ros.scene.spec_objects import ObjectSpec
from sailenv_ros.scene.yaml_nodes import Loc, compose

__all__ = [
    "checked_lessons",
    "checked_object",
    "checked_objects",
    "checked_scene",
    "free_name",
    "plain_value",
    "read_document",
]

MAX_DIAGNOSTICS = 20
"""Greatest number of diagnostics reported: a hostile description must not cost minutes."""

MAX_OBJECTS = 10000

MAX_CHARACTERS = 4_000_000


def checked_object(entry: Mapping[str, Any], knowledge: SceneKnowledge) -> ObjectSpec:
    """Check one object; see `checked_objects`."""
    return _checked([entry], knowledge, what=f"object {entry.get('name')!r}")[0]


def checked_objects(
    entries: Sequence[Mapping[str, Any]], knowledge: SceneKnowledge
) -> tuple[ObjectSpec, ...]:
    """Check several objects, also that their names differ.

    Parameters
    ----------
    entries : sequence of mapping
        With the keys of an object in a scene file.
    knowledge : SceneKnowledge
        What assets, categories and behaviours there are.

    Raises
    ------
    InvalidEntry
        With every error, by its place.
    """
    if len(entries) > MAX_OBJECTS:
        raise InvalidRequest("number of objects", len(entries), f"at most {MAX_OBJECTS}")
    return _checked(entries, knowledge, what="objects")


def checked_lessons(
    lessons: object, objects: Iterable[ObjectSpec], knowledge: SceneKnowledge
) -> LessonsSpec:
    """Check lessons that stand in no file.

    Parameters
    ----------
    lessons : object
        A mapping, as under `lessons` in a scene file.
    objects : iterable of ObjectSpec
        That there are for them.
    knowledge : SceneKnowledge

    Raises
    ------
    InvalidEntry
        With every error, by its place.
    """
    keys = {"name", "asset", "appear", "leave", "behaviours"}
    data = {
        "version": 1,
        "objects": [
            entry.model_dump(mode="json", exclude_unset=True, include=keys) for entry in objects
        ],
        "lessons": plain_value(lessons),
    }
    spec = checked_scene(data, knowledge, what="lessons").lessons
    if spec is None:
        raise InvalidRequest("lessons", lessons, "a mapping with sequence, laps, after, pause")
    return spec


def checked_scene(data: Mapping[str, Any], knowledge: SceneKnowledge, *, what: str) -> SceneSpec:
    """Check a whole scene that stands in no file.

    Parameters
    ----------
    data : mapping
        With the keys of a scene file.
    knowledge : SceneKnowledge
        What assets, categories, behaviours, materials and skies there are.
    what : str
        What an error calls it.

    Raises
    ------
    InvalidEntry
        With every error, by its place.
    """
    spec, found = _validated(data, knowledge)
    if spec is None or found:
        diagnostics = [(_field(diagnostic.loc), diagnostic.message) for diagnostic in found]
        raise InvalidEntry(what, data, dict.fromkeys(diagnostics))
    return spec


def _checked(
    entries: Sequence[Any], knowledge: SceneKnowledge, *, what: str
) -> tuple[ObjectSpec, ...]:
    # A scene of nothing else, so that the sentences are those of a scene file.
    data = {"version": 1, "objects": [plain_value(entry) for entry in entries]}
    spec, found = _validated(data, knowledge)
    if spec is None or found:
        diagnostics = [(_field(diagnostic.loc[1:]), diagnostic.message) for diagnostic in found]
        if len(entries) == 1:
            diagnostics = [
                (field.removeprefix("[0]").lstrip("."), text) for field, text in diagnostics
            ]
        raise InvalidEntry(what, entries, dict.fromkeys(diagnostics))
    return spec.objects


def _validated(
    data: Mapping[str, Any], knowledge: SceneKnowledge
) -> tuple[SceneSpec | None, list[Diagnostic]]:
    spec, error = None, None
    try:
        spec = SceneSpec.model_validate(data)
    except ValidationError as problem:
        error = problem
    return spec, list(islice(diagnose(data, error, knowledge), MAX_DIAGNOSTICS))


def read_document(text: str) -> Any:
    """Read YAML, of which JSON is a part.

    Raises
    ------
    InvalidEntry
        If it cannot be read, with the places.
    """
    if len(text) > MAX_CHARACTERS:
        raise InvalidRequest("length of the document", len(text), f"at most {MAX_CHARACTERS}")
    node, diagnostics = compose(text)
    if node is None or diagnostics:
        pairs = [
            (f"line {diagnostic.mark.line}", diagnostic.message)
            for diagnostic in diagnostics[:MAX_DIAGNOSTICS]
        ]
        raise InvalidEntry("document", text, pairs or [("", "is empty")])
    return node.plain()


def free_name(asset: str, taken: Iterable[str]) -> str:
    """Return the first of ``cube_1``, ``cube_2`` … that is not taken."""
    known = frozenset(taken)
    return next(name for i in count(1) if (name := f"{asset[:50]}_{i}") not in known)


def plain_value(value: Any, *, depth: int = 20) -> Any:
    """Return a value as a scene file would hold it: dicts, lists, texts and numbers.

    Raises
    ------
    InvalidRequest
        If it is nested deeper than `depth`, or in itself.
    """
    if not depth:
        raise InvalidRequest("description of an object", "a deeper one", "nested 20 deep at most")
    if isinstance(value, Mapping):
        return {str(key): plain_value(part, depth=depth - 1) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain_value(part, depth=depth - 1) for part in value]
    # NumPy's arrays and numbers, without importing it for their sake.
    as_python = getattr(value, "tolist", None)
    return as_python() if callable(as_python) else value


def _field(loc: Loc) -> str:
    """Write a place as ``objects[2].scale``."""
    text = ""
    for part in loc:
        text += f"[{part}]" if isinstance(part, int) else f".{part}"
    return text.lstrip(".")

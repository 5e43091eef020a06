"""Diagnostics: everything that is wrong with a scene's plain data, as places and sentences.

Plain data and models in, `Diagnostic`s out. Pydantic's errors become sentences in the words of the
file; unknown keys and names are answered with the nearest known one. Knows no YAML text.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from sailenv_ros.scene.field_types import FIELD_ERROR
from sailenv_ros.scene.fields import BROKEN_RULE, SceneModel
from sailenv_ros.scene.knowledge import OpenNames, SceneKnowledge
from sailenv_ros.scene.messages import nearest, shown, suggestion
from sailenv_ros.scene.randomise.random_rules import drawn_names, random_categories_exist
from sailenv_ros.scene.randomise.randomisation import Randomisation
from sailenv_ros.scene.spec import CategorySpec, EnvironmentSpec, SceneSpec
from sailenv_ros.scene.spec_materials import LookSpec
from sailenv_ros.scene.spec_objects import BehaviourSpec, ObjectSpec
from sailenv_ros.scene.spec_room import (
    FloorAreaSpec,
    PartitionSpec,
    RoomSpec,
    SurfaceSpec,
    WallMaterialsSpec,
)
from sailenv_ros.scene.traversal import entries
from sailenv_ros.scene.yaml_nodes import Loc

__all__ = ["Diagnostic", "diagnose", "model_diagnostics", "name_diagnostics"]


Models: TypeAlias = Mapping[Loc, type[SceneModel]]
"""Model of the mapping at each place."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One error.

    Attributes
    ----------
    loc : tuple of str or int
        The part that is wrong.
    message : str
    of_key : bool
        True if the error is the key, not its value.
    """

    loc: Loc
    message: str
    of_key: bool = False


def diagnose(
    data: Mapping[str, Any], error: ValidationError | None, knowledge: SceneKnowledge | None
) -> Iterator[Diagnostic]:
    """Yield all errors of a scene.

    Parameters
    ----------
    data : mapping
        The scene as plain data.
    error : ValidationError or None
        What pydantic found wrong with it.
    knowledge : SceneKnowledge or None
        Names are not checked without it.
    """
    yield from model_diagnostics(SceneSpec, data, error)
    if knowledge is not None:
        yield from name_diagnostics(SceneSpec, data, knowledge)
        for place, sentence in random_categories_exist(data, knowledge.category_of):
            yield Diagnostic(place, sentence)


def model_diagnostics(
    model: type[SceneModel], data: Mapping[str, Any], error: ValidationError | None
) -> Iterator[Diagnostic]:
    """Yield what is wrong by a model alone: values, unknown and missing keys, broken rules.

    Parameters
    ----------
    model : type of SceneModel
        Of the whole.
    data : mapping
        Plain data.
    error : ValidationError or None
        What pydantic found wrong with it.
    """
    found = list(entries(model, data))
    if error is not None:
        models = {loc: part for loc, part, _ in found}
        for details in error.errors(include_url=False):
            if details["type"] != BROKEN_RULE and not _counts_the_right_alone(details):
                yield _translated(details, data, models)
    for loc, part, entry in found:
        for rule in part.rules:
            for place, sentence in rule(entry):
                yield Diagnostic((*loc, *place), sentence)


def _counts_the_right_alone(details: ErrorDetails) -> bool:
    """Return whether a list is called too short only because entries of it are wrong."""
    if details["type"] != "too_short" or not isinstance(details["input"], list | tuple):
        return False
    return len(details["input"]) >= int(details["ctx"]["min_length"])


def name_diagnostics(
    whole: type[SceneModel], data: Mapping[str, Any], knowledge: SceneKnowledge
) -> Iterator[Diagnostic]:
    """Yield which names of assets, categories, behaviours, materials and skies there are not.

    Parameters
    ----------
    whole : type of SceneModel
        Of the whole: a scene, or what has entries of scenes in it.
    data : mapping
        Plain data.
    knowledge : SceneKnowledge
    """
    listed = data.get("categories")
    own = [c for c in listed if isinstance(c, Mapping)] if isinstance(listed, list) else []
    own_names = [c["name"] for c in own if isinstance(c.get("name"), str)]
    categories = [name for name in knowledge.categories if name != "background"] + own_names
    for place, sentence in knowledge.lesson_errors(data):
        yield Diagnostic(place, sentence)
    for loc, model, entry in entries(whole, data):
        if issubclass(model, ObjectSpec):
            yield from _unknown(loc, entry, "asset", knowledge.assets)
            yield from _unknown(loc, entry, "category", categories)
            for place, sentence in knowledge.object_errors(entry):
                yield Diagnostic((*loc, *place), sentence)
        elif issubclass(model, RoomSpec | WallMaterialsSpec | PartitionSpec | FloorAreaSpec):
            yield from _unknown_surfaces(loc, model, entry, knowledge)
        elif issubclass(model, LookSpec):
            yield from _unknown_looks(loc, entry, knowledge)
        elif issubclass(model, Randomisation):
            yield from _unknown_drawn(loc, entry, knowledge)
        elif issubclass(model, EnvironmentSpec):
            if entry.get("sky_map"):
                yield from _unknown(loc, entry, "sky_map", knowledge.skies)
        elif issubclass(model, CategorySpec):
            if entry.get("name") in knowledge.categories:
                yield Diagnostic(
                    (*loc, "name"), f"{entry['name']!r} is in the fixed table already; use another"
                )
        elif issubclass(model, BehaviourSpec) and isinstance(entry.get("type"), str):
            parameters = {key: value for key, value in entry.items() if key != "type"}
            for place, sentence in knowledge.behaviour_errors(entry["type"], parameters):
                of_key = len(place) == 1 and place[0] in parameters and "not a param" in sentence
                yield Diagnostic((*loc, *place), sentence, of_key)


def _unknown(
    loc: Loc, entry: Mapping[str, Any], key: str, known: Iterable[str]
) -> Iterator[Diagnostic]:
    name = entry.get(key)
    if isinstance(name, str) and name not in known:
        fault = known.fault(name) if isinstance(known, OpenNames) else ""
        why = fault or suggestion(name, known)
        yield Diagnostic((*loc, key), f"there is no {key} {shown(name)}; {why}")


def _unknown_drawn(
    loc: Loc, entry: Mapping[str, Any], knowledge: SceneKnowledge
) -> Iterator[Diagnostic]:
    """Check the names that may be drawn at random."""
    listed = entry.get("assets")
    for index, name in enumerate(listed if isinstance(listed, list) else ()):
        for found in _unknown((), {"asset": name}, "asset", knowledge.assets):
            yield Diagnostic((*loc, "assets", index), found.message)
    for key, known in (("asset", knowledge.assets), ("sky_map", ("", *knowledge.skies))):
        for name in drawn_names(entry.get(key)):
            yield from (
                Diagnostic((*loc, key), found.message)
                for found in _unknown((), {key: name}, key, known)
            )
    rule, settings = entry.get("rule"), entry.get("settings", {})
    if isinstance(rule, str) and isinstance(settings, Mapping):
        for place, sentence in knowledge.camera_errors(rule, settings):
            yield Diagnostic((*loc, *place), sentence)
    for key in ("material", "picture"):
        for name in drawn_names(entry.get(key)):
            for found in _unknown_looks((), {key: name}, knowledge):
                yield Diagnostic((*loc, key), found.message)


def _unknown_surfaces(
    loc: Loc, model: type[SceneModel], entry: Mapping[str, Any], knowledge: SceneKnowledge
) -> Iterator[Diagnostic]:
    """Check the materials of a room that are names alone; those with more keys are entries."""
    for key, field in model.model_fields.items():
        value = entry.get(key)
        surfaces = SurfaceSpec in (field.annotation, *get_args(field.annotation))
        if surfaces and isinstance(value, str):
            for diagnostic in _unknown_looks((), {"material": value}, knowledge):
                yield Diagnostic((*loc, key), diagnostic.message)


def _unknown_looks(
    loc: Loc, entry: Mapping[str, Any], knowledge: SceneKnowledge
) -> Iterator[Diagnostic]:
    """Check the names of a material and of a picture."""
    name, picture = entry.get("material"), entry.get("picture")
    if isinstance(name, str) and name not in knowledge.surfaces:
        if "/" in name and knowledge.material_fault is not None:
            fault = knowledge.material_fault(name)
            if fault:
                yield Diagnostic((*loc, "material"), fault)
        else:
            yield from _unknown(loc, entry, "material", knowledge.surfaces)
    if isinstance(picture, str) and knowledge.picture_fault is not None:
        fault = knowledge.picture_fault(picture)
        if fault:
            yield Diagnostic((*loc, "picture"), fault)


def _translated(details: ErrorDetails, data: Mapping[str, Any], models: Models) -> Diagnostic:
    kind, context = details["type"], details.get("ctx", {})
    loc = _without_tags(details["loc"], data)
    got = shown(details["input"])
    if kind == FIELD_ERROR:
        return Diagnostic(loc, context["sentence"])
    if kind == "extra_forbidden":
        return Diagnostic(loc, _unknown_key(loc, models), of_key=True)
    if kind == "missing":
        return Diagnostic(loc, _missing(loc, models))
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return _tag_diagnostic(kind, loc, context)
    sentence = _SENTENCES.get(kind)
    if sentence is None:
        return Diagnostic(loc, f"{details['msg'][0].lower()}{details['msg'][1:]}, got {got}")
    return Diagnostic(loc, sentence.format(got=got, **context))


_SENTENCES: Mapping[str, str] = {
    "model_type": "must be a mapping (key: value), got {got}",
    "model_attributes_type": "must be a mapping (key: value), got {got}",
    "dict_type": "must be a mapping (key: value), got {got}",
    "tuple_type": "must be a list (each entry begins with -), got {got}",
    "string_type": "must be a text, got {got}",
    "string_too_long": "must be a text of at most {max_length} characters, got {got}",
    "too_long": "must be a list of at most {max_length} entries, got {actual_length}",
    "too_short": "must be a list of at least {min_length} entry, got {actual_length}",
}
"""Pydantic's types of errors that the models can give, besides our own, in words."""


def _tag_diagnostic(kind: str, loc: Loc, context: Mapping[str, Any]) -> Diagnostic:
    place = (*loc, "type")
    if kind == "union_tag_not_found":
        return Diagnostic(place, "is missing; it says which kind this is")
    expected = context["expected_tags"].replace("'", "").split(", ")
    tag = str(context["tag"])
    near = nearest(tag, expected)
    hint = f" (did you mean {near!r}?)" if near else ""
    return Diagnostic(place, f"must be one of: {', '.join(expected)}{hint}, got {shown(tag)}")


def _unknown_key(loc: Loc, models: Models) -> str:
    model = models.get(loc[:-1])
    known = list(model.model_fields) if model is not None else []
    return f"is not a key that is known here; {suggestion(str(loc[-1]), known)}"


def _missing(loc: Loc, models: Models) -> str:
    model = models.get(loc[:-1])
    field = model.model_fields.get(str(loc[-1])) if model is not None else None
    return f"is missing ({field.description})" if field is not None else "is missing"


def _without_tags(loc: Loc, data: object) -> Loc:
    """Take out what the file lacks: kinds of lights, places inside a number for several."""
    kept: list[str | int] = []
    tagged = False
    for index, part in enumerate(loc):
        if not isinstance(data, Mapping | list):
            break  # one number that stands for several
        last = index == len(loc) - 1
        if isinstance(data, Mapping) and part == data.get("type") and not tagged and not last:
            tagged = True
            continue
        tagged = False
        kept.append(part)
        if isinstance(data, Mapping):
            data = data.get(str(part))
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
    return tuple(kept)

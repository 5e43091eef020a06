"""Traversal of plain data beside the models that it should fit.

Finds which model stands for which part of the data, so that unknown keys, rules between keys and
names can be checked however wrong the rest is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, get_args, get_origin

from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.scene.yaml_nodes import Loc

__all__ = ["Entry", "entries"]

Entry = tuple[Loc, type[SceneModel], Mapping[str, Any]]


def entries(model: type[SceneModel], data: object, loc: Loc = ()) -> Iterator[Entry]:
    """Yield each mapping in the data that a model stands for: its place, model and content."""
    if not isinstance(data, Mapping):
        return
    yield loc, model, data
    for key, (choices, named) in _nested(model).items():
        if key not in data:
            continue
        for place, part in _parts(data[key], (*loc, key), named=named):
            chosen = _chosen(choices, part)
            if chosen is not None:
                yield from entries(chosen, part, place)


def _parts(value: object, loc: Loc, *, named: bool) -> Iterator[tuple[Loc, object]]:
    """Yield what stands for a model each: the entries of a list or of a mapping of names."""
    if named:
        for name, part in value.items() if isinstance(value, Mapping) else ():
            yield from _parts(part, (*loc, name), named=False)
    elif isinstance(value, list | tuple):
        for index, part in enumerate(value):
            yield (*loc, index), part
    else:
        yield loc, value


@cache
def _nested(model: type[SceneModel]) -> Mapping[str, tuple[list[type[SceneModel]], bool]]:
    """Return which keys hold models, which ones, and whether by names."""
    found = {
        key: (_models_in(field.annotation), get_origin(field.annotation) is dict)
        for key, field in model.model_fields.items()
    }
    return {key: (choices, named) for key, (choices, named) in found.items() if choices}


def _models_in(annotation: Any) -> list[type[SceneModel]]:
    parts = get_args(annotation)
    if parts:
        return [model for part in parts for model in _models_in(part)]
    if isinstance(annotation, type) and issubclass(annotation, SceneModel):
        return [annotation]
    return []


def _chosen(choices: list[type[SceneModel]], data: object) -> type[SceneModel] | None:
    """Pick the model whose `type` the data names, where there are several."""
    if len(choices) == 1:
        return choices[0]
    word = data.get("type") if isinstance(data, Mapping) else None
    for model in choices:
        if word in get_args(model.model_fields["type"].annotation):
            return model
    return None

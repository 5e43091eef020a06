"""Traversal of plain data beside the models that it should fit.

Finds which model stands for which part of the data, so that unknown keys, rules between keys and
names can be checked however wrong the rest is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, get_args

from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.scene.yaml_nodes import Loc

__all__ = ["Entry", "entries"]

Entry = tuple[Loc, type[SceneModel], Mapping[str, Any]]


def entries(model: type[SceneModel], data: object, loc: Loc = ()) -> Iterator[Entry]:
    """Yield each mapping in the data that a model stands for: its place, model and content."""
    if not isinstance(data, Mapping):
        return
    yield loc, model, data
    for key, field in model.model_fields.items():
        choices = _models_in(field.annotation)
        if not choices or key not in data:
            continue
        value = data[key]
        numbered = enumerate(value) if isinstance(value, list | tuple) else [(None, value)]
        for index, part in numbered:
            chosen = _chosen(choices, part)
            if chosen is not None:
                place = (*loc, key) if index is None else (*loc, key, index)
                yield from entries(chosen, part, place)


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

"""JSON Schema of the scene format, for editors that complete and check YAML.

Models in, a JSON text out; which behaviours exist is told by the caller.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.system.files import write_file

__all__ = ["SCHEMA_FILE", "is_stale", "scene_schema", "schema_text", "write_schema"]

SCHEMA_FILE = "scene.schema.json"
"""Name of the file, beside the scenes."""


def scene_schema(behaviours: Mapping[str, type[BaseModel]]) -> dict[str, Any]:
    """Describe the scene format (JSON Schema, draft 7: what editors know best).

    Parameters
    ----------
    behaviours : mapping of str to type
        Model of the parameters of each behaviour.
    """
    schema = _without_titles(SceneSpec.model_json_schema())
    schema["$defs"].update(_behaviour_definitions(behaviours))
    head = {"$schema": "http://json-schema.org/draft-07/schema#", "title": "sailenv_ros scene"}
    return {**head, **schema}


def schema_text(behaviours: Mapping[str, type[BaseModel]]) -> str:
    """Return the schema as the text that its file has."""
    return json.dumps(scene_schema(behaviours), indent=1, ensure_ascii=False) + "\n"


def write_schema(path: Path, behaviours: Mapping[str, type[BaseModel]]) -> None:
    """Write the schema's file."""
    write_file(path, schema_text(behaviours).encode())


def is_stale(path: Path, behaviours: Mapping[str, type[BaseModel]]) -> bool:
    """Return whether the schema's file is not what `write_schema` would write now."""
    return not path.is_file() or path.read_text(encoding="utf-8") != schema_text(behaviours)


def _behaviour_definitions(behaviours: Mapping[str, type[BaseModel]]) -> dict[str, Any]:
    """Describe a behaviour: its type decides which other keys there are."""
    definitions: dict[str, Any] = {}
    cases = []
    for name, model in sorted(behaviours.items()):
        parameters = _without_titles(model.model_json_schema())
        definitions.update(parameters.pop("$defs", {}))
        parameters["properties"] = {"type": {"const": name}, **parameters.get("properties", {})}
        is_this = {"properties": {"type": {"const": name}}, "required": ["type"]}
        cases.append({"if": is_this, "then": parameters})
    kind = {
        "anyOf": [{"enum": sorted(behaviours)}, {"type": "string", "pattern": "^[^:]+:[^:]+$"}],
        "description": "name of the behaviour; it decides which other keys there are",
    }
    definitions["BehaviourSpec"] = {
        "type": "object",
        "description": "How an object moves of itself.",
        "properties": {"type": kind},
        "required": ["type"],
        "allOf": cases,
    }
    return definitions


def _without_titles(schema: Any) -> Any:
    """Leave out the titles that pydantic makes of names: they say nothing new."""
    if isinstance(schema, list):
        return [_without_titles(entry) for entry in schema]
    if not isinstance(schema, dict):
        return schema
    return {
        key: _without_titles(value)
        for key, value in schema.items()
        if not (key == "title" and isinstance(value, str))
    }

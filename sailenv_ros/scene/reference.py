"""The reference page of the scene format, written from its JSON Schema.

A schema in, Markdown out: one table for each kind of entry, with what every key takes, its default
and what it means. It stands in `docs/scene_format.md` below a marker.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.system.files import write_file

__all__ = ["MARKER", "is_stale", "reference", "write_reference"]

MARKER = "<!-- All below is written by: sailenv scene schema. -->"

_TITLES = {
    "AgentSpecModel": "An agent",
    "AreaLightSpec": "An area light",
    "BehaviourSpec": "A behaviour",
    "CategorySpec": "A category",
    "CurtainSpec": "Curtains",
    "DirectionalLightSpec": "A directional light",
    "DoorSpec": "A door",
    "DoorwaySpec": "A doorway",
    "FloorAreaSpec": "A floor area",
    "EnvironmentSpec": "The environment",
    "LessonSpec": "A lesson",
    "LessonsSpec": "Lessons",
    "JointSpec": "A joint",
    "BodySpec": "A body",
    "LookAtSpec": "What is faced",
    "MaterialSpec": "A material",
    "MoverSpec": "A mover",
    "ObjectSpec": "An object",
    "OutsideSpec": "What lies outside",
    "PartitionSpec": "A partition",
    "PictureSpec": "A picture",
    "PointLightSpec": "A point light",
    "RandomCamera": "Random cameras",
    "RandomDistractors": "Random distractors",
    "RandomSpawn": "Random spawns",
    "RandomBehaviour": "Random behaviours",
    "RandomEnvironment": "Random surroundings",
    "RandomLight": "Random lights",
    "RandomMaterial": "Random materials",
    "RandomObject": "Random objects",
    "RoomSpec": "The room",
    "SkirtingSpec": "The skirting",
    "SpotLightSpec": "A spot light",
    "SurfaceSpec": "A surface",
    "WallMaterialsSpec": "Walls that differ",
    "WaypointSpec": "A waypoint",
    "WindowSpec": "A window",
}


def reference(schema: Mapping[str, Any]) -> str:
    """Return the reference as Markdown.

    Parameters
    ----------
    schema : mapping
        What `scene.schema.scene_schema` gives.
    """
    lines = [MARKER, "", "## Reference", "", "### The scene", ""]
    lines += _table(schema)
    for name, title in _TITLES.items():
        definition = schema["$defs"].get(name)
        if definition is not None and definition.get("properties"):
            lines += ["", f"### {title}", ""]
            lines += _table(definition)
    return "\n".join(lines) + "\n"


def write_reference(path: Path, schema: Mapping[str, Any]) -> None:
    """Replace what stands below the marker."""
    head, _, _ = path.read_text(encoding="utf-8").partition(MARKER)
    write_file(path, (head + reference(schema)).encode())


def is_stale(path: Path, schema: Mapping[str, Any]) -> bool:
    """Return whether `write_reference` would change the page."""
    _, marker, rest = path.read_text(encoding="utf-8").partition(MARKER)
    return marker + rest != reference(schema)


def _table(model: Mapping[str, Any]) -> Iterator[str]:
    yield "| Key | Takes | Default | Meaning |"
    yield "|---|---|---|---|"
    required = model.get("required", ())
    for key, entry in model["properties"].items():
        default = "**needed**" if key in required else _default(entry)
        meaning = entry.get("description", "").replace("|", "\\|")
        yield f"| `{key}` | {_takes(entry)} | {default} | {meaning} |"


def _default(entry: Mapping[str, Any]) -> str:
    value = entry.get("default")
    if value is None or value in ([], {}, ""):
        return ""
    rounded = json.loads(json.dumps(value), parse_float=lambda number: round(float(number), 4))
    text = json.dumps(rounded, ensure_ascii=False)
    return f"`{text}`" if len(text) <= 40 else "see there"


def _takes(entry: Mapping[str, Any]) -> str:
    if "$ref" in entry:
        return _link(entry["$ref"])
    if "const" in entry:
        return f"`{entry['const']}`"
    if "enum" in entry:
        return ", ".join(f"`{value}`" for value in entry["enum"])
    for several in ("anyOf", "oneOf", "allOf"):
        if several in entry:
            kinds = [_takes(kind) for kind in entry[several] if kind != {"type": "null"}]
            return " or ".join(dict.fromkeys(kinds))
    return _plain(entry)


def _plain(entry: Mapping[str, Any]) -> str:
    kind = entry.get("type")
    if "log_uniform" in entry.get("properties", ()):
        relative = " or [a relative one](randomisation.md#relative-values)"
        told = relative if "times" in entry["properties"] else ""
        return f"[a distribution](randomisation.md#distributions){told}"
    if kind == "array":
        items = entry.get("items")
        each = _takes(items) if isinstance(items, Mapping) else "values"
        count = entry.get("minItems") if entry.get("minItems") == entry.get("maxItems") else None
        return f"{count} × {each}" if count else f"list of {each}"
    if kind in ("number", "integer"):
        return _number(entry)
    return {"boolean": "true, false", "string": "text", "object": "keys"}.get(str(kind), "")


def _number(entry: Mapping[str, Any]) -> str:
    above, high = entry.get("exclusiveMinimum"), entry.get("maximum")
    low = entry.get("minimum", above)
    noun = "whole number" if entry.get("type") == "integer" else "number"
    if low is None or high is None or high >= 1e4:
        sign = "≥" if above is None else ">"
        return noun if low is None or low < 0 else f"{noun} {sign} {low:g}"
    return f"{noun} {low:g} to {high:g}" if above is None else f"{noun} > {low:g}, ≤ {high:g}"


def _link(reference_path: str) -> str:
    name = reference_path.rpartition("/")[2]
    title = _TITLES.get(name, name)
    anchor = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")
    return f"[{title.lower()}](#{anchor})"

"""Reference tables of the scene format, written from its JSON Schema into the pages of docs/.

A schema in, Markdown out. Each page holds the tables of some kinds of entries below a marker; a
table tells what every key takes, its default and what it means. Keys that several kinds share
stand in one table.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.system.files import write_file

__all__ = ["MARKER", "PAGES", "is_stale", "reference", "write_reference"]

MARKER = "<!-- All below is written by: sailenv scene schema. -->"

_LIGHTS = ("DirectionalLightSpec", "PointLightSpec", "SpotLightSpec", "AreaLightSpec")
_RANDOM = {
    "RandomObject": "Random objects",
    "RandomMaterial": "Random materials",
    "RandomLight": "Random lights",
    "RandomEnvironment": "Random surroundings",
    "RandomCamera": "Random cameras",
    "RandomSpawn": "Random spawns",
    "RandomPeople": "Random people",
    "RandomBehaviour": "Random behaviours",
    "RandomDistractors": "Random distractors",
}

_BEHAVIOURS = {
    "linear_waypoints": "linear_waypoints, catmull_waypoints",
    "fetch": "fetch",
    "lie": "lie",
    "open_and_close": "open_and_close",
    "open_by_hand": "open_by_hand",
    "play_clip": "play_clip",
    "poltergeist": "poltergeist",
    "rotate_rigidbody": "rotate_rigidbody",
    "sit": "sit",
    "uniform_movement_random_bounce": "uniform_movement_random_bounce",
    "visit": "visit",
    "walk_around": "walk_around",
    "wander_plane": "wander_plane",
    "wrench": "wrench",
}

PAGES: Mapping[str, Mapping[str, str]] = {
    "scene_format.md": {"": "The scene"},
    "scene_rooms.md": {
        "RoomSpec": "The room",
        "WallMaterialsSpec": "Walls that differ",
        "SurfaceSpec": "A surface",
        "SkirtingSpec": "The skirting",
        "WindowSpec": "A window",
        "CurtainSpec": "Curtains",
        "DoorSpec": "A door",
        "PartitionSpec": "A partition",
        "DoorwaySpec": "A doorway",
        "FloorAreaSpec": "A floor area",
        "OutsideSpec": "What lies outside",
    },
    "scene_objects.md": {
        "ObjectSpec": "An object",
        "MaterialSpec": "A material",
        "JointSpec": "A joint",
        "SoftCloseSpec": "A soft close",
        "DetentsSpec": "Detents",
        "BehaviourSpec": "A behaviour",
        "CategorySpec": "A category",
        "LessonsSpec": "Lessons",
        "LessonSpec": "A lesson",
    },
    "robots.md": {
        "RobotSpec": "A robot",
        "RobotJointSpec": "A joint of a robot",
        "WheelsSpec": "Wheels",
        "SensorSpec": "A sensor",
    },
    "scene_lights.md": {
        "EnvironmentSpec": "The environment",
        "_light": "Every light",
        "DirectionalLightSpec": "A directional light",
        "PointLightSpec": "A point light",
        "SpotLightSpec": "A spot light",
        "AreaLightSpec": "An area light",
    },
    "scene_cameras.md": {
        "_camera": "Every camera",
        "AgentSpecModel": "An agent",
        "RigCameraSpec": "A camera of a rig",
        "PictureSpec": "A picture",
        "MoverSpec": "A mover",
        "WaypointSpec": "A waypoint",
        "BodySpec": "A body",
        "LookAtSpec": "What is faced",
    },
    "behaviours.md": {
        "_behaviour": "Every behaviour",
        **_BEHAVIOURS,
        "ObjectWaypoint": "A waypoint of an object",
    },
    "randomisation.md": {"_random": "Every entry", **_RANDOM},
}
"""Names of the pages, with the kinds of entries that each describes and their headings."""

_SHARED = {
    **dict.fromkeys(("AgentSpecModel", "RigCameraSpec"), "_camera"),
    **dict.fromkeys(_LIGHTS, "_light"),
    **dict.fromkeys(_RANDOM, "_random"),
    **dict.fromkeys(_BEHAVIOURS, "_behaviour"),
    "MaterialSpec": "SurfaceSpec",
}
"""Kinds whose table leaves out what another table has."""

_TITLES = {name: (page, title) for page, kinds in PAGES.items() for name, title in kinds.items()}


def reference(schema: Mapping[str, Any], page: str) -> str:
    """Return the tables of a page as Markdown.

    Parameters
    ----------
    schema : mapping
        What `scene.schema.scene_schema` gives.
    page : str
        Name of the page, one of `PAGES`.
    """
    behaviours = [case["then"] for case in schema["$defs"]["BehaviourSpec"]["allOf"]]
    named = {case["properties"]["type"]["const"]: case for case in behaviours}
    kinds = _with_shared({"": schema, **schema["$defs"], **named})
    lines = [MARKER, "", "## Reference"]
    for name, title in PAGES[page].items():
        lines += ["", f"### {title}", "", *_lead(name, kinds), *_table(kinds[name], page)]
    return "\n".join(lines) + "\n"


def write_reference(folder: Path, schema: Mapping[str, Any]) -> None:
    """Replace what stands below the marker of each page."""
    for page in PAGES:
        path = folder / page
        head, _, _ = path.read_text(encoding="utf-8").partition(MARKER)
        write_file(path, (head + reference(schema, page)).encode())


def is_stale(folder: Path, schema: Mapping[str, Any]) -> bool:
    """Return whether `write_reference` would change a page."""
    for page in PAGES:
        _, marker, rest = (folder / page).read_text(encoding="utf-8").partition(MARKER)
        if marker + rest != reference(schema, page):
            return True
    return False


def _with_shared(kinds: Mapping[str, Any]) -> dict[str, Any]:
    """Add the tables of shared keys; take these keys out of the kinds that share them."""
    found = dict(kinds)
    for shared in ("_camera", "_light", "_random", "_behaviour"):
        members = [kinds[name] for name, family in _SHARED.items() if family == shared]
        first, *others = members
        same = {
            key: entry
            for key, entry in first["properties"].items()
            if all(other["properties"].get(key) == entry for other in others)
        }
        found[shared] = {"properties": same, "required": first.get("required", ())}
    for name, family in _SHARED.items():
        known = found[family]["properties"]
        keys = {k: e for k, e in kinds[name]["properties"].items() if known.get(k) != e}
        found[name] = {**kinds[name], "properties": keys}
    return found


def _lead(name: str, kinds: Mapping[str, Any]) -> Iterator[str]:
    """Yield a line on keys of few values, and on where further keys stand."""
    few = [
        f"`{key}: {values[0]}`" + "".join(f" or `{value}`" for value in values[1:])
        for key, entry in sorted(kinds[name]["properties"].items(), reverse=True)
        if (values := _few_values(key, entry))
    ]
    family = _SHARED.get(name)
    if family is not None and name not in _BEHAVIOURS:  # their titles are their types
        kind = ", ".join(few)
        also = f"the keys of [{_TITLES[family][1].lower()}]({_anchor(family, _TITLES[name][0])})"
        yield f"{kind}, and {also}." if kind else f"All {also}."
        yield ""


def _few_values(key: str, entry: Mapping[str, Any]) -> list[str]:
    """Return the values of a key that a line tells instead of the table."""
    values = [entry["const"]] if "const" in entry else entry.get("enum", [])
    return values if len(values) == 1 or key == "every" else []


def _table(model: Mapping[str, Any], page: str) -> Iterator[str]:
    yield "|Key|Takes|Default|Meaning|"
    yield "|---|---|---|---|"
    required = model.get("required", ())
    for key, entry in model["properties"].items():
        if not _few_values(key, entry):
            default = "**needed**" if key in required else _default(entry)
            meaning = entry.get("description", "").replace("|", "\\|")
            yield f"|`{key}`|{_takes(entry, page)}|{default}|{meaning}|"


def _default(entry: Mapping[str, Any]) -> str:
    value = entry.get("default")
    if value is None or value in ([], {}, ""):
        return ""
    rounded = json.loads(json.dumps(value), parse_float=lambda number: round(float(number), 4))
    text = json.dumps(rounded, ensure_ascii=False)
    return f"`{text}`" if len(text) <= 60 else "the first five"


def _takes(entry: Mapping[str, Any], page: str) -> str:
    if "$ref" in entry:
        name = entry["$ref"].rpartition("/")[2]
        return f"[{_TITLES[name][1].lower()}]({_anchor(name, page)})"
    if "const" in entry:
        return f"`{entry['const']}`"
    if "enum" in entry:
        return ", ".join(f"`{value}`" for value in entry["enum"])
    for several in ("anyOf", "oneOf", "allOf"):
        if several in entry:
            return _several([kind for kind in entry[several] if kind != {"type": "null"}], page)
    return _plain(entry, page)


def _several(kinds: list[Mapping[str, Any]], page: str) -> str:
    drawn = [kind for kind in kinds if "log_uniform" in kind.get("properties", ())]
    plain = [kind for kind in kinds if kind not in drawn]
    triples = [kind for kind in plain if kind.get("maxItems") == 3 and "type" in kind["items"]]
    if triples and any(kind.get("type") == "string" for kind in plain):
        texts = ["colour" if triples[0]["items"].get("maximum") == 1 else "colour ≥0"]
    else:
        texts = [_takes(kind, page) for kind in plain]
    text = " or ".join(dict.fromkeys(texts))
    if drawn:
        text += ", relative" if "times" in drawn[0]["properties"] else ", drawn"
    return text


def _plain(entry: Mapping[str, Any], page: str) -> str:
    kind = entry.get("type")
    if kind == "array":
        items = entry.get("items")
        each = _takes(items, page) if isinstance(items, Mapping) else "values"
        count = entry.get("minItems") if entry.get("minItems") == entry.get("maxItems") else None
        return f"{count} × {each}" if count else f"list of {each}"
    if kind in ("number", "integer"):
        return _number(entry)
    return {"boolean": "boolean", "string": "text", "object": "keys"}.get(str(kind), "")


def _number(entry: Mapping[str, Any]) -> str:
    above, high = entry.get("exclusiveMinimum"), entry.get("maximum")
    low = entry.get("minimum", above)
    noun = "integer" if entry.get("type") == "integer" else "number"
    if low is not None and low == high:
        return f"`{low:g}`"
    if low is None or high is None or high == 1e6 or high >= 2**31 - 1:
        sign = "≥" if above is None else ">"
        return noun if low is None or low < 0 else f"{noun} {sign}{low:g}"
    high = int(high) if high == int(high) else high
    return f"{noun} {low:.10g}…{high}" if above is None else f"{noun} >{low:g}, ≤{high}"


def _anchor(name: str, page: str) -> str:
    where, title = _TITLES[name]
    anchor = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")
    return f"#{anchor}" if where == page else f"{where}#{anchor}"

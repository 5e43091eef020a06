"""Name of a ROS message type → its full definition, hash and class, from where it is installed.

Definitions lie in `share/<package>/msg`, below the same prefix as the Python package, whether
pip, colcon or apt installed it. Gets packages by name; imports none by itself.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import re
from functools import cache
from pathlib import Path
from typing import Any

from sailenv_ros.errors import RecordingError

__all__ = ["message_class", "schema_text", "type_hash"]

_NAME = re.compile(r"([a-z][a-z0-9_]*)/(?:msg/)?([A-Za-z][A-Za-z0-9]*)")
_FIELD = re.compile(
    r"^\s*([A-Za-z][A-Za-z0-9_/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]", re.MULTILINE
)
_RULE = "=" * 80
_PRIMITIVE = frozenset({"bool", "byte", "char", "string", "wstring", "float32", "float64"}) | {
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}


@cache
def message_class(name: str) -> Any:
    """Return the Python class of a type, e.g. ``"sensor_msgs/msg/Image"``.

    Raises
    ------
    RecordingError
        If there is no such type installed.
    """
    package, kind = _split(name)
    try:
        return getattr(importlib.import_module(f"{package}.msg"), kind)
    except (ImportError, AttributeError):
        raise RecordingError(f"message type {name} is not installed (package {package})") from None


@cache
def schema_text(name: str) -> str:
    """Return the definition of a type, followed by those of all types that it consists of.

    Raises
    ------
    RecordingError
        If a definition is not installed.
    """
    root = _split(name)
    texts: dict[tuple[str, str], str] = {}
    waiting = [root]
    while waiting:
        key = waiting.pop(0)
        if key not in texts:
            texts[key] = _definition(key, ".msg").strip() + "\n"
            waiting += _parts(texts[key], key[0])
    own = texts.pop(root)
    others = (f"{_RULE}\nMSG: {package}/{kind}\n{text}" for (package, kind), text in texts.items())
    return own + "".join(others)


@cache
def type_hash(name: str) -> str:
    """Return the hash by which ROS compares types; empty where it is not installed."""
    try:
        description = json.loads(_definition(_split(name), ".json"))
    except (RecordingError, ValueError):
        return ""
    for entry in description.get("type_hashes", ()):
        if entry.get("type_name") == "/".join((_split(name)[0], "msg", _split(name)[1])):
            return str(entry.get("hash_string", ""))
    return ""


def _split(name: str) -> tuple[str, str]:
    matched = _NAME.fullmatch(name)
    if matched is None:
        raise RecordingError(f"message type {name!r} must be named like sensor_msgs/msg/Image")
    return matched[1], matched[2]


def _parts(text: str, package: str) -> list[tuple[str, str]]:
    """Return the types of a definition's fields that are messages themselves."""
    found = []
    for line in text.splitlines():
        matched = _FIELD.match(line.split("#")[0])
        if matched and matched[1] not in _PRIMITIVE:
            owner, _, kind = matched[1].rpartition("/")
            found.append((owner or package, kind))
    return found


def _definition(key: tuple[str, str], suffix: str) -> str:
    package, kind = key
    spec = importlib.util.find_spec(package)
    places = [] if spec is None else list(spec.submodule_search_locations or ())
    for place in places:
        for prefix in Path(place).resolve().parents:
            path = prefix / "share" / package / "msg" / f"{kind}{suffix}"
            if path.is_file():
                return path.read_text(encoding="utf-8")
    raise RecordingError(f"the definition of {package}/msg/{kind} is not installed")

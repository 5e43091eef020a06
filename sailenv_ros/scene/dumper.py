"""`SceneSpec` → YAML text that `load_scene` reads back to an equal one."""

from __future__ import annotations

from typing import Any

import yaml

from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.yaml_nodes import plain_scalar

__all__ = ["dump_scene"]

WIDTH = 120
"""Longest line, but for texts that cannot be broken."""

MARGIN = 6
"""Width kept free for the text that usually precedes a collection on its line [characters]."""

FIRST = ("name", "type", "asset", "on", "level", "wall", "at", "position")
"""Keys by which people know an entry, and where it is."""


def dump_scene(spec: SceneSpec) -> str:
    """Write a scene with the keys that were given; the rest are defaults.

    The sections stand apart; what fits on one line stands there, as in
    ``- {name: box, asset: cube}``.
    """
    data = spec.model_dump(mode="json", exclude_unset=True)
    return "".join(_section(key, value) for key, value in data.items())


def _section(key: str, value: object) -> str:
    content = _Section({key: value})
    text = yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=WIDTH)
    parts = value if isinstance(value, list) else [value]
    return f"\n{text}" if any(isinstance(part, dict) for part in parts) else text


class _Section(dict[str, object]):
    """One key of the scene with its value, which never stands in braces."""


class _Dumper(yaml.SafeDumper):
    """Quotes the texts that YAML 1.2 would read as something else; writes no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:
        # Lists in mappings are indented, as people write them.
        super().increase_indent(flow, indentless=False)


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = None if plain_scalar(text) == text else '"'
    if _is_paragraph(text):
        style = ">"
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


def _is_paragraph(text: str) -> bool:
    """Return whether a text is long and its lines can be broken at spaces, and nowhere else."""
    words = text.removesuffix("\n")
    return len(words) > WIDTH // 2 and words.isprintable() and words == " ".join(words.split())


def _number(dumper: yaml.SafeDumper, number: float) -> yaml.ScalarNode:
    """Write whole numbers as people do."""
    if number.is_integer() and abs(number) < 1e9:
        return dumper.represent_int(int(number))
    return dumper.represent_float(number)


def _list(dumper: yaml.SafeDumper, values: list[Any]) -> yaml.SequenceNode:
    return dumper.represent_sequence("tag:yaml.org,2002:seq", values, flow_style=_is_short(values))


def _mapping(dumper: yaml.SafeDumper, entry: dict[str, Any]) -> yaml.MappingNode:
    first = [key for key in FIRST if key in entry]
    ordered = {key: entry[key] for key in (*first, *(key for key in entry if key not in first))}
    return dumper.represent_mapping("tag:yaml.org,2002:map", ordered, flow_style=_is_short(ordered))


def _block(dumper: yaml.SafeDumper, section: _Section) -> yaml.MappingNode:
    return dumper.represent_mapping("tag:yaml.org,2002:map", section, flow_style=False)


def _is_short(value: object) -> bool:
    """Return whether a collection fits on one line; several mappings in a list have one each."""
    return _length(value) <= WIDTH - MARGIN


def _length(value: object) -> int:
    if isinstance(value, dict):
        return sum(_length(key) + _length(part) + 4 for key, part in value.items())
    if isinstance(value, list):
        mappings = sum(isinstance(part, dict) for part in value)
        return WIDTH if mappings > 1 else sum(_length(part) + 2 for part in value)
    return len(str(value))


# The key `on`, which YAML 1.1 took for a truth value.
_Dumper.yaml_implicit_resolvers = {**yaml.SafeDumper.yaml_implicit_resolvers, "o": []}
_Dumper.add_representer(str, _text)
_Dumper.add_representer(float, _number)
_Dumper.add_representer(list, _list)
_Dumper.add_representer(dict, _mapping)
_Dumper.add_representer(_Section, _block)

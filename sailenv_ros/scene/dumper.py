"""`SceneSpec` → YAML text that `load_scene` reads back to an equal one."""

from __future__ import annotations

from typing import Any

import yaml

from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.yaml_nodes import plain_scalar

__all__ = ["dump_scene"]


def dump_scene(spec: SceneSpec) -> str:
    """Write a scene with the keys that were given; the rest are defaults."""
    data = spec.model_dump(mode="json", exclude_unset=True)
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)


class _Dumper(yaml.SafeDumper):
    """Quotes the texts that YAML 1.2 would read as something else; writes no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    style = None if plain_scalar(text) == text else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _text)

"""A generated scene as people would write it, with headings. `SceneSpec` in, text out."""

from __future__ import annotations

from collections.abc import Sequence

from sailenv_content.generation.items import Item
from sailenv_ros.scene.dumper import dump_scene
from sailenv_ros.scene.spec import SceneSpec

__all__ = ["scene_text"]


def scene_text(spec: SceneSpec, kind: str, seed: int, items: Sequence[Item]) -> str:
    """Return the text of a scene file, which `load_scene` reads back to an equal scene.

    The file's name gives the scene its own.
    """
    unnamed = SceneSpec.model_construct(
        _fields_set=spec.model_fields_set - {"name"}, **dict(spec.__dict__)
    )
    lines = [
        "# yaml-language-server: $schema=scene.schema.json",
        f"# Made by: sailenv scene generate --kind {kind} --seed {seed}",
    ]
    headings = _headings(items)
    names = [item.name for item in items]
    number, inside = 0, False
    for line in dump_scene(unnamed).splitlines():
        if not line.startswith(" "):
            inside = line == "objects:"
        if inside and line.startswith("  - "):
            if names[number] in headings:
                lines.append(f"  # ---- {headings[names[number]]}")
            number += 1
        lines.append(line)
    return "\n".join(lines) + "\n"


def _headings(items: Sequence[Item]) -> dict[str, str]:
    """Return what stands above the first object of each group, by the object's name."""
    headings: dict[str, str] = {}
    last = ""
    for item in items:
        if item.section != last:
            area, _, heading = item.section.partition(":")
            headings[item.name] = f"{area}, {heading}" if area else heading
            last = item.section
    return headings

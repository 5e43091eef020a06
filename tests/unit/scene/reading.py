"""Helpers of the tests of scene files: text in, spec or errors out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.errors import SceneError
from sailenv_ros.scene import SceneKnowledge, SceneSpec, load_scene
from sailenv_ros.scene.knowledge import Diagnostics


def _behaviour_errors(type_: str, parameters: Mapping[str, Any]) -> Diagnostics:
    if type_ != "spin":
        yield ("type",), "must be one of: spin"
    elif "rate" in parameters and not isinstance(parameters["rate"], int):
        yield ("rate",), "must be an integer"


KNOWLEDGE = SceneKnowledge(
    assets=("cube", "Cube", "sphere", "chair_01", "Chair 01"),
    categories=("background", "cube", "chair", "dining table"),
    behaviour_errors=_behaviour_errors,
    surfaces=("plaster", "oak_planks", "white_tiles"),
)


def read(
    folder: Path, text: str | bytes, *, knowledge: SceneKnowledge | None = KNOWLEDGE
) -> SceneSpec:
    path = folder / "room.yaml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return load_scene(path, knowledge=knowledge)


def diagnostics(folder: Path, text: str | bytes) -> list[str]:
    """Return the errors as ``line:column: field: message``; empty if there are none."""
    try:
        read(folder, text)
    except SceneError as error:
        return [
            str(diagnostic).removeprefix(f"{folder / 'room.yaml'}:")
            for diagnostic in error.diagnostics
        ]
    return []

"""Scene file → `SceneSpec`, or a `SceneError` with every error and its place in the file.

Which assets, categories and behaviours exist is told by a `SceneKnowledge`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sailenv_ros.scene.documents import MAX_BYTES, load_document
from sailenv_ros.scene.knowledge import SceneKnowledge
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.scene_diagnostics import Diagnostic, diagnose
from sailenv_ros.scene.spec import SceneSpec

__all__ = ["MAX_BYTES", "SceneKnowledge", "load_scene"]


def load_scene(path: Path, *, knowledge: SceneKnowledge | None = None) -> SceneSpec:
    """Read and check a scene file.

    Parameters
    ----------
    path : Path
        A YAML file; its name without the suffix is the scene's name.
    knowledge : SceneKnowledge or None
        What exists. ``None`` leaves names of assets, categories and behaviours unchecked.

    Raises
    ------
    SceneError
        All errors, in the order of the file.
    """

    def find_errors(data: dict[str, Any], error: ValidationError | None) -> Iterator[Diagnostic]:
        yield from _name_diagnostics(data, path.stem)
        yield from diagnose(data, error, knowledge)

    return load_document(path, SceneSpec, "a scene", find_errors=find_errors)


def _name_diagnostics(data: dict[str, Any], stem: str) -> Iterator[Diagnostic]:
    """Refuse a name other than the file's, by which the scene is found."""
    name = data.get("name")
    if isinstance(name, str) and name != stem:
        yield Diagnostic(
            ("name",), f"must be the file's name, {stem!r}, or be left out; got {shown(name)}"
        )

"""Scene file → `SceneSpec`, or a `SceneError` with every error and its place in the file.

Knows YAML text and the models; which assets, categories and behaviours exist is told by a
`SceneKnowledge`.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sailenv_ros.errors import SceneDiagnostic, SceneError
from sailenv_ros.scene.knowledge import SceneKnowledge
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.scene_diagnostics import Diagnostic, diagnose
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.yaml_nodes import Loc, Mark, Node, compose

__all__ = ["MAX_BYTES", "SceneKnowledge", "load_scene"]

MAX_BYTES = 4_000_000
MAX_DIAGNOSTICS = 100
"""So many are told at most."""

MAX_COLLECTED = 1000
"""So many are looked at before they are sorted: a hostile file must not cost minutes."""


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
    shown_path = str(path)
    node, text_diagnostics = compose(_read(path, shown_path))
    diagnostics = [
        _placed(shown_path, diagnostic.mark, "", diagnostic.message)
        for diagnostic in text_diagnostics
    ]
    spec = None
    if node is not None:
        data = node.plain()
        spec, found = _validated(data, path, knowledge)
        diagnostics += [_found(shown_path, node, diagnostic) for diagnostic in found]
    elif not diagnostics:
        diagnostics = [
            _placed(shown_path, Mark(1, 1), "", "is empty; a scene is a mapping (key: value)")
        ]
    if spec is None or diagnostics:
        raise SceneError(_in_order(diagnostics))
    return spec


def _validated(
    data: Any, path: Path, knowledge: SceneKnowledge | None
) -> tuple[SceneSpec | None, list[Diagnostic]]:
    if not isinstance(data, dict):
        top = Diagnostic((), f"must be a mapping (key: value) at its top, got {shown(data)}")
        return None, [top]
    stem = path.stem
    diagnostics = list(_name_diagnostics(data, stem))
    spec, error = None, None
    try:
        spec = SceneSpec.model_validate({"name": stem, **data})
    except ValidationError as problem:
        error = problem
    diagnostics.extend(islice(diagnose(data, error, knowledge), MAX_COLLECTED))
    return spec, diagnostics


def _name_diagnostics(data: dict[str, Any], stem: str) -> Iterator[Diagnostic]:
    """Refuse a name other than the file's, by which the scene is found."""
    name = data.get("name")
    if isinstance(name, str) and name != stem:
        yield Diagnostic(
            ("name",), f"must be the file's name, {stem!r}, or be left out; got {shown(name)}"
        )


def _read(path: Path, shown_path: str) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as problem:
        why = getattr(problem, "strerror", None) or str(problem)
        raise SceneError([_unplaced(shown_path, f"cannot be read: {why}")]) from None
    if len(content) > MAX_BYTES:
        size = f"is larger than the {MAX_BYTES // 1_000_000} MB that a scene may have"
        raise SceneError([_unplaced(shown_path, size)])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        before = content[: problem.start]
        line_start = before.rfind(b"\n") + 1
        column = len(before[line_start:].decode("utf-8-sig", "replace")) + 1
        mark = Mark(before.count(b"\n") + 1, column)
        message = f"is not UTF-8 text: byte 0x{content[problem.start]:02x}"
        raise SceneError([_placed(shown_path, mark, "", message)]) from None


def _found(shown_path: str, node: Node, diagnostic: Diagnostic) -> SceneDiagnostic:
    mark = node.place(diagnostic.loc, of_key=diagnostic.of_key)
    return _placed(shown_path, mark, _field(diagnostic.loc), diagnostic.message)


def _field(loc: Loc) -> str:
    """Write a path as ``objects[2].mass``."""
    text = ""
    for part in loc:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _placed(shown_path: str, mark: Mark, field: str, message: str) -> SceneDiagnostic:
    return SceneDiagnostic(
        path=shown_path, line=mark.line, column=mark.column, field=field, message=message
    )


def _unplaced(shown_path: str, message: str) -> SceneDiagnostic:
    return SceneDiagnostic(path=shown_path, line=0, column=0, field="", message=message)


def _in_order(diagnostics: list[SceneDiagnostic]) -> list[SceneDiagnostic]:
    """Sort by place, without repetitions; a very long list is cut and says so."""
    ordered = sorted(
        dict.fromkeys(diagnostics), key=lambda diagnostic: (diagnostic.line, diagnostic.column)
    )
    if len(ordered) <= MAX_DIAGNOSTICS:
        return ordered
    count = len(ordered) - MAX_DIAGNOSTICS
    rest = f"and {count if len(ordered) < MAX_COLLECTED else 'many'} more errors"
    return [*ordered[:MAX_DIAGNOSTICS], _unplaced(ordered[0].path, rest)]

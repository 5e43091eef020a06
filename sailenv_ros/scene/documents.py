"""YAML file of any kind → validated model, or every error with its place in the file.

What a file may hold is told by a model and a function that finds what is wrong with its plain data:
scenes (`loader`), recipes of data sets and whatever else people write.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from sailenv_ros.errors import SceneDiagnostic, SceneError
from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.scene_diagnostics import Diagnostic, model_diagnostics
from sailenv_ros.scene.yaml_nodes import Loc, Mark, Node, compose

__all__ = ["MAX_BYTES", "MAX_DIAGNOSTICS", "load_document", "text_of_file"]

MAX_BYTES = 4_000_000
MAX_DIAGNOSTICS = 100
"""Greatest number of diagnostics reported."""

MAX_COLLECTED = 1000
"""Greatest number of diagnostics that are collected and sorted: a hostile file must not cost
minutes."""


M = TypeVar("M", bound=SceneModel)

FindErrors = Callable[[dict[str, Any], ValidationError | None], Iterable[Diagnostic]]
"""Finds everything that is wrong with plain data, of which pydantic has found something or not."""


def load_document(
    path: Path,
    model: type[M],
    what: str,
    *,
    find_errors: FindErrors | None = None,
    error: type[SceneError] = SceneError,
) -> M:
    """Read and check a file.

    Parameters
    ----------
    path : Path
        A YAML file.
    model : type of SceneModel
        Of what stands at its top; a field `name` gets the file's name if it is left out.
    what : str
        What such a file is, for people: ``"a scene"``.
    find_errors : callable or None
        None finds what is wrong by the model alone.
    error : type of SceneError
        To be raised.

    Raises
    ------
    SceneError
        All errors, in the order of the file.
    """
    shown_path = str(path)
    try:
        node, text_diagnostics = compose(text_of_file(path, what))
    except SceneError as problem:
        raise error(problem.diagnostics) from None
    diagnostics = [
        _placed(shown_path, diagnostic.mark, "", diagnostic.message)
        for diagnostic in text_diagnostics
    ]
    value = None
    if node is not None:
        find = find_errors or (lambda data, problem: model_diagnostics(model, data, problem))
        value, found = _validated(node.plain(), path, model, what, find)
        diagnostics += [_found(shown_path, node, diagnostic) for diagnostic in found]
    elif not diagnostics:
        empty = f"is empty; {what} is a mapping (key: value)"
        diagnostics = [_placed(shown_path, Mark(1, 1), "", empty)]
    if value is None or diagnostics:
        raise error(_in_order(diagnostics))
    return value


def _validated(
    data: Any, path: Path, model: type[M], what: str, find: FindErrors
) -> tuple[M | None, list[Diagnostic]]:
    if not isinstance(data, dict):
        top = Diagnostic((), f"must be a mapping (key: value) at its top, got {shown(data)}")
        return None, [top]
    value, error = None, None
    named = {"name": path.stem} if "name" in model.model_fields else {}
    try:
        value = model.model_validate({**named, **data})
    except ValidationError as problem:
        error = problem
    return value, list(islice(find(data, error), MAX_COLLECTED))


def text_of_file(path: Path, what: str) -> str:
    """Return the text of a file.

    Raises
    ------
    SceneError
        If it cannot be read, is too large or no UTF-8.
    """
    shown_path = str(path)
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as problem:
        why = getattr(problem, "strerror", None) or str(problem)
        raise SceneError([_unplaced(shown_path, f"cannot be read: {why}")]) from None
    if len(content) > MAX_BYTES:
        size = f"is larger than the {MAX_BYTES // 1_000_000} MB that {what} may have"
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

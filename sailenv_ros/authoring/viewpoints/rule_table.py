"""Table of the camera rules; checks and applies them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

from pydantic import ValidationError

from sailenv_ros.authoring.viewpoints.free_view import free_view
from sailenv_ros.authoring.viewpoints.object_view import object_view
from sailenv_ros.authoring.viewpoints.room_view import room_view
from sailenv_ros.authoring.viewpoints.scene_coverage import coverage
from sailenv_ros.authoring.viewpoints.view_scene import (
    CameraRule,
    CameraView,
    RuleSettings,
    ViewScene,
)
from sailenv_ros.errors import InvalidEntry, UnknownName
from sailenv_ros.space.free_space import named_generator
from sailenv_ros.types.validation import checked_integer

__all__ = ["MOST_VIEWS", "camera_rules", "checked_rule", "rule_errors", "sample_cameras"]

_RULES: Mapping[str, CameraRule] = MappingProxyType(
    {rule.type: rule for rule in (object_view, free_view, coverage, room_view)}
)

MOST_VIEWS = 10_000


def camera_rules() -> Mapping[str, CameraRule]:
    """Return every rule by its name; read-only."""
    return _RULES


def checked_rule(rule: str, settings: Mapping[str, Any]) -> tuple[CameraRule, RuleSettings]:
    """Return a rule with its settings.

    Raises
    ------
    UnknownName
        If there is no such rule.
    InvalidEntry
        If a setting is wrong, with all that are.
    """
    if rule not in _RULES:
        raise UnknownName("camera rule", rule, _RULES)
    kind = _RULES[rule]
    try:
        return kind, kind.settings.model_validate(dict(settings))
    except ValidationError as problem:
        known = ", ".join(kind.settings.model_fields)
        wrong = []
        for error in problem.errors():
            name = ".".join(str(part) for part in error["loc"])
            told = f"{error['msg'][0].lower()}{error['msg'][1:]}, got {error['input']!r}"
            if error["type"] == "extra_forbidden":
                told = f"is not a setting of {rule}; its settings are: {known}"
            wrong.append((name, told))
        raise InvalidEntry(f"camera rule {rule!r}", dict(settings), wrong) from None


def rule_errors(
    rule: str, settings: Mapping[str, Any]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield what is wrong with a rule and its settings: where below both, and a sentence."""
    try:
        checked_rule(rule, settings)
    except UnknownName as problem:
        yield ("rule",), str(problem)
    except InvalidEntry as problem:
        for name, why in problem.diagnostics:
            parts = (int(part) if part.isdigit() else part for part in name.split("."))
            yield ("settings", *parts), why


def sample_cameras(
    scene: ViewScene,
    rule: str,
    count: int = 1,
    *,
    seed: int = 0,
    name: str = "",
    settings: Mapping[str, Any] | None = None,
) -> list[CameraView]:
    """Choose camera poses by a rule.

    Parameters
    ----------
    scene : ViewScene
    rule : str
        One of `camera_rules`.
    count : int
        How many, 1 to 10,000.
    seed : int
    name : str
        What they are for: other names have other random numbers.
    settings : mapping of str to object
        Those of the rule that shall differ from its own.

    Returns
    -------
    views : list of CameraView
        Fewer than `count` if no more were found in as many attempts as the settings allow.

    Raises
    ------
    UnknownName, InvalidEntry, InvalidRequest
        If there is no such rule, or a setting is wrong.
    """
    kind, checked = checked_rule(rule, settings or {})
    wanted = checked_integer("count", count, 1, MOST_VIEWS)
    return kind.choose(scene, checked, wanted, named_generator(seed, rule, name))

"""Names that a scene file may refer to; given to the loader by its caller."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

__all__ = ["Diagnostics", "OpenNames", "SceneKnowledge"]

Diagnostics: TypeAlias = Iterable[tuple[tuple[str | int, ...], str]]
"""Paths inside an entry, each with a sentence that says what is wrong there."""


def _no_camera_errors(rule: str, settings: Mapping[str, Any]) -> Diagnostics:
    return ()


def _no_errors(entry: Mapping[str, Any]) -> Diagnostics:
    return ()


class OpenNames(tuple[str, ...]):
    """Names that are known: those that are listed, and others that follow a form.

    Iterating yields those that are listed.

    Parameters
    ----------
    names : iterable of str
    fault_of : callable
        ``fault_of(name)`` returns why there is nothing of a name that has the form; an empty text
        if there is, and None of a name that does not have it.
    """

    _listed: frozenset[str]
    _fault_of: Callable[[str], str | None]

    def __new__(cls, names: Iterable[str], fault_of: Callable[[str], str | None]) -> OpenNames:
        """Make a tuple of the names that are listed."""
        made = super().__new__(cls, names)
        made._listed, made._fault_of = frozenset(made), fault_of
        return made

    def __contains__(self, name: object) -> bool:
        """Return whether a name is known."""
        return isinstance(name, str) and (name in self._listed or self._fault_of(name) == "")

    def fault(self, name: str) -> str:
        """Return what is wrong with a name that has the form; empty if nothing, or it has not."""
        return self._fault_of(name) or ""


@dataclass(frozen=True, kw_only=True)
class SceneKnowledge:
    """Names of assets, categories, behaviours and materials of rooms.

    Attributes
    ----------
    assets : tuple of str
        Every name that an object's `asset` may have.
    categories : tuple of str
        Names of the fixed table.
    behaviour_errors : callable
        ``behaviour_errors(type, parameters)`` yields what is wrong with a behaviour.
    object_errors : callable
        ``object_errors(entry)`` yields why an object's asset cannot be placed as its entry says.
        The entry is plain data; nothing in it is certain.
    lesson_errors : callable
        ``lesson_errors(scene)`` yields which of its lessons have no end.
    camera_errors : callable
        ``camera_errors(rule, settings)`` yields what is wrong with a camera rule: below ``rule`` or
        ``settings``.
    category_of : callable
        ``category_of(asset)`` returns its category; an empty text if that is not known.
    surfaces : tuple of str
        Every name that the material of a room's walls, floor or ceiling may have.
    skies : tuple of str
        Names of the photographed skies.
    material_fault, picture_fault : callable
        ``material_fault(name)`` returns why there is no such material, if it is none of `surfaces`;
        ``picture_fault(name)`` why a picture cannot be used. Nothing is wrong with an empty text.
    """

    assets: tuple[str, ...]
    categories: tuple[str, ...]
    behaviour_errors: Callable[[str, Mapping[str, Any]], Diagnostics]
    object_errors: Callable[[Mapping[str, Any]], Diagnostics] = _no_errors
    lesson_errors: Callable[[Mapping[str, Any]], Diagnostics] = _no_errors
    camera_errors: Callable[[str, Mapping[str, Any]], Diagnostics] = _no_camera_errors
    category_of: Callable[[str], str] = lambda asset: ""
    surfaces: tuple[str, ...] = ()
    skies: tuple[str, ...] = ()
    material_fault: Callable[[str], str] | None = None
    picture_fault: Callable[[str], str] | None = None

"""Rule files → rules: what kinds of rooms there are and what may stand in them.

Reads ``config/rooms``; errors have file, line and column, all at once, as those of scenes have.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

from pydantic import ValidationError

from sailenv_ros.authoring.room_rules.rule_models import (
    FurnitureFile,
    FurnitureRule,
    KindFile,
    LightFile,
    LightRule,
    MaterialsFile,
    MaterialsRule,
    SplitRule,
    ThingRule,
    ThingsFile,
)
from sailenv_ros.errors import SceneDiagnostic, SceneError, UnknownName
from sailenv_ros.scene.documents import load_document
from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.scene.knowledge import OpenNames
from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.scene_diagnostics import Diagnostic, model_diagnostics
from sailenv_ros.system.resources import resource_path

__all__ = ["ANY_SEED", "Rules", "read_rules", "room_kinds", "rules_of"]

LIBRARY = "library"
SUFFIX = ".yaml"

ANY_SEED = ":*"
"""End of the name of an asset whose seed is drawn for each room: ``chair~dining:*``."""

M = TypeVar("M", bound=SceneModel)

MoreErrors: TypeAlias = Callable[[M], Iterable[Diagnostic]]
"""Finds what else is wrong with a file whose every part is well: names that nothing has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """All that a generator is told.

    Attributes
    ----------
    kinds : mapping of str to KindFile
    furniture : mapping of str to FurnitureRule
    things : mapping of str to tuple of ThingRule
    materials : mapping of str to MaterialsRule
    light : mapping of str to LightRule
    """

    kinds: Mapping[str, KindFile]
    furniture: Mapping[str, FurnitureRule]
    things: Mapping[str, tuple[ThingRule, ...]]
    materials: Mapping[str, MaterialsRule]
    light: Mapping[str, LightRule]

    def kind(self, name: str) -> KindFile:
        """Return a kind of room.

        Raises
        ------
        UnknownName
            If there is none of that name.
        """
        if name not in self.kinds:
            raise UnknownName("kind of room", name, self.kinds)
        return self.kinds[name]


@lru_cache(maxsize=1)
def rules_of() -> Rules:
    """Return the package's own rules, read once; see `read_rules` for errors."""
    return read_rules(resource_path("config", "rooms"))


def room_kinds() -> tuple[str, ...]:
    """Return the names of the kinds of rooms that can be generated."""
    return tuple(sorted(rules_of().kinds))


def read_rules(
    folder: Path,
    *,
    assets: Iterable[str] | None = None,
    categories: Collection[str] | None = None,
    surfaces: Iterable[str] | None = None,
    skies: Iterable[str] | None = None,
) -> Rules:
    """Read and check a folder of rules.

    Parameters
    ----------
    folder : Path
        With a file for each kind of room, and the shared ones in ``library``.
    assets, categories, surfaces, skies : iterable of str or None
        Names that the files may use; None leaves them unchecked.

    Raises
    ------
    SceneError
        All errors of the first file that has some, with their places.
    """
    library = folder / LIBRARY
    things = _load(library / "things.yaml", ThingsFile, _things_errors(assets)).things
    furniture = _load(
        library / "furniture.yaml", FurnitureFile, _furniture_errors(assets, categories, things)
    ).furniture
    materials = _load(
        library / "materials.yaml", MaterialsFile, _materials_errors(surfaces)
    ).materials
    light = _load(library / "light.yaml", LightFile, _light_errors(skies)).light
    files = sorted(folder.glob(f"*{SUFFIX}"))
    if not files:
        why = "has no kinds of rooms: <kind>.yaml"
        diagnostic = SceneDiagnostic(path=str(folder), line=0, column=0, field="", message=why)
        raise SceneError([diagnostic])
    kinds = {file.stem for file in files}
    known: dict[str, Mapping[str, Any]] = {
        "furniture": furniture,
        "materials": materials,
        "light": light,
    }
    return Rules(
        kinds={
            file.stem: _load(file, KindFile, _kind_errors(known, categories, kinds))
            for file in files
        },
        furniture=furniture,
        things=things,
        materials=materials,
        light=light,
    )


def _load(path: Path, model: type[M], more: MoreErrors[M]) -> M:
    def find_errors(data: dict[str, Any], error: ValidationError | None) -> Iterator[Diagnostic]:
        found = list(model_diagnostics(model, data, error))
        yield from found
        if not found and error is None:
            yield from more(model.model_validate(data))

    return load_document(path, model, "a file of rules", find_errors=find_errors)


def _unknown(what: str, loc: tuple[Any, ...], name: str, known: Iterable[str]) -> Diagnostic:
    return Diagnostic(loc, f"there is no {what} {name!r}; {suggestion(name, known)}")


def _container(names: Iterable[str]) -> Collection[str]:
    """Return names to look others up in."""
    return names if isinstance(names, OpenNames) else frozenset(names)


def _asset_errors(
    loc: tuple[Any, ...], names: Sequence[str], known: Collection[str] | None
) -> Iterator[Diagnostic]:
    for place, name in enumerate(names if known is not None else ()):
        # Where one seed makes a piece, all do.
        asked = f"{name.removesuffix(ANY_SEED)}:0" if name.endswith(ANY_SEED) else name
        if known is not None and asked not in known:
            fault = known.fault(asked) if isinstance(known, OpenNames) else ""
            message = f"is no name of a piece: {fault}"
            yield (
                Diagnostic((*loc, place), message)
                if fault
                else _unknown("asset", (*loc, place), name, known)
            )


def _category_errors(
    loc: tuple[Any, ...], name: str | None, known: Collection[str] | None
) -> Iterator[Diagnostic]:
    if known is not None and name is not None and name not in known:
        yield _unknown("category", loc, name, known)


def _things_errors(assets: Iterable[str] | None) -> MoreErrors[ThingsFile]:
    known = None if assets is None else _container(assets)

    def errors(file: ThingsFile) -> Iterator[Diagnostic]:
        for name, things in file.things.items():
            for index, thing in enumerate(things):
                yield from _asset_errors(("things", name, index, "put"), thing.put, known)

    return errors


def _furniture_errors(
    assets: Iterable[str] | None,
    categories: Collection[str] | None,
    things: Mapping[str, tuple[ThingRule, ...]],
) -> MoreErrors[FurnitureFile]:
    known = None if assets is None else _container(assets)

    def errors(file: FurnitureFile) -> Iterator[Diagnostic]:
        for name, rule in file.furniture.items():
            loc = ("furniture", name)
            for key in ("holds", "setting"):
                listed = getattr(rule, key)
                if listed is not None and listed not in things:
                    yield _unknown("list of things", (*loc, key), listed, things)
            for index, companion in enumerate(rule.companions):
                place = (*loc, "companions", index)
                if companion.put not in file.furniture:
                    yield _unknown("piece", (*place, "put"), companion.put, file.furniture)
                yield from _category_errors((*place, "lacking"), companion.lacking, categories)
            yield from _asset_errors((*loc, "assets"), rule.assets, known)
        yield from _rings(file.furniture)

    return errors


def _rings(furniture: Mapping[str, FurnitureRule]) -> Iterator[Diagnostic]:
    """Refuse pieces that belong to themselves: they would have no end."""
    for name in furniture:
        seen, waiting = set(), [name]
        while waiting:
            for companion in furniture[waiting.pop()].companions:
                if companion.put in furniture and companion.put not in seen:
                    seen.add(companion.put)
                    waiting.append(companion.put)
        if name in seen:
            yield Diagnostic(("furniture", name, "companions"), "leads back to the piece itself")


def _materials_errors(surfaces: Iterable[str] | None) -> MoreErrors[MaterialsFile]:
    known = None if surfaces is None else frozenset(surfaces)

    def errors(file: MaterialsFile) -> Iterator[Diagnostic]:
        for name, rule in file.materials.items() if known is not None else ():
            for key in ("walls", "accent", "floor"):
                for index, surface in enumerate(getattr(rule, key)):
                    if known is not None and surface.material not in known:
                        loc = ("materials", name, key, index)
                        yield _unknown("material", loc, surface.material, known)

    return errors


def _light_errors(skies: Iterable[str] | None) -> MoreErrors[LightFile]:
    known = None if skies is None else frozenset(skies)

    def errors(file: LightFile) -> Iterator[Diagnostic]:
        for name, rule in file.light.items() if known is not None else ():
            for index, sky in enumerate(rule.sky_maps):
                if known is not None and sky not in known:
                    yield _unknown("sky", ("light", name, "sky_maps", index), sky, known)

    return errors


def _kind_errors(
    known: Mapping[str, Mapping[str, Any]],
    categories: Collection[str] | None,
    kinds: Iterable[str],
) -> MoreErrors[KindFile]:
    def errors(file: KindFile) -> Iterator[Diagnostic]:
        for index, piece in enumerate(file.furniture):
            if piece.put not in known["furniture"]:
                loc = ("furniture", index, "put")
                yield _unknown("piece", loc, piece.put, known["furniture"])
            yield from _category_errors(("furniture", index, "lacking"), piece.lacking, categories)
            for number, name in enumerate(piece.unless):
                if name not in known["furniture"]:
                    place = ("furniture", index, "unless", number)
                    yield _unknown("piece", place, name, known["furniture"])
        for key in ("hung", "bare"):
            put = getattr(file.windows, key)
            if put is None:
                continue
            if put not in known["furniture"]:
                yield _unknown("piece", ("windows", key), put, known["furniture"])
            elif known["furniture"][put].window is None:
                yield Diagnostic(("windows", key), f"must be a piece with window, got {put!r}")
        for key in ("materials", "light"):
            for index, name in enumerate(getattr(file, key)):
                if name not in known[key]:
                    yield _unknown(f"set of {key}", (key, index), name, known[key])
        for index, layout in enumerate(file.layouts):
            yield from _split_errors(("layouts", index), layout, kinds)

    return errors


def _split_errors(
    loc: tuple[Any, ...], split: SplitRule, kinds: Iterable[str]
) -> Iterator[Diagnostic]:
    """Refuse parts that are neither a room nor divided, or both."""
    divided = split.along is not None and len(split.parts) == 2
    if divided == (split.kind is not None) or bool(split.parts) != divided:
        yield Diagnostic(loc, "must have a kind, or along and two parts, and not both")
    if split.kind is not None:
        if split.kind not in kinds:
            yield _unknown("kind of room", (*loc, "kind"), split.kind, kinds)
        if split.name is None:
            yield Diagnostic(loc, "is a room and must have a name")
    for index, part in enumerate(split.parts):
        yield from _split_errors((*loc, "parts", index), part, kinds)

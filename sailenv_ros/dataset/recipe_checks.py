"""Checks of a recipe against scenes, catalogue and installed packages, before any work.

Plain data in, however wrong, so that all errors are told at once beside those of its own values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from sailenv_ros.dataset.formats.formats import FORMATS, format_class
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.recipe_choices import choices_of, mappings_in
from sailenv_ros.dataset.recipe_scenes import RecipeScenes
from sailenv_ros.dataset.scene_names import SceneNames
from sailenv_ros.errors import MissingPackage
from sailenv_ros.extras import need
from sailenv_ros.scene.messages import shown, suggestion
from sailenv_ros.scene.randomise.random_rules import drawn_names
from sailenv_ros.scene.randomise.randomisation import MOST_ADDED
from sailenv_ros.scene.randomise.selectors import is_meant, selectors_in
from sailenv_ros.scene.randomise.thing_table import RandomThing
from sailenv_ros.scene.scene_diagnostics import Diagnostic, name_diagnostics
from sailenv_ros.simulation.scenes import SceneLibrary

__all__ = ["recipe_errors"]

_THING = TypeAdapter[RandomThing](RandomThing)


def recipe_errors(
    data: Mapping[str, Any], path: Path, scenes: RecipeScenes
) -> Iterator[Diagnostic]:
    """Yield everything that is wrong with a recipe but the values themselves.

    Parameters
    ----------
    data : mapping
        The recipe as plain data, of which nothing is certain.
    path : Path
        Its file.
    scenes : RecipeScenes
        Reads what it names; finds errors in the scenes' own files, too.
    """
    yield from scenes.read(data)
    stock = scenes.library.materials.beside(path)
    known = replace(scenes.library.knowledge, material_fault=stock.fault)
    yield from name_diagnostics(DatasetRecipe, data, known)
    yield from _pictures(data, scenes)
    yield from _packages(data)
    yield from _annotated(data, scenes)
    yield from _drawn_cameras(data)
    yield from _agents(data, scenes)
    yield from _choices(data, scenes)


def _pictures(data: Mapping[str, Any], scenes: RecipeScenes) -> Iterator[Diagnostic]:
    """Yield which pictures do not lie beside a scene's file."""
    for index, entry in mappings_in(data, "randomise"):
        for name in drawn_names(entry.get("picture")):
            for scene, file in scenes.files.items():
                fault = scenes.library.materials.beside(file.path).picture_fault(name)
                if fault:
                    loc = ("randomise", index, "picture")
                    yield Diagnostic(loc, f"cannot be used in the scene {scene}: {fault}")


def _packages(data: Mapping[str, Any]) -> Iterator[Diagnostic]:
    """Yield which packages are not installed that formats need."""
    listed = data.get("formats")
    for index, name in enumerate(listed if isinstance(listed, list | tuple) else ()):
        if isinstance(name, str) and name in FORMATS:
            try:
                for package in format_class(name).packages:
                    need(package, f"the format {name}")
            except MissingPackage as problem:
                yield Diagnostic(("formats", index), str(problem))


def _annotated(data: Mapping[str, Any], scenes: RecipeScenes) -> Iterator[Diagnostic]:
    """Yield which categories of annotations neither this project nor a scene has."""
    chosen = data.get("annotations")
    own = {one.name for file in scenes.files.values() for one in file.spec.categories}
    known = sorted({*scenes.library.knowledge.categories, *own})
    for key in ("categories", "stuff"):
        listed = chosen.get(key) if isinstance(chosen, Mapping) else None
        for index, name in enumerate(listed if isinstance(listed, list | tuple) else ()):
            if isinstance(name, str) and name not in known:
                near = suggestion(name, known, listing="there are")
                yield Diagnostic(
                    ("annotations", key, index), f"there is no category {shown(name)}; {near}"
                )


def _drawn_cameras(data: Mapping[str, Any]) -> Iterator[Diagnostic]:
    """Yield which cameras are drawn that the recipe does not have, or at a time when none is."""
    cameras = [str(entry.get("name", "camera")) for _, entry in mappings_in(data, "cameras")]
    for index, entry in mappings_in(data, "randomise"):
        if entry.get("type") != "camera":
            continue
        if entry.get("every", "epoch") == "epoch":
            yield Diagnostic(
                ("randomise", index, "every"),
                "must be frame for a camera of a recipe, which comes after its scene has begun",
            )
        for one in selectors_in(entry.get("of", "*")):
            if not any(is_meant(one, name) for name in cameras):
                near = suggestion(str(one), cameras, listing="there are")
                told = f"the recipe has no camera {shown(str(one))}; {near}"
                yield Diagnostic(("randomise", index, "of"), told)


def _agents(data: Mapping[str, Any], scenes: RecipeScenes) -> Iterator[Diagnostic]:
    """Yield in which scenes the agent of a camera is missing."""
    for index, entry in mappings_in(data, "cameras"):
        name = entry.get("agent")
        if entry.get("type") != "agent" or not isinstance(name, str):
            continue
        for scene, names in scenes.names(data):
            if name not in names.agents:
                near = suggestion(name, names.agents, listing="there are")
                told = f"the scene {scene} has no agent {shown(name)}; {near}"
                yield Diagnostic(("cameras", index, "agent"), told)


def _choices(data: Mapping[str, Any], scenes: RecipeScenes) -> Iterator[Diagnostic]:
    """Yield which choices of objects meet nothing in any scene.

    Scenes are looked at until everything has met something; what the recipe itself may add to them
    counts as theirs. While a scene cannot be read, nothing is known of what it has.
    """
    waiting = list(choices_of(data))
    aims = [one for one in waiting if one.kind == "camera"]
    for names in _added_names(data, scenes.library) if aims else ():
        aims = [one for one in aims if not one.meets(names)]
        if not aims:
            break
    waiting = [one for one in waiting if one.kind != "camera" or one in aims]
    looked: list[str] = []
    known: dict[str, set[str]] = {}
    for scene, names in scenes.names(data) if waiting and scenes.all_read else ():
        waiting = [one for one in waiting if not one.meets(names)]
        looked.append(scene)
        for kind, of_kind in names.by_kind.items():
            known.setdefault(kind, set()).update(of_kind, of_kind.values())
        if not waiting:
            return
    if not looked:
        return
    several = f"{len(looked)} scenes" if len(looked) > 3 else f"scenes {', '.join(looked)}"
    where = f"the scene {looked[0]}" if len(looked) == 1 else f"any of the {several}"
    for one in waiting:
        sought = str(one.selectors[0]).removeprefix("category ")
        near = suggestion(sought, sorted(known.get(one.kind, set()) - {""}), listing="there are")
        yield Diagnostic(one.loc, f"meets nothing in {where} ({one.label}); {near}")


def _added_names(data: Mapping[str, Any], library: SceneLibrary) -> Iterator[SceneNames]:
    """Yield what cameras may look at that comes to a scene at random, once for each asset."""
    for _, entry in mappings_in(data, "randomise"):
        try:
            thing = _THING.validate_python(entry)
        except ValidationError:
            continue  # told where the values are checked
        names = [f"{thing.name} {number}" for number in range(1, MOST_ADDED + 1)]
        for asset in thing.may_add():
            yield SceneNames({"camera": dict.fromkeys(names, library.knowledge.category_of(asset))})

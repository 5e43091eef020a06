"""Choices of a recipe: where it names objects, parts of rooms or lights, and what of it fits.

A choice that meets nothing in one scene is left out there and told on the card; the check of a
recipe refuses those that meet nothing in any (see `recipe_checks`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sailenv_ros.behaviours import behaviour_kinds
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.scene_names import SceneNames
from sailenv_ros.scene.randomise.selectors import OfCategory, Selector, selectors_in
from sailenv_ros.scene.spec_materials import ALL_PARTS
from sailenv_ros.scene.yaml_nodes import Loc

__all__ = [
    "AGENT_PREFIX",
    "RecipeChoice",
    "choices_of",
    "choices_of_rule",
    "fitting_settings",
    "fitting_things",
]

AGENT_PREFIX = "dataset_"
"""The agent of a recipe's camera has this before its name, so that no agent of a scene has it."""


@dataclass(frozen=True, slots=True)
class RecipeChoice:
    """One selector of a recipe.

    Attributes
    ----------
    loc : tuple of str or int
        Where it stands.
    label : str
        For people: of which entry, and the selector.
    kind : str
        Of `SceneNames.by_kind`.
    selectors : tuple of Selector
        Of which one needs to mean something: a text of an orbit is a name or a category.
    part : str
        Material that the objects need to have; `all` for any.
    """

    loc: Loc
    label: str
    kind: str
    selectors: tuple[Selector, ...]
    part: str = ALL_PARTS

    def meets(self, names: SceneNames) -> bool:
        """Return whether it means anything in a scene."""
        return any(names.meant(self.kind, one, self.part) for one in self.selectors)

    def as_fitting(self, names: SceneNames) -> Iterator[object]:
        """Yield it as a file has it; names where only some of what it means have the material."""
        for one in self.selectors:
            if self.part != ALL_PARTS or self.kind == "jointed":
                yield from names.meant(self.kind, one, self.part)
            else:
                yield {"category": one.category} if isinstance(one, OfCategory) else one


def choices_of(data: Mapping[str, Any]) -> Iterator[RecipeChoice]:
    """Yield the choices of a recipe's plain data, however wrong the rest is."""
    for index, entry in mappings_in(data, "randomise"):
        kind = entry.get("type")
        if kind in ("object", "material", "light", "behaviour"):
            given = entry.get("part")
            part = given if isinstance(given, str) else ALL_PARTS
            for one in selectors_in(entry.get("of")):
                label = f"{entry.get('name')}: {one}"
                if part != ALL_PARTS:
                    label += f", material {part}"
                among = "jointed" if kind == "behaviour" and _needs_joint(entry) else kind
                yield RecipeChoice(("randomise", index, "of"), label, among, (one,), part)
    for index, entry in mappings_in(data, "cameras"):
        name = f"camera {entry.get('name', 'camera')}"
        if entry.get("type") == "orbit":
            for one in selectors_in(entry.get("object")):
                both = (one,) if isinstance(one, OfCategory) else (one, OfCategory(one))
                yield RecipeChoice(("cameras", index, "object"), f"{name}: {one}", "camera", both)
        settings = entry.get("settings")
        if entry.get("type") == "rule" and isinstance(settings, Mapping):
            makes: dict[str, Callable[[str], Selector]] = {"objects": str, "categories": OfCategory}
            for key, make in makes.items():
                listed = settings.get(key)
                for text in listed if isinstance(listed, list | tuple) else ():
                    if isinstance(text, str):
                        loc = ("cameras", index, "settings", key)
                        yield RecipeChoice(loc, f"{name}: {text}", "camera", (make(text),))


def fitting_things(
    recipe: DatasetRecipe, names: SceneNames
) -> tuple[list[Mapping[str, Any]], list[str]]:
    """Return what a recipe draws at random in a scene, without choices that meet nothing there.

    Returns
    -------
    things : list of mapping
        As `randomise` takes them; cameras by the names of their agents.
    missed : list of str
        Labels of the choices that were left out.
    """
    things: list[Mapping[str, Any]] = []
    plain = [one.model_dump(mode="json", exclude_defaults=True) for one in recipe.randomise]
    choices = list(choices_of({"randomise": plain}))
    for index, entry in enumerate(plain):
        own = [one for one in choices if one.loc[1] == index]
        met = [plain for one in own if one.meets(names) for plain in one.as_fitting(names)]
        if own and not met:
            continue
        if own:
            entry = {**entry, "of": met}
        elif entry["type"] == "camera":
            given = entry.get("of", "*")
            listed = [given] if isinstance(given, str) else given
            entry = {**entry, "of": [f"{AGENT_PREFIX}{one}" for one in listed]}
        things.append(entry)
    return things, [one.label for one in choices if not one.meets(names)]


def choices_of_rule(settings: Mapping[str, Any]) -> list[RecipeChoice]:
    """Return the choices among the settings of a camera rule: what it shall look at."""
    return list(choices_of({"cameras": [{"type": "rule", "settings": settings}]}))


def fitting_settings(settings: Mapping[str, Any], names: SceneNames) -> Mapping[str, Any] | None:
    """Return the settings of a camera rule without targets that a scene lacks.

    None if it has targets and the scene has none of them.
    """
    choices = choices_of_rule(settings)
    if not choices:
        return settings
    met = [one for one in choices if one.meets(names)]
    kept: dict[str, list[str]] = {
        one.loc[-1]: [] for one in choices if isinstance(one.loc[-1], str)
    }
    for one in met:
        (selector,) = one.selectors
        kept[str(one.loc[-1])].append(getattr(selector, "category", str(selector)))
    return {**settings, **kept} if met else None


def _needs_joint(entry: Mapping[str, Any]) -> bool:
    """Return whether a behaviour moves joints alone, as that of doors does."""
    kinds = (
        behaviour_kinds().get(str(one.get("type"))) for _, one in mappings_in(entry, "behaviours")
    )
    return any(kind.parameters.model_construct().needs_joint for kind in kinds if kind is not None)


def mappings_in(data: Mapping[str, Any], key: str) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the mappings of a list of some data, with their places in it."""
    listed = data.get(key)
    for index, entry in enumerate(listed if isinstance(listed, list | tuple) else ()):
        if isinstance(entry, Mapping):
            yield index, entry

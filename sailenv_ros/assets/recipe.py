"""`config/standard_pack.yaml` → `Recipe`: what the standard pack holds and how it is put right."""

from __future__ import annotations

import fnmatch
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sailenv_ros.assets.finishes import FINISHES
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml

__all__ = [
    "MaterialRule",
    "Recipe",
    "RecipeEntry",
    "RecipePart",
    "recipe_files",
    "standard_recipe",
]

Colour = Annotated[str, Field(pattern=r"^#[0-9a-f]{6}$")]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Amount = Annotated[float, Field(ge=0.0, le=100.0)]
Power = tuple[Amount, Amount, Amount]


class _RecipeModel(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


RECIPE_FILES = ("standard_pack.yaml", "standard_pack_rooms.yaml")


class MaterialRule(_RecipeModel):
    """Rule of the recipe for the materials whose name matches a pattern.

    Attributes
    ----------
    emission : (3,) tuple of float or None
        Linear radiance that it emits: fire, screens [W/(m² sr)].
    glow : (3,) tuple of float or None
        Linear radiance for each W/sr of the lamp's light: shades and bulbs [1/m²].
    shows : {'desktop', 'landscape'} or None
        A picture across the whole of it, seen from the front: that of a screen.
    """

    finish: str | None = None
    colour: Colour | None = None
    roughness: Share | None = None
    metallic: Share | None = None
    pattern: str | None = None
    emission: Power | None = None
    glow: Power | None = None
    shows: Literal["desktop", "landscape"] | None = None
    drop: bool = False


class RecipePart(_RecipeModel):
    """Labelled part of an object.

    Attributes
    ----------
    category : str
    materials : tuple of str
        Names of materials, with wildcards, whose meshes are the part's.
    each : {'material', 'mesh', 'piece', 'book'}
        ``material``: all of them are one part. ``mesh`` and ``piece``: each mesh, or each connected
        piece, is one, with a number after its name. ``book``: each book of rows that stand along y.
    above : float or None
        Only connected pieces that are higher than this over the base [m].
    """

    category: str
    materials: Annotated[tuple[str, ...], Field(min_length=1)]
    each: Literal["material", "mesh", "piece", "book"] = "material"
    above: float | None = None


class RecipeEntry(_RecipeModel):
    """One object.

    Attributes
    ----------
    source : str
        ``library/model`` of the catalogues, or ``made/<what>`` for what code makes.
    collision : str
        ``box``, ``cylinder``, ``sphere``; ``pieces`` for a hull around each connected piece,
        ``hull`` around all, ``convex`` for a decomposition of what is hollow or branched, ``base``
        for a hull around the lowest fifth (plants, whose leaves give way), ``none``.
    adds : tuple of str
        What code makes for it, in its own axes: the books of a bookcase.
    turn : float
        About the vertical, where a catalogue's front is not the object's [deg].
    triangles : int or None
        At most about so many are drawn; None for what its size asks for.
    parts : mapping of str to RecipePart
        What of it is labelled apart; the first that names a material takes its meshes.
    """

    category: str
    source: str
    display_name: str | None = None
    mass: Annotated[float, Field(gt=0.0, le=2000.0)]
    collision: Literal["box", "cylinder", "sphere", "hull", "pieces", "convex", "base", "none"] = (
        "pieces"
    )
    adds: tuple[str, ...] = ()
    turn: float = 0.0
    tags: tuple[str, ...] = ()
    triangles: Annotated[int, Field(ge=100, lt=20000)] | None = None
    materials: dict[str, MaterialRule | str] = {}
    parts: dict[str, RecipePart] = {}

    def rule(self, material: str) -> MaterialRule:
        """Return what is said of a material; an empty rule for nothing."""
        for pattern, rule in self.materials.items():
            if fnmatch.fnmatchcase(material, pattern):
                return MaterialRule(finish=rule) if isinstance(rule, str) else rule
        return MaterialRule()


class Recipe(_RecipeModel):
    """The whole pack."""

    version: Literal[1]
    title: str
    assets: dict[str, RecipeEntry]

    def display_name(self, name: str) -> str:
        """Return an object's display name: ``Chair 01`` for ``chair_01`` unless it has another."""
        return self.assets[name].display_name or name.replace("_", " ").title()


@lru_cache(maxsize=1)
def standard_recipe() -> Recipe:
    """Read the package's own recipe, all of its files, once.

    Raises
    ------
    AssetError
        If it cannot be read or breaks the rules above.
    """
    recipes = [read_recipe(path) for path in recipe_files()]
    assets: dict[str, RecipeEntry] = {}
    for recipe in recipes:
        for name in assets.keys() & recipe.assets.keys():
            raise AssetError(name, "two files of the recipe have it")
        assets |= recipe.assets
    return recipes[0].model_copy(update={"assets": assets})


def recipe_files() -> tuple[Path, ...]:
    """Return the files of the package's own recipe."""
    return tuple(resource_path("config", name) for name in RECIPE_FILES)


def read_recipe(path: Path) -> Recipe:
    """Read a recipe; see `standard_recipe`."""
    try:
        recipe = Recipe.model_validate(from_yaml(path.read_text(encoding="utf-8")))
        for entry in recipe.assets.values():
            for pattern in entry.materials:
                finish = entry.rule(pattern).finish
                if finish is not None and finish not in FINISHES:
                    raise UnknownName("finish", finish, FINISHES)
        return recipe
    except (OSError, yaml.YAMLError, ValidationError, UnknownName) as problem:
        raise AssetError(path.name, " ".join(str(problem).split())) from None

"""The animals that there are: `config/animals.yaml` → `AnimalLook`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["OWN_LICENCE", "AnimalLook", "Coat", "animals"]

OWN_LICENCE = "Apache-2.0"
"""Of what is made: that of the code and of the numbers, as no data of others is in it."""

Colour = Annotated[str, Field(pattern=r"^#[0-9a-f]{6}$")]
Factor = Annotated[float, Field(ge=0.4, le=2.5)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]


class _Look(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Coat(_Look):
    """Fur: a pattern in two colours, a lighter underside, and what is white.

    Attributes
    ----------
    pattern : {'plain', 'tabby', 'patches', 'saddle'}
    base, second, under : str
    under_share : float
        How much of the base the lighter colour takes on belly, chest and muzzle, 0 to 1.
    white : float
        How far up from paws, chest and muzzle white reaches, 0 to 1.
    seed : int
    """

    pattern: Literal["plain", "tabby", "patches", "saddle"]
    base: Colour
    second: Colour
    under: Colour = "#e8dfd0"
    under_share: Share = 0.5
    white: Share = 0.0
    seed: int = 0


class AnimalLook(_Look):
    """One animal; factors are over the measures of its kind.

    Attributes
    ----------
    height : float
        Of the withers [m].
    """

    title: str
    kind: Literal["cat", "dog"]
    height: Annotated[float, Field(ge=0.12, le=0.8)]
    mass: Annotated[float, Field(ge=1.0, le=80.0)]
    length: Factor = 1.0
    girth: Factor = 1.0
    legs: Factor = 1.0
    neck: Factor = 1.0
    head: Factor = 1.0
    muzzle: Factor = 1.0
    ears: Literal["pricked", "hanging"]
    ear_size: Factor = 1.0
    tail: Factor = 1.0
    tail_width: Factor = 1.0
    tail_up: Annotated[float, Field(ge=-60.0, le=120.0)] = 60.0
    tail_curl: Annotated[float, Field(ge=-90.0, le=260.0)] = 0.0
    coat: Coat
    eyes: Colour
    nose: Colour
    inner_ear: Colour = "#d8a89a"


@lru_cache(maxsize=1)
def animals() -> Mapping[str, AnimalLook]:
    """Return the animals by their names, ``cat_01`` and so on."""
    read = from_yaml(resource_path("config", "animals.yaml").read_text())
    found = {name: AnimalLook.model_validate(entry) for name, entry in read["animals"].items()}
    return MappingProxyType(found)

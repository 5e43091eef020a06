"""The people that there are: `config/people.yaml` → `PersonLook`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from sailenv_content.people.figures import Build
from sailenv_content.people.garments import GARMENTS
from sailenv_content.people.growth import stature_m
from sailenv_content.people.hair import HAIRSTYLES
from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.yaml_text import from_yaml

__all__ = ["PersonLook", "Wear", "people"]

Colour = Annotated[str, Field(pattern=r"^#[0-9a-f]{6}$")]
Share = Annotated[float, Field(ge=0.0, le=1.0)]


class _Look(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Wear(_Look):
    """A garment: its kind, its colour, and what is printed on it in a second one."""

    garment: Literal[tuple(GARMENTS)]  # type: ignore[valid-type]  # the kinds that there are
    colour: Colour
    print: Literal["", "stripes", "checks", "dots"] = ""
    second: Colour = "#f2efe6"


class PersonLook(_Look):
    """How a person looks; `wears` goes from the skin outwards."""

    title: str
    female: Share
    age: Annotated[float, Field(ge=1.0, le=95.0)]
    muscle: Share = 0.5
    weight: Share = 0.5
    height: Share = 0.5
    shapes: tuple[Share, Share, Share] = (1.0, 1.0, 1.0)
    skin: Colour
    lips: Colour
    eyes: Colour = "#4a2f1b"
    hair: Literal[tuple(HAIRSTYLES)]  # type: ignore[valid-type]  # the styles that there are
    hair_colour: Colour
    curls: Share = 0.2
    brows: Share = 0.8
    stubble: Share = 0.0
    seed: int = 0
    wears: tuple[Wear, ...]

    @property
    def build(self) -> Build:
        """The body below."""
        african, asian, caucasian = self.shapes
        return Build(
            female=self.female,
            age_years=self.age,
            stature_m=stature_m(self.age, self.female, self.height),
            muscle=self.muscle,
            weight=self.weight,
            african=african,
            asian=asian,
            caucasian=caucasian,
        )


@lru_cache(maxsize=1)
def people() -> Mapping[str, PersonLook]:
    """Return the people by their names, ``person_01`` and so on."""
    read = from_yaml(resource_path("config", "people.yaml").read_text())
    found = {name: PersonLook.model_validate(entry) for name, entry in read["people"].items()}
    return MappingProxyType(found)

"""Materials of a scene file: what a surface is made of, by name or picture, and its finish."""

from __future__ import annotations

from typing import Annotated, ClassVar, Final, TypeAlias

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Text, Vector, optional
from sailenv_ros.scene.fields import Fraction, LinearColour, Radiance, Rule, SceneModel
from sailenv_ros.scene.rules import at_most_one

__all__ = ["ALL_PARTS", "MAPPINGS", "LookSpec", "MaterialName", "MaterialSpec", "PictureName"]

ALL_PARTS: Final = "all"
"""Stands for every material of an object."""

MAPPINGS: Final = ("box", "own")

MaterialName: TypeAlias = Annotated[
    str, Text(r"[^\x00-\x1f]{1,200}", "the name of a material, or asset/material of a model's")
]
PictureName: TypeAlias = Annotated[
    str,
    Text(
        r"[A-Za-z0-9_][A-Za-z0-9 _.-]{0,120}\.(?:png|PNG|jpg|JPG|jpeg|JPEG)",
        "the name of a PNG or JPEG file without folders",
    ),
]
_Seed: TypeAlias = Annotated[int, Number(least=0, most=2**31 - 1, whole=True)]
_Side: TypeAlias = Annotated[float, Number(least=0.01, most=100.0, unit="m")]


class LookSpec(SceneModel):
    """Appearance of a surface, as far as it differs from its own material."""

    rules: ClassVar[tuple[Rule, ...]] = (at_most_one("material", "picture"),)

    material: MaterialName | None = optional(
        "a material of rooms such as oak_planks, or that of a model, as asset/material"
    )
    picture: PictureName | None = optional(
        "PNG or JPEG file beside the scene file or in `pictures` there; at most 8 "
        "MB and 16 million pixels"
    )
    colour: LinearColour | None = optional(
        "replaces the material's colour; a picture is multiplied by it"
    )
    tint: LinearColour | None = optional("the colour and its pattern are multiplied by it")
    roughness: Fraction | None = optional("0: a mirror; 1: chalk")
    metallic: Fraction | None = optional("0: paint, plastic, wood; 1: bare metal")
    emission: Radiance | None = optional(
        "light that it emits: radiance [W/(m2 sr)], in the pattern of its colour; 0: none"
    )
    tile: (
        Annotated[
            tuple[_Side, _Side],
            Vector(2, "one length, or two [width, height], in [m]", one_for_all=True),
        ]
        | None
    ) = optional(
        "width and height of one picture or pattern [m]; default: the material's "
        "own, 1 m for a picture"
    )
    turn: Annotated[float, Number(least=-360.0, most=360.0, unit="deg")] = Field(
        default=0.0, description="by which it is laid counter-clockwise, e.g. 90 for boards along y"
    )
    seed: _Seed = Field(default=0, description="others give other grain, clouds and tones")


class MaterialSpec(LookSpec):
    """Material that replaces an object's own, or one of its own."""

    part: Annotated[str, Text(r"[^\x00-\x1f]{1,200}", "the name of one of its materials")] = Field(
        default=ALL_PARTS,
        description="name of one of the object's materials, as in `info.instances`; `all`: "
        "every one",
    )
    mapping: Annotated[str, Choice(MAPPINGS)] = Field(
        default="box",
        description="`box`: projected at real size from six sides; `own`: by the model's "
        "texture coordinates",
    )

"""Models of rule files: kinds of rooms, furniture, small objects, materials, light.

Models of the files in ``config/rooms``; see `rule_files` for how they are read. Lengths are metres,
angles degrees. A span is two numbers, least and most, or one number for both.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, TypeAlias, get_args

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch, Text, Vector, optional
from sailenv_ros.scene.fields import Fraction, Heights, LinearColour, Radiance, Rule, SceneModel
from sailenv_ros.scene.rules import spans_ascend
from sailenv_ros.scene.spec_outside import OUTSIDE_KINDS
from sailenv_ros.scene.spec_room import SurfaceSpec

__all__ = [
    "CompanionRule",
    "FurnitureFile",
    "FurnitureRule",
    "KindFile",
    "LightFile",
    "LightRule",
    "MaterialsFile",
    "MaterialsRule",
    "OpeningRule",
    "PieceRule",
    "ShapeRule",
    "SplitRule",
    "ThingRule",
    "ThingsFile",
    "WindowRule",
]

_Length = Annotated[float, Number(least=-50.0, most=50.0, unit="m")]
_Degrees = Annotated[float, Number(least=-360.0, most=360.0, unit="deg")]
_Whole = Annotated[int, Number(least=0, most=64, whole=True)]
_Factor = Annotated[float, Number(least=0.01, most=100.0)]
_Share = Annotated[float, Number(least=-1.0, most=1.0)]
_Strength = Annotated[float, Number(least=0.0, most=1000.0)]
_Name = Annotated[str, Text(r"[a-z][a-z0-9_ ]{0,40}", "a lower-case name")]

_LACKING = "category: not if something of the room is of it, or has such a part"
_PAIR = "one number, or two [least, most]"
Metres: TypeAlias = Annotated[tuple[_Length, _Length], Vector(2, _PAIR, one_for_all=True)]
Turn: TypeAlias = Annotated[tuple[_Degrees, _Degrees], Vector(2, _PAIR, one_for_all=True)]
Count: TypeAlias = Annotated[tuple[_Whole, _Whole], Vector(2, _PAIR, one_for_all=True)]
Factor: TypeAlias = Annotated[tuple[_Factor, _Factor], Vector(2, _PAIR, one_for_all=True)]
Shares: TypeAlias = Annotated[tuple[_Share, _Share], Vector(2, _PAIR, one_for_all=True)]
Strength: TypeAlias = Annotated[tuple[_Strength, _Strength], Vector(2, _PAIR, one_for_all=True)]

Place = Literal["wall", "corner", "middle", "free", "ceiling"]
Side = Literal["front", "back", "left", "right", "beside", "around", "under", "over", "corner"]


class _RuleModel(SceneModel):
    """Base of all entries of a rule file."""

    rules: ClassVar[tuple[Rule, ...]] = (spans_ascend,)


class ClearRule(_RuleModel):
    """Floor that stays free at the sides of a piece of furniture."""

    front: _Length = Field(default=0.0, description="before it [m]")
    left: _Length = Field(default=0.0, description="at its left, as it faces [m]")
    right: _Length = Field(default=0.0, description="at its right, as it faces [m]")


class CompanionRule(_RuleModel):
    """A companion of a piece of furniture, and its place beside it."""

    put: _Name = Field(description="name of a piece in furniture.yaml")
    where: Annotated[Side, Choice(get_args(Side))] = Field(description="side of the other piece")
    count: Count = Field(default=(1, 1), description="how many, where there may be several")
    chance: Fraction = Field(default=1.0, description="that there are any")
    needed: Annotated[bool, Switch()] = Field(
        default=False, description="true: the other piece is not placed without"
    )
    gap: Metres = Field(default=(0.02, 0.06), description="between the two [m]")
    aside: Metres = Field(default=(0.0, 0.0), description="off the middle, to its left [m]")
    turn: Turn = Field(default=(0.0, 0.0), description="besides facing the other piece [deg]")
    ahead: _Length = Field(default=0.0, description="for `under`: off the middle, to its front [m]")
    lacking: _Name | None = optional(_LACKING)
    in_view: Annotated[bool, Switch()] = Field(
        default=False, description="true: what is between them is part of the two, or nothing"
    )


class BeforeWindowRule(_RuleModel):
    """The size of what hangs before a window: it is scaled to it."""

    aside: _Length = Field(default=0.06, description="beyond the window, on each side [m]")
    above: _Length = Field(default=0.08, description="beyond the window, upwards [m]")
    floor: Annotated[bool, Switch()] = Field(
        default=False, description="true: down to the floor, and drawn aside; false: to the sill"
    )


class FurnitureRule(_RuleModel):
    """A piece of furniture by its function."""

    assets: tuple[str, ...] = Field(
        min_length=1, description="names of the catalogue; `chair~dining:*` is of any seed"
    )
    alike: Fraction = Field(
        default=0.0, description="that another one in the room is the same, if a seed made it"
    )
    at: Annotated[Place, Choice(get_args(Place))] = Field(
        default="wall", description="where it stands or hangs"
    )
    gap: Metres = Field(default=(0.0, 0.0), description="between its back and the wall [m]")
    height: Metres | None = optional("of the foot of what hangs, above the floor [m]")
    eye_level: Metres | None = optional(
        "of the middle of what hangs, above the floor; it keeps off its neighbours [m]"
    )
    scale: Factor = Field(default=(1.0, 1.0), description="of its size")
    turn: Turn = Field(default=(0.0, 0.0), description="besides facing into the room [deg]")
    static: Annotated[bool, Switch()] = Field(default=True, description="false for what can fall")
    window: BeforeWindowRule | None = optional("of what hangs before a window: how large")
    flat: Annotated[bool, Switch()] = Field(
        default=False, description="true for rugs: others may stand on it"
    )
    at_window: Annotated[bool, Switch()] = Field(
        default=False, description="true: below a window if there is one"
    )
    clear: ClearRule = Field(default_factory=ClearRule, description="floor that stays free")
    companions: tuple[CompanionRule, ...] = Field(default=(), description="what belongs to it")
    holds: _Name | None = optional("name of a list in things.yaml")
    setting: _Name | None = optional("list in things.yaml that is laid before each chair around it")
    light: Strength | None = optional("radiant intensity of a lamp that is on [W/sr]")
    shines: Annotated[Literal["up", "down"], Choice(("up", "down"))] = Field(
        default="up", description="whether the lamp's light is above or below what glows of it"
    )

    @property
    def hangs(self) -> bool:
        """Whether a wall carries it."""
        return self.height is not None or self.eye_level is not None


class ThingRule(_RuleModel):
    """An object that lies or stands on a piece of furniture."""

    put: tuple[str, ...] = Field(
        min_length=1, description="names of the catalogue, one is taken; `cup~mug:*` is of any seed"
    )
    count: Count = Field(default=(1, 1), description="how many")
    chance: Fraction = Field(default=1.0, description="that there are any")
    x: Shares = Field(default=(-1.0, 1.0), description="from the back, -1, to the front, 1")
    y: Shares = Field(default=(-1.0, 1.0), description="from its right, -1, to its left, 1")
    turn: Turn = Field(default=(-180.0, 180.0), description="against the piece [deg]")
    scale: Factor = Field(default=(1.0, 1.0), description="of its size")
    static: Annotated[bool, Switch()] = Field(default=False, description="true: never moves")
    level: Heights | None = optional(
        "of the upper side that it lies on, above the piece's base: a worktop below cupboards [m]"
    )
    hob: Annotated[bool, Switch()] = Field(
        default=False, description="true: x and y are those of the piece's hob, if it has one"
    )
    inset: _Length = Field(default=0.0, description="in a setting: from the table's edge [m]")
    aside: _Length = Field(default=0.0, description="in a setting: to the right of the guest [m]")
    light: Strength | None = optional("of a lamp that is on [W/sr]")


class FurnitureFile(_RuleModel):
    """``furniture.yaml``: pieces by function."""

    version: Literal[1] = Field(description="of this format; 1")
    furniture: dict[str, FurnitureRule] = Field(description="by name")


class ThingsFile(_RuleModel):
    """``things.yaml``: lists of what lies on what."""

    version: Literal[1] = Field(description="of this format; 1")
    things: dict[str, tuple[ThingRule, ...]] = Field(description="by name")


class MaterialsRule(_RuleModel):
    """Materials that match."""

    walls: tuple[SurfaceSpec, ...] = Field(min_length=1, description="one is taken")
    accent: tuple[SurfaceSpec, ...] = Field(default=(), description="of one wall that differs")
    accent_chance: Fraction = Field(default=0.5, description="that one wall differs")
    floor: tuple[SurfaceSpec, ...] = Field(min_length=1, description="one is taken")
    curtains: tuple[LinearColour, ...] = Field(default=(), description="colours of the cloth")
    skirting: LinearColour | None = optional("its paint; none: no skirting")


class MaterialsFile(_RuleModel):
    """``materials.yaml``: sets of materials."""

    version: Literal[1] = Field(description="of this format; 1")
    materials: dict[str, MaterialsRule] = Field(description="by name")


class SunRule(_RuleModel):
    """The sun through a window."""

    colour: Radiance = Field(description="of its light")
    intensity: Strength = Field(description="irradiance [W/m2]")
    elevation: Turn = Field(description="above the horizon [deg]")
    aside: Turn = Field(default=(-50.0, 50.0), description="against the window's axis [deg]")


class LightRule(_RuleModel):
    """Sky, sun and lamps at a time of the day."""

    sky_maps: tuple[str, ...] = Field(default=(), description="photographed skies, one is taken")
    ambient: Radiance = Field(description="where no light is baked")
    sky_share: Fraction = Field(default=0.14, description="where no light is baked")
    sky_zenith: Radiance = Field(description="where there is no photographed sky")
    sky_horizon: Radiance = Field(description="where there is no photographed sky")
    sky_ground: Radiance = Field(description="where there is no photographed sky")
    exposure: Annotated[tuple[float, float], Vector(2, _PAIR, one_for_all=True)] = Field(
        description="[stops]"
    )
    sun: SunRule | None = optional("none on a cloudy day and at night")
    window: Strength = Field(description="radiance of the sky's light in the windows [W/(m2 sr)]")
    window_colour: Radiance = Field(description="of the sky's light")
    ceiling: Strength = Field(description="radiant intensity of ceiling lamps [W/sr]")
    lamps: Annotated[bool, Switch()] = Field(default=False, description="true: lamps are on")
    lamp_colour: Radiance = Field(description="of all lamps")


class LightFile(_RuleModel):
    """``light.yaml``: times of the day."""

    version: Literal[1] = Field(description="of this format; 1")
    light: dict[str, LightRule] = Field(description="by name")


class ShapeRule(_RuleModel):
    """Size and shape of a room."""

    width: Metres = Field(description="along x [m]")
    depth: Metres = Field(description="along y [m]")
    height: Metres = Field(description="[m]")
    l_chance: Fraction = Field(default=0.0, description="that a corner is cut out")
    l_share: Shares = Field(default=(0.3, 0.42), description="of each side that is cut out")


class WindowRule(_RuleModel):
    """Windows."""

    count: Count = Field(default=(1, 2), description="how many")
    width: Metres = Field(default=(1.0, 1.8), description="[m]")
    height: Metres = Field(default=(1.2, 1.45), description="[m]")
    sill: Metres = Field(default=(0.85, 0.95), description="height of the lower edge [m]")
    curtains: Fraction = Field(default=0.5, description="share of rooms that have some")
    hung: _Name | None = optional("piece that is hung as curtains; none: plain ones")
    bare: _Name | None = optional("piece that may hang before windows without curtains")
    blinds: Fraction = Field(default=0.0, description="share of those rooms in which it does")


class OpeningRule(_RuleModel):
    """Doors."""

    count: Count = Field(default=(1, 1), description="how many")
    open_chance: Fraction = Field(default=0.0, description="that the leaf stands open")


class PieceRule(_RuleModel):
    """A piece of furniture that a kind of room has."""

    put: _Name = Field(description="name of a piece in furniture.yaml")
    count: Count = Field(default=(1, 1), description="how many")
    chance: Fraction = Field(default=1.0, description="that there are any")
    needed: Annotated[bool, Switch()] = Field(
        default=False, description="true: a room without it is thrown away"
    )
    once: Annotated[bool, Switch()] = Field(
        default=False, description="true: not if the room has one already"
    )
    unless: tuple[_Name, ...] = Field(
        default=(), description="pieces of the room that stand for it: then it has none"
    )
    lacking: _Name | None = optional(_LACKING)
    per_metre: Fraction = Field(
        default=0.0, description="more of them: so many per square metre of the floor"
    )


class SplitRule(_RuleModel):
    """A part of an apartment: a room of some kind, or a part that a wall divides."""

    name: _Name | None = optional("of the room")
    kind: _Name | None = optional("kind of the room")
    hub: Annotated[bool, Switch()] = Field(
        default=False, description="true: the other rooms have doorways to it"
    )
    along: Annotated[Literal["x", "y"], Choice(("x", "y"))] | None = optional(
        "axis along which the parts follow each other"
    )
    at: Shares = Field(default=(0.5, 0.5), description="share of the first part")
    parts: tuple[SplitRule, ...] = Field(default=(), description="the two parts", max_length=2)


class KindFile(_RuleModel):
    """``<kind>.yaml``: a kind of room."""

    version: Literal[1] = Field(description="of this format; 1")
    title: str = Field(max_length=100, description="what people call it")
    description: str = Field(default="", max_length=1000, description="what it is")
    shape: ShapeRule = Field(description="its size")
    windows: WindowRule = Field(default_factory=WindowRule, description="its windows")
    doors: OpeningRule = Field(default_factory=OpeningRule, description="its doors")
    outside: tuple[Annotated[str, Choice(OUTSIDE_KINDS)], ...] = Field(
        default=OUTSIDE_KINDS[1:], min_length=1, description="what lies outside: one is taken"
    )
    materials: tuple[_Name, ...] = Field(min_length=1, description="names of materials.yaml")
    light: tuple[_Name, ...] = Field(min_length=1, description="names of light.yaml")
    furniture: tuple[PieceRule, ...] = Field(default=(), description="in this order")
    layouts: tuple[SplitRule, ...] = Field(default=(), description="of an apartment: one is taken")
    speed: Annotated[float, Number(above=0.0, most=10.0, unit="m/s")] = Field(
        default=0.45, description="of the camera on its way [m/s]"
    )


SplitRule.model_rebuild()

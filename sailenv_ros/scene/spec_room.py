"""The room of a scene file: its size, surfaces, windows and doors.

A room is centred on the world's origin with its floor at z = 0; x runs to the east, y to the
north. What its surfaces are called is known elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import (
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    SerializerFunctionWrapHandler,
)
from pydantic_core import core_schema

from sailenv_ros.scene.field_types import Choice, Number, Switch, Vector, optional
from sailenv_ros.scene.fields import LinearColour, Name, NamedModel, Rule, SceneModel
from sailenv_ros.scene.partition_rules import (
    along_an_axis,
    corners_apart,
    distinct_parts,
    doorways_inside,
    floors_apart,
    inside_room,
)
from sailenv_ros.scene.room_rules import (
    DOOR_SIZE_M,
    WALLS,
    WINDOW_SIZE_M,
    inside_walls,
    without_overlaps,
)
from sailenv_ros.scene.rules import only_beside
from sailenv_ros.scene.spec_materials import LookSpec, MaterialName
from sailenv_ros.scene.spec_outside import OutsideSpec

__all__ = [
    "CurtainSpec",
    "DoorSpec",
    "DoorwaySpec",
    "FloorAreaSpec",
    "OpeningSpec",
    "PartitionSpec",
    "RoomSpec",
    "SkirtingSpec",
    "SurfaceSpec",
    "WallMaterialsSpec",
    "WallName",
    "WindowSpec",
]

WallName: TypeAlias = Literal["north", "east", "south", "west"]

_Extent: TypeAlias = Annotated[float, Number(least=1.0, most=100.0, unit="m")]
_Opening: TypeAlias = Annotated[float, Number(least=0.3, most=100.0, unit="m")]
_Along: TypeAlias = Annotated[float, Number(least=-50.0, most=50.0, unit="m")]
_Wall: TypeAlias = Annotated[WallName, Choice(WALLS)]
_Corner: TypeAlias = Annotated[tuple[_Along, _Along], Vector(2, "two numbers [x, y] in [m]")]


@dataclass(frozen=True, slots=True)
class _OrNone:
    """Lets ``false`` leave something out, and ``true`` take it with its defaults."""

    def check(self, value: object) -> object:
        """Turn the words for nothing and for the defaults into what the model takes."""
        if value is True:
            return {}
        return None if value is False else value

    def written(self, value: object, handler: SerializerFunctionWrapHandler) -> object:
        """Return the word for nothing or for the defaults, else the keys that are given."""
        return False if value is None else handler(value) or True

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        writing = core_schema.wrap_serializer_function_ser_schema(self.written, when_used="json")
        return core_schema.no_info_before_validator_function(
            self.check, handler(source), serialization=writing
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [{"type": "boolean"}, handler(schema)]}


class SurfaceSpec(NamedModel, LookSpec):
    """Material of a wall, floor or ceiling; a name alone stands for its material."""

    key = "material"

    material: MaterialName = Field(
        default="plaster", description="e.g. plaster, oak_planks, white_tiles, wallpaper_damask"
    )

    def keys(self) -> dict[str, Any]:
        """Return what differs from the defaults, and the material, as a file would have it."""
        dumped: Any = self.model_dump(mode="json", exclude_defaults=True)
        given = {"material": dumped} if isinstance(dumped, str) else dict(dumped)
        # A picture takes the place of the material that is there of itself.
        return given if self.picture is not None else {"material": self.material, **given}


class WallMaterialsSpec(SceneModel):
    """Walls that differ from the others."""

    north: SurfaceSpec | None = optional("the wall towards +y")
    east: SurfaceSpec | None = optional("the wall towards +x")
    south: SurfaceSpec | None = optional("the wall towards -y")
    west: SurfaceSpec | None = optional("the wall towards -x")


class SkirtingSpec(SceneModel):
    """The board along the foot of the walls."""

    height: Annotated[float, Number(least=0.01, most=0.5, unit="m")] = Field(
        default=0.09, description="[m]"
    )
    depth: Annotated[float, Number(least=0.005, most=0.1, unit="m")] = Field(
        default=0.015, description="how far it stands out from the wall [m]"
    )
    colour: LinearColour = Field(default=(0.80, 0.80, 0.78), description="of its paint")


class CurtainSpec(SceneModel):
    """A pair of curtains, drawn aside, on a rod."""

    colour: LinearColour = Field(default=(0.55, 0.50, 0.42), description="of the cloth")
    drawn: Annotated[float, Number(least=0.0, most=0.95)] = Field(
        default=0.0,
        description="how far they are closed: 0 open, near 1 closed",
    )


class _OpeningBase(SceneModel):
    """Base of windows and doors."""

    wall: _Wall = Field(description="north (+y), east (+x), south (-y) or west (-x)")
    at: _Along = Field(
        default=0.0,
        description="its middle along the wall, from the wall's middle, towards +x or +y [m]",
    )


class WindowSpec(_OpeningBase):
    """A window: frame, casements with glass, sill board."""

    type: Literal["window"]
    width: _Opening = Field(default=WINDOW_SIZE_M[0], description="of the opening [m]")
    height: _Opening = Field(default=WINDOW_SIZE_M[1], description="of the opening [m]")
    sill: Annotated[float, Number(least=0.0, most=50.0, unit="m")] = Field(
        default=WINDOW_SIZE_M[2], description="height of the opening's lower edge [m]"
    )
    casements: Annotated[int, Number(least=1, most=8, whole=True)] | None = optional(
        "how many panes beside each other; by the width if left out"
    )
    colour: LinearColour = Field(default=(0.82, 0.82, 0.80), description="of frame and sill")
    curtains: Annotated[CurtainSpec | None, _OrNone()] = optional(
        "true for plain ones, or their keys; none if left out"
    )


class DoorSpec(_OpeningBase):
    """A door: frame, leaf and handles."""

    type: Literal["door"]
    width: _Opening = Field(default=DOOR_SIZE_M[0], description="of the opening [m]")
    height: _Opening = Field(default=DOOR_SIZE_M[1], description="of the opening [m]")
    open: Annotated[float, Number(least=0.0, most=170.0, unit="deg")] = Field(
        default=0.0, description="by which the leaf is turned into the room [deg]"
    )
    hinge: Annotated[Literal["left", "right"], Choice(("left", "right"))] = Field(
        default="left", description="side of the hinges, as seen from inside"
    )
    hinged: Annotated[bool, Switch()] = Field(
        default=False,
        description="true: the leaf is an object 'door 1 leaf' that opens and closes",
    )
    colour: LinearColour = Field(default=(0.78, 0.77, 0.74), description="of leaf and frame")


OpeningSpec: TypeAlias = Annotated[WindowSpec | DoorSpec, Field(discriminator="type")]


class DoorwaySpec(SceneModel):
    """An opening in a wall between rooms: a frame, with or without a leaf."""

    rules: ClassVar[tuple[Rule, ...]] = (only_beside("door", "open", "hinge"),)

    at: _Along = Field(
        default=0.0,
        description="its middle along the wall, from the wall's middle, towards +x or +y [m]",
    )
    width: _Opening = Field(default=DOOR_SIZE_M[0], description="of the opening [m]")
    height: _Opening = Field(default=DOOR_SIZE_M[1], description="of the opening [m]")
    door: Annotated[bool, Switch()] = Field(
        default=False,
        description="true: with a leaf '<wall> door 1 leaf' that opens towards -x or -y",
    )
    open: Annotated[float, Number(least=0.0, most=170.0, unit="deg")] = Field(
        default=0.0, description="by which its leaf is turned [deg]"
    )
    hinge: Annotated[Literal["left", "right"], Choice(("left", "right"))] = Field(
        default="left", description="side of its hinges, as seen from where it opens to"
    )
    colour: LinearColour = Field(
        default=(0.78, 0.77, 0.74), description="of the frame and the leaf"
    )

    def as_door(self) -> DoorSpec:
        """Return the door that hangs in it; the wall that it names means nothing."""
        return DoorSpec(
            type="door",
            wall="south",
            width=self.width,
            height=self.height,
            open=self.open,
            hinge=self.hinge,
            hinged=True,
            colour=self.colour,
        )


class PartitionSpec(SceneModel):
    """A wall inside the room, along x or y: with others it divides the room into several."""

    rules: ClassVar[tuple[Rule, ...]] = (along_an_axis, doorways_inside)

    name: Name = Field(description="unique among the parts of the room")
    start: _Corner = Field(description="one end of its middle line [m]")
    end: _Corner = Field(description="the other end, at the same x or y [m]")
    thickness: Annotated[float, Number(least=0.05, most=1.0, unit="m")] = Field(
        default=0.12, description="[m]"
    )
    north: SurfaceSpec | None = optional("of its side towards +y; that of the walls if left out")
    east: SurfaceSpec | None = optional("of its side towards +x")
    south: SurfaceSpec | None = optional("of its side towards -y")
    west: SurfaceSpec | None = optional("of its side towards -x")
    doorways: tuple[DoorwaySpec, ...] = Field(
        default=(), max_length=16, description="openings to walk through"
    )


class FloorAreaSpec(SceneModel):
    """A part of the floor that is laid with something else."""

    rules: ClassVar[tuple[Rule, ...]] = (corners_apart,)

    name: Name = Field(description="unique among the parts of the room")
    start: _Corner = Field(description="one corner [m]")
    end: _Corner = Field(description="the opposite corner [m]")
    surface: SurfaceSpec = Field(description="its material")


class RoomSpec(SceneModel):
    """Four walls, floor and ceiling, around the origin."""

    rules: ClassVar[tuple[Rule, ...]] = (
        inside_walls,
        without_overlaps,
        inside_room,
        floors_apart,
        distinct_parts,
    )

    size: Annotated[
        tuple[_Extent, _Extent, _Extent],
        Vector(3, "three numbers [along x, along y, height] in [m]"),
    ] = Field(description="inner size along x, along y, and height [m]")
    thickness: Annotated[float, Number(least=0.15, most=1.0, unit="m")] = Field(
        default=0.2, description="of walls, floor and ceiling, outwards [m]"
    )
    walls: SurfaceSpec = Field(default_factory=SurfaceSpec, description="material of the walls")
    wall_materials: WallMaterialsSpec = Field(
        default_factory=WallMaterialsSpec, description="walls that differ from the others"
    )
    floor: SurfaceSpec = Field(
        default_factory=lambda: SurfaceSpec(material="oak_planks"), description="its material"
    )
    ceiling: Annotated[SurfaceSpec | None, _OrNone()] = Field(
        default_factory=SurfaceSpec, description="its material; false for a room without one"
    )
    skirting: Annotated[SkirtingSpec | None, _OrNone()] = Field(
        default_factory=SkirtingSpec, description="board along the walls; false for none"
    )
    openings: tuple[OpeningSpec, ...] = Field(
        default=(), max_length=64, description="windows and doors"
    )
    partitions: tuple[PartitionSpec, ...] = Field(
        default=(), max_length=64, description="walls inside, which make several rooms or an L"
    )
    floors: tuple[FloorAreaSpec, ...] = Field(
        default=(), max_length=64, description="rectangles whose floor differs"
    )

    outside: OutsideSpec = Field(
        default_factory=OutsideSpec,
        description="what lies behind windows and open doors: street, garden or none",
    )

    def look_of(self, part: str) -> dict[str, Any] | None:
        """Return the keys of the look of a wall, the ceiling or a floor; None for other parts."""
        spec = {f"{wall} wall": self.surface_of(wall) for wall in WALLS}.get(part)
        spec = next((area.surface for area in self.floors if area.name == part), spec)
        for partition in self.partitions:
            if partition.name == part:
                sides = (getattr(partition, wall) for wall in WALLS)
                spec = next((side for side in sides if side is not None), self.walls)
        if part in ("floor", "ceiling"):
            spec = getattr(self, part)
        return None if spec is None else spec.keys()

    def surface_of(self, wall: WallName) -> SurfaceSpec:
        """Return what a wall is made of."""
        own: SurfaceSpec | None = getattr(self.wall_materials, wall)
        return self.walls if own is None else own

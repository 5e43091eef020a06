"""From a room's description to its objects: an asset and a place for each part.

`RoomSpec` in, `RoomPart`s out: floor, ceiling, four walls, skirting, windows, doors, curtains.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.material_stock import MaterialStock
from sailenv_ros.assets.rooms.doors import ARCHITRAVE_M, door_collision, door_parts
from sailenv_ros.assets.rooms.pieces import WallFrame, collision_of
from sailenv_ros.assets.rooms.walls import (
    Hole,
    box_of_slab,
    skirting_parts,
    slab_part,
    wall_collision,
    wall_parts,
)
from sailenv_ros.assets.rooms.windows import curtain_parts, window_collision, window_parts
from sailenv_ros.assets.solids import joined
from sailenv_ros.assets.surfaces import Surface
from sailenv_ros.model import Asset, BoxShape, CollisionShape, Material, Mesh, Model, ModelPart
from sailenv_ros.scene.room_rules import WALLS
from sailenv_ros.scene.spec_room import (
    DoorSpec,
    OpeningSpec,
    RoomSpec,
    SurfaceSpec,
    WallName,
    WindowSpec,
)

__all__ = ["RoomPart", "room_parts"]

Vector3 = tuple[float, float, float]
_Frames: TypeAlias = Mapping[WallName, WallFrame]

_surfaces: weakref.WeakValueDictionary[tuple[object, ...], Surface] = weakref.WeakValueDictionary()

_OUTWARD: dict[str, Vector3] = {
    "north": (0.0, 1.0, 0.0),
    "east": (1.0, 0.0, 0.0),
    "south": (0.0, -1.0, 0.0),
    "west": (-1.0, 0.0, 0.0),
}


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RoomPart:
    """A part of a room that never moves; it is not turned against the world.

    Attributes
    ----------
    asset : Asset
        Its display name is the object's.
    position_m : (3,) tuple of float
        Of the asset's origin in the world [m].
    """

    asset: Asset
    position_m: Vector3


def room_parts(spec: RoomSpec, stock: MaterialStock | None = None) -> tuple[RoomPart, ...]:
    """Build a room; the same objects for an equal description while they are kept.

    Parameters
    ----------
    spec : RoomSpec
    stock : MaterialStock or None
        Where its materials come from; None knows those that are made for rooms.

    Raises
    ------
    UnknownName, InvalidRequest, AssetError
        If a material is not known, or a picture cannot be used.
    """
    found = stock or MaterialStock(AssetLibrary())
    walls = [_surface(spec.surface_of(wall), found) for wall in WALLS]
    ceiling = None if spec.ceiling is None else _surface(spec.ceiling, found)
    return _room_parts(spec, _surface(spec.floor, found), ceiling, *walls)


@lru_cache(maxsize=4)
def _room_parts(
    spec: RoomSpec, floor: Surface, ceiling: Surface | None, *walls: Surface
) -> tuple[RoomPart, ...]:
    frames: _Frames = {wall: _frame(spec, wall) for wall in WALLS}
    surfaces = dict(zip(WALLS, walls, strict=True))
    return (
        *_slabs(spec, floor, ceiling),
        *(_wall(spec, wall, frames[wall], surfaces[wall]) for wall in WALLS),
        *_skirting(spec, frames),
        *_openings(spec, frames),
    )


def _frame(spec: RoomSpec, wall: WallName) -> WallFrame:
    size_x, size_y, height = spec.size
    lies_along_x = wall in ("north", "south")
    ox, oy, _ = _OUTWARD[wall]
    return WallFrame(
        along=(1.0, 0.0, 0.0) if lies_along_x else (0.0, 1.0, 0.0),
        outward=_OUTWARD[wall],
        middle_m=(ox * size_x / 2.0, oy * size_y / 2.0, 0.0),
        length_m=size_x if lies_along_x else size_y,
        height_m=height,
        thickness_m=spec.thickness,
        # The walls to north and south run on behind the ends of the two others.
        overhang_m=spec.thickness if lies_along_x else 0.0,
    )


def _slabs(spec: RoomSpec, floor: Surface, ceiling: Surface | None) -> Iterator[RoomPart]:
    """Yield floor and ceiling, which reach under and over the walls."""
    thick = spec.thickness
    size = (spec.size[0] + 2.0 * thick, spec.size[1] + 2.0 * thick)
    for name, of, up, height in (
        ("floor", floor, True, 0.0),
        ("ceiling", ceiling, False, spec.size[2]),
    ):
        if of is not None:
            part = slab_part(size, thick, of, up=up)
            shape = collision_of(box_of_slab(size, thick, up=up))
            yield _part(name, name, [part], [shape], (0.0, 0.0, height))


def _wall(spec: RoomSpec, wall: WallName, frame: WallFrame, surface: Surface) -> RoomPart:
    holes = [
        Hole((o.at - o.width / 2.0, o.at + o.width / 2.0), _rise(o))
        for o in spec.openings
        if o.wall == wall
    ]
    parts = wall_parts(frame, holes, surface)
    return _part(f"{wall} wall", "wall", parts, wall_collision(frame, holes), frame.middle_m)


def _rise(opening: OpeningSpec) -> tuple[float, float]:
    sill = opening.sill if isinstance(opening, WindowSpec) else 0.0
    return sill, sill + opening.height


def _skirting(spec: RoomSpec, frames: _Frames) -> Iterator[RoomPart]:
    """Yield the skirting of all walls as one object, if there is any."""
    board = spec.skirting
    if board is None:
        return
    meshes, shapes = [], []
    red, green, blue = board.colour
    for wall, frame in frames.items():
        gaps = [_gap(o) for o in spec.openings if o.wall == wall and _rise(o)[0] < board.height]
        for mesh, shape in skirting_parts(frame, gaps, board.height, board.depth):
            meshes.append(_moved_mesh(mesh, frame.middle_m))
            shapes.append(_moved_shape(shape, frame.middle_m))
    if meshes:
        paint = Material(name="skirting", base_colour=(red, green, blue, 1.0), roughness=0.4)
        part = ModelPart(mesh=joined(meshes), material=paint)
        yield _part("skirting", "skirting", [part], shapes, (0.0, 0.0, 0.0))


def _moved_mesh(mesh: Mesh, by: Vector3) -> Mesh:
    return replace(mesh, positions=mesh.positions + np.asarray(by, dtype=np.float32))


def _moved_shape(shape: BoxShape, by: Vector3) -> BoxShape:
    x, y, z = (a + b for a, b in zip(shape.centre_m, by, strict=True))
    return replace(shape, centre_m=(x, y, z))


def _gap(opening: OpeningSpec) -> tuple[float, float]:
    half = opening.width / 2.0 + (ARCHITRAVE_M if isinstance(opening, DoorSpec) else 0.0)
    return opening.at - half, opening.at + half


def _openings(spec: RoomSpec, frames: _Frames) -> Iterator[RoomPart]:
    windows = [opening for opening in spec.openings if isinstance(opening, WindowSpec)]
    doors = [opening for opening in spec.openings if isinstance(opening, DoorSpec)]
    for number, window in enumerate(windows, start=1):
        frame = frames[window.wall]
        place = frame.world_point(window.at)
        shapes = window_collision(window, frame)
        yield _part(f"window {number}", "window", window_parts(window, frame), shapes, place)
    for number, door in enumerate(doors, start=1):
        frame = frames[door.wall]
        place, looks = frame.world_point(door.at), door_parts(door, frame)
        yield _part(f"door {number}", "door", looks, door_collision(door, frame), place)
    for number, window in enumerate(windows, start=1):
        if window.curtains is not None:
            frame = frames[window.wall]
            looks = curtain_parts(window, frame)
            yield _part(f"curtains {number}", "curtain", looks, [], frame.world_point(window.at))


def _surface(spec: SurfaceSpec, stock: MaterialStock) -> Surface:
    """Return what a surface is made of; the same object for equal finishes while they are kept."""
    finish = stock.finish(spec)
    material, tile_m = finish.material, finish.tile_m or (1.0, 1.0)
    key = _look(material), tile_m, finish.turn_deg
    found = _surfaces.get(key)
    if found is None:
        found = Surface(material=material, tile_m=tile_m, turn_deg=finish.turn_deg)
        _surfaces[key] = found
    return found


def _look(material: Material) -> tuple[object, ...]:
    """Return what tells materials of surfaces apart, while their textures live."""
    textures = (
        material.base_colour_texture,
        material.metallic_roughness_texture,
        material.normal_texture,
    )
    numbers = (material.base_colour, material.metallic, material.roughness)
    return (material.name, *numbers, *(id(texture) for texture in textures))


def _part(
    name: str,
    category: str,
    parts: Sequence[ModelPart],
    shapes: Sequence[CollisionShape],
    place: Vector3,
) -> RoomPart:
    asset = Asset(
        name=name.replace(" ", "_"),
        display_name=name,
        category=category,
        model=Model(name=name, parts=tuple(parts)),
        collision=tuple(shapes),
        tags=("room",),
    )
    return RoomPart(asset=asset, position_m=place)

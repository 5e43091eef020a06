"""From a room's description to its objects: an asset and a place for each part.

`RoomSpec` in, `RoomPart`s out: floor, ceiling, four walls, skirting, windows, doors, curtains.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.material_library import MaterialLibrary, appearance_key
from sailenv_ros.assets.rooms.door_leaves import door_leaf
from sailenv_ros.assets.rooms.doors import (
    ARCHITRAVE_M,
    door_collision,
    door_parts,
    doorway_collision,
    doorway_parts,
)
from sailenv_ros.assets.rooms.pieces import Faces, WallFrame, collision_of
from sailenv_ros.assets.rooms.wall_frames import Vector3, behind, partition_frame, wall_frame
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
from sailenv_ros.scene.room_rules import WALLS
from sailenv_ros.scene.spec_joints import JointSpec
from sailenv_ros.scene.spec_room import (
    DoorSpec,
    DoorwaySpec,
    FloorAreaSpec,
    OpeningSpec,
    RoomSpec,
    SurfaceSpec,
    WallName,
    WindowSpec,
)
from sailenv_ros.system.memory import cached_for_scenes
from sailenv_ros.types.model import (
    Asset,
    BoxShape,
    CollisionShape,
    Material,
    Mesh,
    Model,
    ModelPart,
)

__all__ = ["RoomPart", "room_parts"]

_Frames: TypeAlias = Mapping[WallName, WallFrame]
_Looks: TypeAlias = Mapping[SurfaceSpec, Surface]

_surfaces: weakref.WeakValueDictionary[tuple[object, ...], Surface] = weakref.WeakValueDictionary()


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RoomPart:
    """A part of a room; it is not turned against the world.

    Attributes
    ----------
    asset : Asset
        Its display name is the object's.
    position_m : (3,) tuple of float
        Of the asset's origin in the world [m].
    joint : JointSpec or None
        What a door's leaf moves on; None of what never moves.
    parent : str
        Display name of the part that carries a leaf.
    """

    asset: Asset
    position_m: Vector3
    joint: JointSpec | None = None
    parent: str = ""


def room_parts(spec: RoomSpec, stock: MaterialLibrary | None = None) -> tuple[RoomPart, ...]:
    """Build a room; the same objects for an equal description while they are kept.

    Parameters
    ----------
    spec : RoomSpec
    stock : MaterialLibrary or None
        Where its materials come from; None knows those that are made for rooms.

    Raises
    ------
    UnknownName, InvalidRequest, AssetError
        If a material is not known, or a picture cannot be used.
    """
    found = stock or MaterialLibrary(AssetLibrary())
    looks = {look: _surface(look, found) for look in dict.fromkeys(_looks(spec))}
    return _room_parts(spec, tuple(looks.items()))


def _looks(spec: RoomSpec) -> Iterator[SurfaceSpec]:
    """Yield what says of what something is made."""
    yield spec.floor
    if spec.ceiling is not None:
        yield spec.ceiling
    yield spec.walls
    yield from (spec.surface_of(wall) for wall in WALLS)
    for partition in spec.partitions:
        yield from (look for wall in WALLS if (look := getattr(partition, wall)) is not None)
    yield from (area.surface for area in spec.floors)


@cached_for_scenes(4)
def _room_parts(
    spec: RoomSpec, looks: tuple[tuple[SurfaceSpec, Surface], ...]
) -> tuple[RoomPart, ...]:
    frames: _Frames = {wall: wall_frame(spec, wall) for wall in WALLS}
    surfaces = dict(looks)
    return (
        *_slabs(spec, surfaces),
        *(_wall(spec, wall, frames[wall], surfaces[spec.surface_of(wall)]) for wall in WALLS),
        *_skirting(spec, frames),
        *_openings(spec, frames),
        *_partitions(spec, surfaces),
        *_leaves(spec, frames),
    )


def _partitions(spec: RoomSpec, looks: _Looks) -> Iterator[RoomPart]:
    """Yield the walls inside the room, each with its doorways."""
    for partition in spec.partitions:
        frame, sides = partition_frame(partition, spec.size[2])
        holes = [_doorway_hole(doorway) for doorway in partition.doorways]
        surfaces = [looks[getattr(partition, side) or spec.walls] for side in sides]
        parts = [*wall_parts(frame, holes, surfaces[0], surfaces[1])]
        shapes = [*wall_collision(frame, holes)]
        for doorway in partition.doorways:
            by = frame.point(doorway.at, 0.0, 0.0)
            door = doorway.as_door()
            drawn = door_parts(door, frame) if doorway.door else doorway_parts(doorway, frame)
            for part in drawn:
                parts.append(replace(part, mesh=_moved_mesh(part.mesh, _vector(by))))
            shapes += [
                _moved_shape(shape, _vector(by)) for shape in doorway_collision(doorway, frame)
            ]
        yield _part(partition.name, "wall", parts, shapes, frame.middle_m)


def _leaves(spec: RoomSpec, frames: _Frames) -> Iterator[RoomPart]:
    """Yield the leaves of doors that open and close."""
    doors = [opening for opening in spec.openings if isinstance(opening, DoorSpec)]
    for number, door in enumerate(doors, start=1):
        if door.hinged:
            yield _leaf(f"door {number}", f"door {number}", door, frames[door.wall], door.at)
    for partition in spec.partitions:
        frame, _ = partition_frame(partition, spec.size[2])
        for number, doorway in enumerate(partition.doorways, start=1):
            if doorway.door:
                name = f"{partition.name} door {number}"
                yield _leaf(name, partition.name, doorway.as_door(), frame, doorway.at)


def _leaf(name: str, parent: str, door: DoorSpec, frame: WallFrame, at: float) -> RoomPart:
    leaf, place = door_leaf(door, frame), frame.world_point(at)
    part = _part(f"{name} leaf", "door", leaf.parts, [leaf.shape], place)
    x, y, z = leaf.shape.centre_m
    asset = replace(part.asset, mass_kg=leaf.mass_kg, centre_of_mass_m=(x, y, z))
    return RoomPart(asset=asset, position_m=place, joint=leaf.joint, parent=parent)


def _doorway_hole(doorway: DoorwaySpec) -> Hole:
    half = doorway.width / 2.0
    return Hole((doorway.at - half, doorway.at + half), (0.0, doorway.height))


def _vector(values: NDArray[np.float64]) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z


def _slabs(spec: RoomSpec, looks: _Looks) -> Iterator[RoomPart]:
    """Yield floor and ceiling, which reach under and over the walls."""
    thick = spec.thickness
    size = (spec.size[0] + 2.0 * thick, spec.size[1] + 2.0 * thick)
    for name, of, up, height in (
        ("floor", spec.floor, True, 0.0),
        ("ceiling", spec.ceiling, False, spec.size[2]),
    ):
        if of is not None:
            areas = [_floor_rectangle(area) for area in spec.floors] if up else []
            part = slab_part(size, thick, looks[of], up=up, without=areas)
            shape = collision_of(box_of_slab(size, thick, up=up))
            yield _part(name, name, [part], [shape], (0.0, 0.0, height))
    for area in spec.floors:
        rectangle, of_area = _floor_rectangle(area), looks[area.surface]
        (west, east), (south, north) = rectangle.along, rectangle.up
        faces = Faces()
        faces.add((west, south, 0.0), (east - west, 0, 0), (0, north - south, 0), (0, 0, 1))
        part = ModelPart(mesh=faces.mesh(of_area), material=of_area.material)
        # The floor below is solid everywhere.
        yield _part(area.name, "floor", [part], [], (0.0, 0.0, 0.0))


def _floor_rectangle(area: FloorAreaSpec) -> Hole:
    """Return from where to where along x and along y a part of the floor lies."""
    (x0, y0), (x1, y1) = area.start, area.end
    return Hole((min(x0, x1), max(x0, x1)), (min(y0, y1), max(y0, y1)))


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
    for frame, gaps in _boarded(spec, frames, board.height):
        for mesh, shape in skirting_parts(frame, gaps, board.height, board.depth):
            meshes.append(_moved_mesh(mesh, frame.middle_m))
            shapes.append(_moved_shape(shape, frame.middle_m))
    if meshes:
        paint = Material(name="skirting", base_colour=(red, green, blue, 1.0), roughness=0.4)
        part = ModelPart(mesh=joined(meshes), material=paint)
        yield _part("skirting", "skirting", [part], shapes, (0.0, 0.0, 0.0))


def _boarded(
    spec: RoomSpec, frames: _Frames, height_m: float
) -> Iterator[tuple[WallFrame, list[tuple[float, float]]]]:
    """Yield the sides of walls that have a skirting, and where it is interrupted."""
    for wall, frame in frames.items():
        yield frame, [_gap(o) for o in spec.openings if o.wall == wall and _rise(o)[0] < height_m]
    for partition in spec.partitions:
        frame, _ = partition_frame(partition, spec.size[2])
        beside = [
            (d.at - d.width / 2.0 - ARCHITRAVE_M, d.at + d.width / 2.0 + ARCHITRAVE_M)
            for d in partition.doorways
        ]
        yield frame, beside
        yield behind(frame), beside


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


def _surface(spec: SurfaceSpec, stock: MaterialLibrary) -> Surface:
    """Return what a surface is made of; the same object for equal finishes while they are kept."""
    finish = stock.finish(spec)
    material, tile_m = finish.material, finish.tile_m or (1.0, 1.0)
    key = appearance_key(material), tile_m, finish.turn_deg
    found = _surfaces.get(key)
    if found is None:
        found = Surface(material=material, tile_m=tile_m, turn_deg=finish.turn_deg)
        _surfaces[key] = found
    return found


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

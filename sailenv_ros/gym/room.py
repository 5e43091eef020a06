"""A room to act in: what is drawn, where one can stand, who draws it. Nothing in it changes.

An environment's own objects are moved by exchanging their poses in a copy of the snapshot. So many
environments share a room, and what one of them sees depends on no other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.viewpoints.object_targets import boxes_in_world, boxes_of
from sailenv_ros.errors import NoFreeSpace
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.finished_light import bake_missing
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.script.scenario import SceneOverlay
from sailenv_ros.space.free_space import BodySize, FreeSpace
from sailenv_ros.space.grid import map_free_space
from sailenv_ros.space.outlines import solids_of
from sailenv_ros.system.memory import give_back_freed_memory
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import ROOM_PARTS, UNLABELLED_CATEGORY
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.world.world import World

__all__ = ["DOOR_STEPS", "Door", "OwnObject", "Room", "RoomOrder", "open_room"]

DOOR_STEPS = 8
"""Equal steps from shut to open."""

NOT_SOUGHT = ROOM_PARTS | {"plane"}
"""Categories that nobody searches for."""


@dataclass(frozen=True, slots=True)
class OwnObject:
    """Object that an environment moves by itself.

    Attributes
    ----------
    name, asset : str
    scale : (3,) tuple of float
        Along the asset's axes.
    colour : str
        As in a scene file.
    """

    name: str
    asset: str
    scale: tuple[float, float, float]
    colour: str


@dataclass(frozen=True, slots=True)
class RoomOrder:
    """Description of a room that an environment wants; equal orders share one room.

    Attributes
    ----------
    name : str
        Of a scene.
    body : BodySize
        Who walks in it.
    own : tuple of OwnObject
        Objects that the environment moves by itself.
    baked : bool
        True for light that was baked, False for plain light.
    threads : int
        That draw.
    opens : bool
        True where doors are opened.
    """

    name: str
    body: BodySize
    own: tuple[OwnObject, ...] = ()
    baked: bool = False
    threads: int = 1
    opens: bool = False


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Door:
    """Something on a hinge.

    Attributes
    ----------
    name : str
        Of what moves on it.
    leaf : int
        Its row in the snapshot.
    places : tuple of mapping of int to (4, 4) array
        Poses of all that moves with it, by rows: from the start to the farther limit, in equal
        steps of the angle.
    """

    name: str
    leaf: int
    places: tuple[Mapping[int, NDArray[np.float64]], ...]


@dataclass(eq=False, kw_only=True)
class Room:
    """A room that was built.

    Attributes
    ----------
    order : RoomOrder
    snapshot : WorldSnapshot
        Everything as it stands at the start; own objects wait far above.
    space : FreeSpace
        Where the body can stand; own objects are not in the way.
    renderer : NativeRenderer
    doors : tuple of Door
        What opens in it.
    users : int
        Environments that are in it.
    """

    order: RoomOrder
    snapshot: WorldSnapshot
    space: FreeSpace
    renderer: NativeRenderer
    doors: tuple[Door, ...] = ()
    users: int = 0
    _drawn: bool = False

    @property
    def name(self) -> str:
        """Name of its scene."""
        return self.order.name

    def was_drawn(self) -> None:
        """Give back, once, what building it and its textures left free: 60 to 90 MB."""
        if not self._drawn:
            self._drawn = True
            give_back_freed_memory()

    def named(self, places: Mapping[int, NDArray[np.float64]]) -> dict[str, Pose]:
        """Return poses by rows as poses by names of objects."""
        instances = self.snapshot.contents.instances
        return {
            instances[row].instance.name: Pose.from_matrix(pose) for row, pose in places.items()
        }

    @cached_property
    def own_boxes(self) -> NDArray[np.float64]:
        """(N, 2, 3) lowest and highest corner of each instance in its own axes [m]."""
        return boxes_of(self.snapshot)

    @cached_property
    def boxes(self) -> NDArray[np.float64]:
        """(N, 2, 3) lowest and highest corner of the box around each instance, in the world [m]."""
        return boxes_in_world(self.own_boxes, self.snapshot.world_from_body)

    @cached_property
    def rows(self) -> Mapping[str, int]:
        """Row of each instance in the snapshot, by its name."""
        return {
            drawn.instance.name: row for row, drawn in enumerate(self.snapshot.contents.instances)
        }

    @cached_property
    def ids(self) -> NDArray[np.uint16]:
        """(N,) uint16 instance id of each row."""
        return self.snapshot.contents.instance_ids

    @cached_property
    def objects(self) -> Mapping[str, tuple[int, ...]]:
        """Rows of the objects of each category, without parts of the room and own objects."""
        own = {one.name for one in self.order.own}
        found: dict[str, list[int]] = {}
        for row, drawn in enumerate(self.snapshot.contents.instances):
            one = drawn.instance
            labelled = one.category_id not in (0, UNLABELLED_CATEGORY)
            within = drawn.outside is None and bool(drawn.model.parts)
            if labelled and within and one.category not in NOT_SOUGHT and one.name not in own:
                found.setdefault(one.category, []).append(row)
        return {category: tuple(rows) for category, rows in sorted(found.items())}

    def scene_at(self, time_ns: int, moved: Mapping[int, NDArray[np.float64]]) -> WorldSnapshot:
        """Return the room at a time, some rows of it at other poses (4, 4)."""
        poses = self.snapshot.world_from_body
        if moved:
            poses = poses.copy()
            for row, pose in moved.items():
                poses[row] = pose
        return replace(self.snapshot, sim_time_ns=time_ns, world_from_body=poses)

    def close(self) -> None:
        """Free its renderer."""
        self.renderer.close()


def open_room(order: RoomOrder, library: SceneLibrary, renderer: NativeRenderer) -> Room:
    """Build a room; errors as of `SceneLibrary.build`.

    Raises
    ------
    NoFreeSpace
        If the body has no place in it.
    """
    own: list[dict[str, Any]] = [
        {
            "name": one.name,
            "asset": one.asset,
            "scale": one.scale,
            "colour": one.colour,
            "gravity": False,
            "position": [0.0, 0.0, 50.0 + 5.0 * number],
        }
        for number, one in enumerate(order.own)
    ]
    with closing(library.build(order.name, more=SceneOverlay(own))) as world:
        if order.baked:
            bake_missing(world)
        names = {entry["name"] for entry in own}
        solids = [
            solid
            for body in world.bodies
            if body.placement.name not in names
            for solid in solids_of(
                body.placement.asset.collision, body.placement.scale, body.world_from_body()
            )
        ]
        space = map_free_space(solids, order.body)
        snapshot = world.snapshot()
        doors = tuple(_doors_of(world, snapshot)) if order.opens else ()
    if not (space.regions == 1).any():
        raise NoFreeSpace(
            f"in {order.name} no place is free for a body of radius {order.body.radius_m:g} m and "
            f"height {order.body.height_m:g} m; a smaller one may find one"
        )
    return Room(order=order, snapshot=snapshot, space=space, renderer=renderer, doors=doors)


def _doors_of(world: World, snapshot: WorldSnapshot) -> Iterator[Door]:
    """Yield what hinges of a world with limits move, opened bit by bit; it is shut afterwards."""
    for joint in world.joints():
        if joint.type != "hinge" or not 0.0 < joint.high - joint.low < math.inf:
            continue
        shut = joint.position
        far = joint.high if joint.high - shut >= shut - joint.low else joint.low
        poses = []
        for share in np.linspace(0.0, 1.0, DOOR_STEPS + 1):
            world.set_joint(joint.id, float(shut + share * (far - shut)))
            poses.append(world.snapshot().world_from_body)
        world.set_joint(joint.id, shut)
        moved = (np.array(poses) != snapshot.world_from_body).any(axis=(0, 2, 3))
        rows = tuple(np.flatnonzero(moved).tolist())
        leaf = int(np.flatnonzero(snapshot.contents.instance_ids == joint.id)[0])
        places = tuple({row: pose[row] for row in rows} for pose in poses)
        yield Door(name=joint.name, leaf=leaf, places=places)

"""The rooms that are open in this process, shared by its environments."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable

from sailenv_ros.gym.room import Room, RoomOrder, open_room
from sailenv_ros.render.cpu.mesh_store import MeshStore
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.cpu.texture_store import TextureStore
from sailenv_ros.render.scene.drawn_meshes import DrawnMesh
from sailenv_ros.render.scene.reflection_store import ReflectionStore
from sailenv_ros.render.scene.room_reflections import Share
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.model import Material

__all__ = ["MOST_ROOMS", "RoomStore", "shared_rooms"]

MOST_ROOMS = 16
"""Rooms that stay open though nobody is in them."""


class _KeptMeshes(MeshStore):
    """Meshes of several rooms at once: one of them alone does not know what is shown."""

    def trim(self, shown: Iterable[DrawnMesh]) -> None:
        """Keep everything."""

    def keep(self, tables: Iterable[PartTable]) -> None:
        """Forget what no room shows."""
        super().trim(mesh for table in tables for mesh in table.shown_meshes())


class _KeptTextures(TextureStore):
    """Textures of several rooms at once."""

    def trim(self, shown: Iterable[Material]) -> None:
        """Keep everything."""

    def keep(self, tables: Iterable[PartTable]) -> None:
        """Forget what no room shows."""
        super().trim(material for table in tables for material in table.shown_materials())


class RoomStore:
    """Opens rooms when they are first entered, and keeps those that were entered last.

    Assets, meshes and textures are shared by all of them. Used by one thread.

    Attributes
    ----------
    most_rooms : int
        That stay open though nobody is in them. Opening one takes seconds, one that is open takes
        some 100 MB.
    """

    def __init__(self, most_rooms: int = MOST_ROOMS) -> None:
        self.most_rooms = most_rooms
        self._environments = 0
        self._rooms: dict[RoomOrder, Room] = {}
        self._clear()

    def join(self) -> None:
        """Count one more environment."""
        self._environments += 1

    def part(self) -> None:
        """Count one environment less; with the last one everything is freed."""
        self._environments -= 1
        if not self._environments:
            for room in self._rooms.values():
                room.close()
            self._clear()

    def enter(self, order: RoomOrder) -> Room:
        """Return a room; it is opened if it is not. `leave` it afterwards.

        Errors as of `open_room`.
        """
        room = self._rooms.pop(order, None) or self._open(order)
        self._rooms[order] = room  # the one entered last is the last to be closed
        room.users += 1
        return room

    def leave(self, room: Room) -> None:
        """Leave a room that was entered; it stays open until others were entered."""
        room.users -= 1
        empty = [order for order, one in self._rooms.items() if not one.users]
        gone = empty[: max(0, len(self._rooms) - self.most_rooms)]
        for order in gone:
            self._rooms.pop(order).close()
        if gone:
            tables = [one.renderer.part_table for one in self._rooms.values()]
            self._meshes.keep(tables)
            self._textures.keep(tables)

    def categories(self) -> CategoryTable:
        """Return the categories that all rooms know."""
        return self._library(baked=False).categories

    def _open(self, order: RoomOrder) -> Room:
        renderer = NativeRenderer(
            threads=order.threads,
            table=PartTable(self._meshes, self._textures),
            reflections=self._reflections,
        )
        try:
            return open_room(order, self._library(baked=order.baked), renderer)
        except BaseException:
            renderer.close()
            raise

    def _library(self, *, baked: bool) -> SceneLibrary:
        if baked not in self._libraries:
            self._libraries[baked] = SceneLibrary(baked_light=baked, drafts=False)
        return self._libraries[baked]

    def _clear(self) -> None:
        self._rooms.clear()
        self._libraries: dict[bool, SceneLibrary] = {}
        self._meshes, self._textures = _KeptMeshes(), _KeptTextures()
        self._reflections: ReflectionStore[Share] = ReflectionStore()


class _Shared(threading.local):
    """The store of one thread, and the process that it was made in."""

    store: RoomStore | None = None
    process = 0


_SHARED = _Shared()


def shared_rooms() -> RoomStore:
    """Return the store of this thread; a fork has one of its own."""
    if _SHARED.store is None or _SHARED.process != os.getpid():
        _SHARED.store, _SHARED.process = RoomStore(), os.getpid()
    return _SHARED.store

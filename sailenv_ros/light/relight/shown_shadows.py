"""Keeps the shadows of what can move while a scene runs. From baked light to what is shown.

A shadow is a function of what stands where: of what rests, and of the furniture that has changed.
What moves has none; the picture darkens its surroundings until it rests.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.found_light import MOST_PLACES
from sailenv_ros.light.relight.kept_light import kept_light
from sailenv_ros.light.relight.movable_objects import casts_shadows
from sailenv_ros.light.relight.moved_surfaces import moved_surfaces
from sailenv_ros.light.relight.object_light import (
    ObjectLighting,
    Place,
    PlacedObject,
    SurfacePoints,
    near_changes,
)
from sailenv_ros.light.relight.object_shadows import ObjectShadows
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.system.array_cache import Arrays
from sailenv_ros.types.baked_light import BakedLight

__all__ = ["ShownShadows"]

NEAR_M = 0.25
"""Furniture that is farther from an object's ball changes nothing of its shadow [m]."""

_Places: TypeAlias = tuple[tuple[Place, ...], ...]


class ShownShadows:
    """The shadows in one scene.

    Parameters
    ----------
    scene : BakedScene
    points : SurfacePoints
    """

    def __init__(self, scene: BakedScene, points: SurfacePoints) -> None:
        self._scene, self._points = scene, points
        self._still: ObjectShadows | None = None
        self._seen: list[object] = []
        self._places: _Places | None = ()
        self._begins_again = False
        self._changed: tuple[tuple[object, ...], ObjectShadows] | None = None
        self._shown: tuple[BakedLight, BakedLight] | None = None

    def on(
        self,
        light: BakedLight,
        things: Sequence[PlacedObject],
        changes: Sequence[Change],
        *,
        threads: int,
    ) -> BakedLight:
        """Return light with the shadows of objects; the same object while nothing has changed.

        Parameters
        ----------
        light : BakedLight
            Of the scene with its changes.
        things : sequence of PlacedObject
            Those that rest; what stops no light has no shadow.
        changes : sequence of Change
            Furniture that counts as standing elsewhere.
        threads : int
            The result does not depend on it.
        """
        things = [thing for thing in things if casts_shadows(thing.model)]
        shadows, moved = self._follow({one.id: (one.place, one) for one in things}, threads)
        key = tuple(change.key for change in changes)
        if moved or (self._changed is not None and self._changed[0] != key):
            self._changed, self._shown = None, None
        if changes:
            if self._changed is None:
                self._changed = key, self._with_changes(shadows, changes, things)
                self._shown = None
            shadows = self._changed[1]
        if self._shown is None or self._shown[0] is not light:
            self._shown = light, shadows.on(light)
            if self._places and not changes and self._places not in self._scene.found.shadows:
                self._scene.found.keep(self._places, shadows)
        return self._shown[1]

    def _follow(
        self, things: Mapping[int, tuple[object, PlacedObject]], threads: int
    ) -> tuple[ObjectShadows, bool]:
        """Find shadows where things are; return them without changes, and whether they are others.

        Those that a scene begins with are kept with it, and on disk with the room's light.
        """
        scene, still = self._scene, self._still
        if still is not None and [place for place, _ in things.values()] == self._seen:
            return still, False
        self._seen = [place for place, _ in things.values()]
        self._places = _more(self._places, things)
        if self._places is None:
            assert still is not None
            return still, still.update(things, threads)
        known = scene.found.shadows.get(self._places)
        if isinstance(known, ObjectShadows):
            self._still = known.copy()
            if self._places not in scene.found.asked:
                scene.found.asked.add(self._places)
                if known.casters and scene.baked.checksum:
                    self._on_disk(known.arrays)
            return self._still, True
        if still is None:
            lighting = ObjectLighting(scene, (), self._points)
            still = self._still = ObjectShadows(lighting, moved_surfaces(scene, ()))
        if not things or not scene.baked.checksum:
            return still, still.update(things, threads)
        found_now = False

        def find() -> Arrays:
            nonlocal found_now
            found_now = True
            still.update(things, threads)
            return still.arrays()

        # What the same beginning leads to is often the same, but not what chance does to it then.
        first = len(self._places) == 1
        found = self._on_disk(find, keep=first or self._begins_again)
        if not found_now:
            still.take(things, found, threads)
        self._begins_again = first and not found_now
        return still, True

    def _on_disk(self, find: Callable[[], Arrays], *, keep: bool = True) -> Arrays:
        """Return what is kept on disk of shadows of things that have been where they have been."""
        return kept_light("shadows", self._scene, self._places or (), find, keep=keep)

    def _with_changes(
        self, still: ObjectShadows, changes: Sequence[Change], things: Sequence[PlacedObject]
    ) -> ObjectShadows:
        scene = self._scene
        near = near_changes(scene, things, changes, NEAR_M)
        lighting = ObjectLighting(scene, changes, self._points)
        return still.with_changes(lighting, moved_surfaces(scene, changes), near)


def _more(
    places: _Places | None, things: Mapping[int, tuple[object, PlacedObject]]
) -> _Places | None:
    """Return the places of objects so far and now; None where there are too many to be kept."""
    if places is None or len(places) == MOST_PLACES:
        return None
    return *places, tuple(thing.place for _, thing in things.values())

"""Keeps the shadows of what can move while a scene runs. From baked light to what is shown.

A shadow is a function of what stands where: of what rests, and of the furniture that has changed.
What moves has none; the picture darkens its surroundings until it rests.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_scene import BakedScene, albedo_of_model
from sailenv_ros.light.relight.found_light import MOST
from sailenv_ros.light.relight.moved_surfaces import moved_surfaces
from sailenv_ros.light.relight.object_light import (
    ObjectLighting,
    PlacedObject,
    SurfacePoints,
    near_changes,
)
from sailenv_ros.light.relight.object_shadows import ObjectShadows
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.native.library import native_library
from sailenv_ros.system.array_cache import cached_arrays, code_digest
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.digests import model_digest

__all__ = ["ShownShadows"]

NEAR_M = 0.25
"""Furniture that is farther from an object's ball changes nothing of its shadow [m]."""


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
        self._places: tuple[object, ...] | None = ()
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
            Those that rest.
        changes : sequence of Change
            Furniture that counts as standing elsewhere.
        threads : int
            The result does not depend on it.
        """
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

        The first ones are kept with the scene, and on disk with the room's light.
        """
        scene, still = self._scene, self._still
        if still is not None and [place for place, _ in things.values()] == self._seen:
            return still, False
        self._seen = [place for place, _ in things.values()]
        self._places = _more(self._places, things)
        known = scene.found.shadows.get(self._places) if self._places else None
        if isinstance(known, ObjectShadows):
            self._still = known.copy()
            return self._still, True
        if still is None:
            lighting = ObjectLighting(scene, (), self._points)
            still = self._still = ObjectShadows(lighting, moved_surfaces(scene, ()))
        checksum = scene.baked.checksum
        if still.casters or not things or not checksum:
            return still, still.update(things, threads)

        def find() -> Mapping[str, NDArray[Any]]:
            still.update(things, threads)
            return still.arrays()

        told = [
            (
                *(thing.id, thing.scale, thing.world_from_body.tobytes()),
                *(model_digest(thing.model), albedo_of_model(thing.model).tolist()),
            )
            for _, thing in things.values()
        ]
        code = code_digest("light/bake", "light/relight", "native", "rays", "types")
        key = checksum, native_library().digest, *scene.drawn, *told
        found = cached_arrays("shadows", key, find, code=code)
        if not still.casters:
            still.take(things, found, threads)
        return still, True

    def _with_changes(
        self, still: ObjectShadows, changes: Sequence[Change], things: Sequence[PlacedObject]
    ) -> ObjectShadows:
        scene = self._scene
        near = near_changes(scene, things, changes, NEAR_M)
        lighting = ObjectLighting(scene, changes, self._points)
        return still.with_changes(lighting, moved_surfaces(scene, changes), near)


def _more(
    places: tuple[object, ...] | None, things: Mapping[int, tuple[object, PlacedObject]]
) -> tuple[object, ...] | None:
    """Return the places of objects so far and now; None where there are too many to be kept."""
    if places is None or len(places) == MOST:
        return None
    return *places, tuple(place for place, _ in things.values())

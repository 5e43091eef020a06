"""Keeps the light on what can move while a scene runs. From snapshots to `ObjectLight` by id.

Light is a function of what stands where: of an object's own place, of what stands near, and of the
changes of what was baked. It is computed once for each place.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import replace
from typing import NamedTuple

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.found_light import KnownLight
from sailenv_ros.light.relight.kept_light import kept_light, stacked, unstacked
from sailenv_ros.light.relight.movable_objects import MovableObjects
from sailenv_ros.light.relight.object_light import (
    ObjectLighting,
    Place,
    PlacedObject,
    SurfacePoints,
    near_changes,
)
from sailenv_ros.light.relight.quality import AT_VERTICES, FINE, QUICK, Quality
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.light.relight.shown_shadows import ShownShadows
from sailenv_ros.light.relight.vertex_points import vertex_points
from sailenv_ros.types.baked_light import ObjectLight
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["ObjectLights", "with_object_light"]

FAR_M = 1.0
"""Furniture that is farther from an object's ball counts when its own light is refined [m]."""

LEAST_AT_VERTICES_M = 0.05
"""Radius of an object's ball from which light at its vertices is found: of smaller ones little is
seen of it [m]."""

LEAST_SHARE = 0.25
"""Radius that another object near it has at least, over its own, to count there."""

WHOLE, WITH, WITHOUT, FOUND = range(4)
"""Parts of the light on an object: all of it; with and without what moves, by few rays; that at
its vertices."""

MOST_MOVING = 12
"""Of the objects that move so many get light of their own in each snapshot, those with the lowest
ids; others have that of the probes."""


def with_object_light(snapshot: WorldSnapshot, scene: BakedScene, threads: int) -> WorldSnapshot:
    """Return a snapshot of a scene that is as it was baked, with the light on all that can move.

    Its shadows are in the light of what was baked.
    """
    objects, contents = ObjectLights(), snapshot.contents
    assert contents.baked is not None
    light = objects.update(snapshot, scene, (), threads=threads)
    shadows = ShownShadows(scene, objects.points)
    rest = [thing for thing in objects.things if not thing.moves]
    baked = shadows.on(contents.baked, rest, (), threads=threads)
    return replace(snapshot, contents=replace(contents, baked=baked), object_light=light)


class ObjectLights:
    """The light on what can move in one scene.

    Attributes
    ----------
    points : SurfacePoints
    """

    def __init__(self) -> None:
        self.points, self._movable = SurfacePoints(), MovableObjects()
        self._of: tuple[object, ...] = ()
        self._seen: tuple[object, tuple[bytes, bytes]] = (None, (b"", b""))
        self._lightings: dict[tuple[object, ...], ObjectLighting] = {}
        self._still: dict[tuple[int, int], tuple[KnownLight, ...]] = {}
        self._known: dict[tuple[int, int], KnownLight] = {}
        self._light: Mapping[int, ObjectLight] = {}
        self._sums: dict[int, tuple[tuple[KnownLight | None, ...], ObjectLight]] = {}

    @property
    def things(self) -> list[PlacedObject]:
        """Where objects were at the last update, to the steps that count."""
        return self._movable.things

    def update(
        self,
        snapshot: WorldSnapshot,
        scene: BakedScene,
        changes: Sequence[Change],
        *,
        rough: bool = False,
        threads: int,
    ) -> Mapping[int, ObjectLight]:
        """Return the light on objects, by instance id; the same mapping if nothing has changed.

        Parameters
        ----------
        snapshot : WorldSnapshot
        scene : BakedScene
            Of its bake.
        changes : sequence of Change
            What was baked and stands elsewhere.
        rough : bool
            True leaves changes out of the light on what is far from them.
        threads : int
            The result does not depend on it.
        """
        of = scene, rough, *(change.key for change in changes)
        seen = snapshot.world_from_body.tobytes(), snapshot.moving.tobytes()
        instances = snapshot.contents.instances
        if of == self._of and instances is self._seen[0] and seen == self._seen[1]:
            return self._light
        self._seen = instances, seen
        self._movable.follow(snapshot)
        things = self._movable.things
        if of != self._of:
            if self._of[:1] != (scene,):
                self._lightings, self._still = {}, scene.found.objects
            self._lightings = {key: one for key, one in self._lightings.items() if not key}
            self._of, self._known = of, {}
        affected = near_changes(scene, things, changes, FAR_M)
        every = tuple(change.key for change in changes)
        known: dict[tuple[int, int], KnownLight] = {}
        asked: list[_Asked] = []
        for place in _chosen(things):
            thing = things[place]
            for number, part in self._parts(place).items():
                far = (rough or number == FOUND) and thing.id not in affected
                counted = () if far else changes
                moved = every if counted else ()
                same = self._as_before(thing.id, number, moved, part)
                if same is not None:
                    known[thing.id, number] = same
                    continue
                if moved not in self._lightings:
                    self._lightings[moved] = ObjectLighting(scene, counted, self.points)
                asked.append(_Asked((thing.id, number), thing, moved, part))
        if known != self._known or asked:
            # A scene begins: what follows is that of each time that it does.
            begins = not (self._still or changes) and bool(scene.baked.checksum)
            known |= self._found(asked, scene if begins else None, threads)
            self._known = known
            # What no change counts for is so again when furniture is back, or the scene begins.
            for of_part, one in known.items():
                of_changes, quality, _ = one[0]
                kept = self._still.get(of_part, ())
                if quality is not QUICK and not of_changes and all(one is not k for k in kept):
                    self._still[of_part] = *kept[:1], one
            self._sums = {id_: self._summed(known, id_) for id_, number in known if number == WHOLE}
            self._light = {id_: light for id_, (_, light) in self._sums.items()}
        return self._light

    def _summed(
        self, known: Mapping[tuple[int, int], KnownLight], id_: int
    ) -> tuple[tuple[KnownLight | None, ...], ObjectLight]:
        """Return the parts of the light on an object and their sum, the same one of the same."""
        parts = tuple(known.get((id_, number)) for number in (WHOLE, WITH, WITHOUT, FOUND))
        before = self._sums.get(id_)
        if before is not None and all(
            one is two for one, two in zip(parts, before[0], strict=True)
        ):
            return before
        return parts, _sum_of(known, id_)

    def _as_before(
        self, id_: int, number: int, moved: tuple[object, ...], part: _Part
    ) -> KnownLight | None:
        """Return what is known already of a part of the light on an object."""
        before = self._known.get((id_, number)), *self._still.get((id_, number), ())
        return next((one for one in before if one and _is_of(one, moved, part)), None)

    def _found(
        self, asked: Sequence[_Asked], begins: BakedScene | None, threads: int
    ) -> dict[tuple[int, int], KnownLight]:
        """Find parts of light; of a scene that begins, that on what rests is kept on disk."""
        kept: dict[tuple[int, int], ObjectLight] = {}
        rest = [one for one in asked if begins is not None and one.part.quality is not QUICK]
        if begins is not None and rest:
            places = [one.part.around for one in rest]
            arrays = kept_light(
                "object_light", begins, places, lambda: stacked(self._traced(rest, threads))
            )
            kept = dict(zip((one.of for one in rest), unstacked(arrays), strict=True))
        others = [one for one in asked if one.of not in kept]
        light = kept | dict(
            zip((one.of for one in others), self._traced(others, threads), strict=True)
        )
        return {
            one.of: ((one.moved, one.part.quality, one.part.around), light[one.of]) for one in asked
        }

    def _traced(self, asked: Sequence[_Asked], threads: int) -> list[ObjectLight]:
        things = self._movable.things

        def trace(one: _Asked) -> ObjectLight:
            near = [things[other] for other in one.part.near]
            return self._lightings[one.moved].light_on(one.thing, near, one.part.quality)

        with ExitStack() as opened:
            # To begin a thread takes longer than the light on what moves.
            apart = threads > 1 and len(asked) > 1
            mapped = opened.enter_context(ThreadPoolExecutor(threads)).map if apart else map
            return list(mapped(trace, asked))

    def _parts(self, place: int) -> dict[int, _Part]:
        """Return what the light on an object is put together from.

        What moves near an object that rests changes little of its light, and from frame to frame:
        the difference that it makes is found with few rays, the same ones with it and without.
        """
        movable = self._movable
        near, around = movable.near[place], movable.around[place]
        if movable.things[place].moves:
            return {WHOLE: _Part(QUICK, near, around)}
        resting = [other for other in near if not movable.things[other].moves]
        parts: dict[int, _Part] = {}
        if len(resting) == len(near):
            parts[WHOLE] = _Part(FINE, near, around)
        else:
            without = self._around(place, resting)
            parts[WHOLE] = _Part(FINE, resting, without)
            parts[WITH], parts[WITHOUT] = (
                _Part(QUICK, near, around),
                _Part(QUICK, resting, without),
            )
        radius, model = movable.radii[place], movable.things[place].model
        if radius >= LEAST_AT_VERTICES_M and vertex_points(model) is not None:
            large = [other for other in resting if movable.radii[other] >= LEAST_SHARE * radius]
            parts[FOUND] = _Part(AT_VERTICES, large, self._around(place, large))
        return parts

    def _around(self, place: int, others: list[int]) -> tuple[Place, ...]:
        """Return the place of an object, and those of others."""
        return self._movable.places[place], *(self._movable.places[other] for other in others)


class _Part(NamedTuple):
    """Light on an object as it would be by some of what stands near.

    Attributes
    ----------
    quality : Quality
    near : list of int
        Places of the objects that count.
    around : tuple of Place
        Of the object itself and of these.
    """

    quality: Quality
    near: list[int]
    around: tuple[Place, ...]


class _Asked(NamedTuple):
    """A part of the light on an object that is to be found.

    Attributes
    ----------
    of : tuple of int
        Id of the object and number of the part.
    thing : PlacedObject
    moved : tuple
        Keys of the changes that count.
    part : _Part
    """

    of: tuple[int, int]
    thing: PlacedObject
    moved: tuple[object, ...]
    part: _Part


def _sum_of(known: Mapping[tuple[int, int], KnownLight], id_: int) -> ObjectLight:
    """Return the light on an object from its parts: the first, or it, the second less the third."""
    light = known[id_, WHOLE][1]
    if (id_, FOUND) in known:
        at_vertices = known[id_, FOUND][1]
        light = replace(light, found=at_vertices.found, fitted=at_vertices.fitted)
    if (id_, WITH) not in known:
        return light
    with_all, without = known[id_, WITH][1], known[id_, WITHOUT][1]
    return replace(
        light,
        bounced=light.bounced + (with_all.bounced - without.bounced),
        direct=light.direct + (with_all.direct - without.direct),
    )


def _is_of(known: KnownLight, moved: tuple[object, ...], part: _Part) -> bool:
    """Return whether light is that of these changes, and of this part."""
    of_changes, of_quality, of_places = known[0]
    # The same objects, as a rule: to compare what is in them takes a hundred times as long.
    return (
        of_quality is part.quality
        and (of_places is part.around or of_places == part.around)
        and of_changes == moved
    )


def _chosen(things: list[PlacedObject]) -> list[int]:
    """Return the places of those that get light of their own."""
    chosen, moving = [], 0
    for place, thing in enumerate(things):
        moving += thing.moves
        if moving <= MOST_MOVING or not thing.moves:
            chosen.append(place)
    return chosen

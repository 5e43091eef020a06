"""Keeps the baked light of a running scene right. From each `WorldSnapshot` to one that is lit.

What was baked and moves, goes or comes changes the light in the frame that shows it first, roughly;
once everything stands still it is computed with more rays, on a thread of its own or, where time
stands still between frames, within a frame. What can move gets the light of its place
(`object_lights.py`). Nothing is changed in the world: its bake stays.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_rows import BakedRows, baked_rows, has_shape_of
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.object_lights import ObjectLights, can_be_lit
from sailenv_ros.light.relight.quality import FINE, QUICK, Quality
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.native.library import thread_count
from sailenv_ros.types.baked_light import BakedLight, ObjectLight
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["READY_FRAMES", "Relighter"]

_log = logging.getLogger(__name__)

REST_NS = 500_000_000
"""Simulated time for which everything must stand still before light is refined within a frame."""

STILL_NS, STILL_FRAMES = 250_000_000, 5
"""Time, or number of frames, after which an object that moved twice is at rest again, in real
time."""

READY_FRAMES = 3
"""Number of rendered frames after which a lockstep scene is prepared for moves; a program that
renders fewer does not pay for it."""

_Key = tuple[tuple[int, bytes | None, object], ...]


@dataclass(eq=False, slots=True)
class _Relit:
    """Light for one set of changes."""

    key: _Key
    light: BakedLight
    refined: bool
    since_ns: int


@dataclass(eq=False, slots=True)
class _Place:
    """Last known place of an object."""

    pose: bytes
    moved_ns: int
    frames: int = 0
    in_motion: bool = False

    def follow(self, pose: bytes, now_ns: int) -> None:
        """Take in where it is now: what moves twice in a row is in motion until it rests."""
        recent = self.frames < STILL_FRAMES and 0 <= now_ns - self.moved_ns < STILL_NS
        if pose != self.pose:
            self.pose, self.moved_ns, self.frames, self.in_motion = pose, now_ns, 0, recent
            return
        self.frames += 1
        self.in_motion = self.in_motion and recent


class Relighter:
    """Follows one simulation; used by one thread.

    Attributes
    ----------
    beforehand : bool
        True prepares a scene for moves on a thread of its own, so that the first one finds
        everything ready; False when something moves first, if anything does. Light is the same.
    """

    def __init__(self) -> None:
        self.beforehand = True
        self._pool: ThreadPoolExecutor | None = None
        self._refining: tuple[_Key, Future[BakedLight]] | None = None
        self._preparing: Future[BakedScene] | None = None
        self._rendered = 0
        self._original: SceneContents | None = None
        self._scene: BakedScene | None = None
        self._places: dict[int, _Place] = {}
        self._of: BakedRows | None = None
        self._light: _Relit | None = None
        self._seen: WorldSnapshot | None = None
        self._changes: list[Change] = []
        self._painted: dict[int, Model] = {}
        self._objects = ObjectLights()
        self._object_light: Mapping[int, ObjectLight] = {}
        self._contents: tuple[SceneContents, BakedLight, SceneContents] | None = None

    def watch(self, snapshot: WorldSnapshot) -> None:
        """Take a scene's bake to heart, before anything moves or goes."""
        contents = snapshot.contents
        baked = contents.baked
        if baked is None:
            self._original = None
        elif (
            self._original is None
            or self._original.baked is None
            or (self._original.baked.layers is not baked.layers)
        ):
            self._original = contents
        else:
            return
        self._scene, self._light, self._seen, self._of = None, None, None, None
        self._places, self._refining, self._changes, self._painted = {}, None, [], {}
        self._preparing, self._rendered = None, 0
        self._objects, self._object_light = ObjectLights(), {}

    def lit(
        self,
        snapshot: WorldSnapshot,
        *,
        wanted: bool,
        lockstep: bool,
        changed_ns: int | None = None,
    ) -> WorldSnapshot:
        """Return the same instant with the light that belongs to it.

        Parameters
        ----------
        snapshot : WorldSnapshot
            As the world has it, with the light that was baked.
        wanted : bool
            False if no picture is made: light that is out of date will do.
        lockstep : bool
            True refines light within a frame, so that frames do not depend on the wall clock.
        changed_ns : int or None
            When what stands still changed last [ns]: in lockstep light then depends on the world
            alone, not on which frames were rendered. None takes the frame that shows it first.
        """
        self.watch(snapshot)
        if self._original is None:
            return snapshot
        if wanted:
            self._rendered += 1
            # Never beside the first frame, which somebody waits for.
            soon = self._rendered > (READY_FRAMES if lockstep else 1)
            if self.beforehand and soon and self._scene is None and self._preparing is None:
                # Beside the frames, so that the first move finds everything ready.
                self._preparing = self._background().submit(
                    _ready_scene, self._original, snapshot, self._objects
                )
            self._bring_up_to_date(snapshot, lockstep=lockstep, changed_ns=changed_ns)
            self._object_light = self._light_on_objects(snapshot, lockstep=lockstep)
        if self._object_light:
            snapshot = replace(snapshot, object_light=self._object_light)
        if self._light is None:
            return snapshot
        contents, light = snapshot.contents, self._light.light
        if self._contents is None or self._contents[:2] != (contents, light):
            environment = None if contents.baked is None else contents.baked.environment
            lit = replace(contents, baked=replace(light, environment=environment))
            self._contents = contents, light, lit
        return replace(snapshot, contents=self._contents[2])

    def close(self) -> None:
        """Wait for what is being computed; a second call does nothing."""
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None

    # -- inside --------------------------------------------------------------------------------

    def _bring_up_to_date(
        self, snapshot: WorldSnapshot, *, lockstep: bool, changed_ns: int | None
    ) -> None:
        if snapshot is not self._seen:
            self._changes = self._changed(snapshot, lockstep=lockstep)
            self._seen = snapshot
        key = _key_of(self._changes, self._painted)
        if not key:
            self._light = None
            return
        if self._light is None or self._light.key != key:
            since_ns = snapshot.sim_time_ns if changed_ns is None else changed_ns
            rested = lockstep and snapshot.sim_time_ns - since_ns >= REST_NS
            light = self._relit(FINE if rested else QUICK)
            self._light = _Relit(key, light, refined=rested, since_ns=since_ns)
        elif not self._light.refined:
            self._refine(self._light, snapshot, lockstep=lockstep)

    def _light_on_objects(
        self, snapshot: WorldSnapshot, *, lockstep: bool
    ) -> Mapping[int, ObjectLight]:
        """Return the light on what can move; in real time nothing waits for the scene's rays."""
        preparing = self._preparing is not None and not self._preparing.done()
        unprepared = self._scene is None and (self._preparing is None or preparing)
        if (unprepared and not lockstep) or not any(map(can_be_lit, snapshot.contents.instances)):
            return {}
        scene, threads = self._prepared(), thread_count()
        return self._objects.update(snapshot, scene, self._changes, threads=threads)

    def _refine(self, shown: _Relit, snapshot: WorldSnapshot, *, lockstep: bool) -> None:
        if lockstep:
            if snapshot.sim_time_ns - shown.since_ns >= REST_NS:
                shown.light, shown.refined = self._relit(FINE), True
            return
        if self._refining is not None:
            key, future = self._refining
            if not future.done():
                return
            self._refining = None
            if key == shown.key:
                shown.light, shown.refined = future.result(), True
                return
        # One thread: the others draw meanwhile.
        future = self._background().submit(
            relit, self._prepared(), self._changes, FINE, threads=1, painted=self._painted
        )
        self._refining = shown.key, future

    def _relit(self, quality: Quality) -> BakedLight:
        return relit(
            self._prepared(),
            self._changes,
            quality,
            threads=thread_count(),
            painted=self._painted,
        )

    def _background(self) -> ThreadPoolExecutor:
        if self._pool is None:
            self._pool = ThreadPoolExecutor(1, "relighting")
        return self._pool

    def _prepared(self) -> BakedScene:
        if self._scene is None:
            assert self._original is not None
            if self._preparing is None:
                self._scene = _scene_of(self._original, thread_count())
            else:
                self._scene = self._preparing.result()
                self._preparing = None
        return self._scene

    def _changed(self, snapshot: WorldSnapshot, *, lockstep: bool) -> list[Change]:
        """Return what stands elsewhere than when the light was baked."""
        original, contents = self._original, snapshot.contents
        assert original is not None
        assert original.baked is not None
        if self._of is None or self._of.contents is not contents:
            self._of = baked_rows(original, contents)
            self._painted = self._repainted(contents)
        of = self._of
        changes: list[Change] = []
        places: dict[int, _Place] = {}
        # NaN is like nothing: what was not baked is among them.
        moved = (snapshot.world_from_body[of.rows] != of.poses).any(axis=(1, 2))
        for place_of in np.flatnonzero(moved).tolist():
            row, id_ = int(of.rows[place_of]), of.ids[place_of]
            pose = snapshot.world_from_body[row]
            came = None
            before: NDArray[np.float64] | None = of.poses[place_of]
            if np.isnan(of.poses[place_of, 0, 0]):
                drawn = contents.instances[row]
                came, before = (drawn.model, drawn.scale), None
            name, now_ns = pose.tobytes(), snapshot.sim_time_ns
            place = places[id_] = self._places.get(id_) or _Place(name, now_ns)
            place.follow(name, now_ns)
            # In real time, what moves on is lit as things are that can move: at no cost.
            after = None if place.in_motion and not lockstep else pose
            if before is not None or after is not None:
                changes.append(Change(id=id_, before=before, after=after, came=came))
        self._places = places
        changes += of.gone
        charts = original.baked.charts
        for change in [c for c in changes if c.came is not None and c.id in charts]:
            # Another model or size in the place of what was baked.
            gone = Change(id=change.id, before=charts[change.id].world_from_body, after=None)
            changes.append(gone)
        return changes

    def _repainted(self, contents: SceneContents) -> dict[int, Model]:
        """Return the models of what was baked and is of other materials now."""
        assert self._original is not None
        assert self._original.baked is not None
        charts = self._original.baked.charts
        known = {drawn.instance.id: drawn for drawn in self._original.instances}
        return {
            drawn.instance.id: drawn.model
            for drawn in contents.instances
            if drawn.instance.id in charts
            and drawn.model is not known[drawn.instance.id].model
            and has_shape_of(drawn, known[drawn.instance.id])
        }


def _scene_of(contents: SceneContents, threads: int) -> BakedScene:
    assert contents.baked is not None
    return BakedScene(contents.baked, contents, threads)


def _ready_scene(
    contents: SceneContents, snapshot: WorldSnapshot, objects: ObjectLights
) -> BakedScene:
    """Make a scene ready, and the light on what can move in it, which no frame waits for."""
    scene = _scene_of(contents, 1)
    objects.update(snapshot, scene, (), threads=1)
    return scene


def _key_of(changes: list[Change], painted: dict[int, Model]) -> _Key:
    """Return what tells sets of changes apart; it keeps the models, which are told by identity."""
    looks = tuple((id_, None, model) for id_, model in painted.items())
    return looks + tuple(change.key for change in changes)

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

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.baked_scene_store import BakedSceneStore
from sailenv_ros.light.relight.change_follower import ChangeFollower
from sailenv_ros.light.relight.movable_objects import can_be_lit
from sailenv_ros.light.relight.object_lights import ObjectLights
from sailenv_ros.light.relight.preparation import Preparation
from sailenv_ros.light.relight.quality import FINE, QUICK, Quality
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.light.relight.shown_shadows import ShownShadows
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.baked_light import BakedLight, ObjectLight
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import REST_S, SceneContents, WorldSnapshot

__all__ = ["READY_FRAMES", "Relighter"]

_log = logging.getLogger(__name__)

REST_NS = round(REST_S * 1e9)
"""Simulated time for which everything must stand still before light is refined within a frame."""

READY_FRAMES = 3
"""Number of rendered frames after which a lockstep scene is prepared for moves; a program that
renders fewer does not pay for it."""

_Shown = tuple[object, ...]
"""Key of shadows: the light, changes, and places of objects that rest."""

_Key = tuple[tuple[int, bytes | None, object], ...]


@dataclass(eq=False, slots=True)
class _Relit:
    """Light for one set of changes."""

    key: _Key
    light: BakedLight
    refined: bool
    since_ns: int


class Relighter:
    """Follows one simulation; used by one thread.

    Parameters
    ----------
    scenes : BakedSceneStore or None
        That outlives this; None for its own.

    Attributes
    ----------
    beforehand : bool
        True prepares a scene for moves on a thread of its own, so that the first one finds
        everything ready; False when something moves first, if anything does. Light is the same.
    """

    def __init__(self, scenes: BakedSceneStore | None = None) -> None:
        self._scenes = BakedSceneStore() if scenes is None else scenes
        self.beforehand = True
        self._pool: ThreadPoolExecutor | None = None
        self._refining: tuple[_Key, Future[BakedLight]] | None = None
        self._preparing: Preparation | None = None
        self._rendered = 0
        self._original: SceneContents | None = None
        self._scene: BakedScene | None = None
        self._follower: ChangeFollower | None = None
        self._light: _Relit | None = None
        self._seen: WorldSnapshot | None = None
        self._changes: list[Change] = []
        self._painted: dict[int, Model] = {}
        self._objects = ObjectLights()
        self._object_light: Mapping[int, ObjectLight] = {}
        self._shadows: ShownShadows | None = None
        self._shading: tuple[_Shown, Future[BakedLight]] | None = None
        self._shaded: tuple[_Shown, BakedLight] | None = None
        self._base: tuple[BakedLight, BakedLight] | None = None
        self._contents: tuple[SceneContents, SceneContents] | None = None

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
        self._scenes.forget_others(contents)
        self._scene, self._light, self._seen, self._refining = None, None, None, None
        self._changes, self._painted = [], {}
        self._follower = None if self._original is None else ChangeFollower(self._original)
        self._abandon()
        self._rendered = 0
        self._objects, self._object_light = ObjectLights(), {}
        self._shadows, self._shading, self._shaded = None, None, None

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
                self._preparing = Preparation(
                    self._background(), self._scenes, self._original, snapshot, self._objects
                )
            self._bring_up_to_date(snapshot, lockstep=lockstep, changed_ns=changed_ns)
            self._object_light = self._light_on_objects(snapshot, lockstep=lockstep)
        contents = snapshot.contents
        assert contents.baked is not None
        known = self._contents is not None and self._contents[0] is contents
        if wanted or not known:
            shown = self._without_shadows(contents.baked, lockstep=lockstep)
            if wanted and self._object_light:
                shown = self._with_shadows(shown, lockstep=lockstep)
            self._show(contents, shown)
        assert self._contents is not None
        if self._object_light:
            snapshot = replace(snapshot, object_light=self._object_light)
        lit = self._contents[1]
        return snapshot if lit is contents else replace(snapshot, contents=lit)

    def close(self) -> None:
        """Wait for what is being computed; a second call does nothing."""
        self._abandon()
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None

    # -- inside --------------------------------------------------------------------------------

    def _bring_up_to_date(
        self, snapshot: WorldSnapshot, *, lockstep: bool, changed_ns: int | None
    ) -> None:
        if snapshot is not self._seen:
            assert self._follower is not None
            self._changes = self._follower.changes(snapshot, lockstep=lockstep)
            self._painted = self._follower.painted
            self._seen = snapshot
        key = _key_of(self._changes, self._painted)
        if not key:
            self._light = None
            return
        now_ns, shown = snapshot.sim_time_ns, self._light
        since_ns = changed_ns
        if since_ns is None:
            since_ns = now_ns if shown is None or shown.key != key else shown.since_ns
        rested = lockstep and now_ns - since_ns >= REST_NS
        if shown is None or shown.key != key or (lockstep and shown.refined and not rested):
            # The last is for what has moved and is back where it was.
            light = self._relit(FINE if rested else QUICK)
            self._light = _Relit(key, light, refined=rested, since_ns=since_ns)
            return
        shown.since_ns = since_ns
        if not shown.refined:
            self._refine(shown, snapshot, lockstep=lockstep)

    def _light_on_objects(
        self, snapshot: WorldSnapshot, *, lockstep: bool
    ) -> Mapping[int, ObjectLight]:
        """Return the light on what can move; in real time nothing waits for the scene's rays."""
        preparing = self._preparing is not None and not self._preparing.done()
        unprepared = self._scene is None and (self._preparing is None or preparing)
        if (unprepared and not lockstep) or not any(map(can_be_lit, snapshot.contents.instances)):
            return {}
        scene, threads = self._prepared(), thread_count()
        rough = self._light is not None and not self._light.refined
        return self._objects.update(snapshot, scene, self._changes, rough=rough, threads=threads)

    def _show(self, contents: SceneContents, light: BakedLight) -> None:
        """Have contents of the world shown in a light; the same object while it is the same."""
        if self._contents is None or self._contents[0] is not contents:
            self._contents = contents, contents
        if self._contents[1].baked is not light:
            lit = contents if light is contents.baked else replace(contents, baked=light)
            self._contents = contents, lit

    def _without_shadows(self, baked: BakedLight, *, lockstep: bool) -> BakedLight:
        """Return the light of what stands still, as it stands; `baked` is as the world has it."""
        if self._light is None:
            return baked
        light = self._light.light
        # In lockstep no picture depends on those before it.
        rough = not lockstep and not self._light.refined
        known = self._base
        if known is None or known[0] is not light or known[1].environment is not baked.environment:
            shown = replace(light, environment=baked.environment, rough=rough)
            self._base = known = light, shown
        return known[1]

    def _with_shadows(self, light: BakedLight, *, lockstep: bool) -> BakedLight:
        """Return light with the shadows of what rests; in real time those found last."""
        shadows = self._shadows
        assert shadows is not None
        if self._light is not None and not self._light.refined:
            # Until then the picture darkens what is near.
            return light
        rest = [thing for thing in self._objects.things if not thing.moves]
        if lockstep:
            return shadows.on(light, rest, self._changes, threads=thread_count())
        if self._shading is not None and self._shading[1].done():
            self._shaded = self._shading[0], self._shading[1].result()
            self._shading = None
        key = light, *(change.key for change in self._changes), *(thing.place for thing in rest)
        if self._shaded is not None and self._shaded[0] == key:
            return self._shaded[1]
        if self._shading is None:
            future = self._background().submit(shadows.on, light, rest, self._changes, threads=1)
            self._shading = key, future
        same = self._shaded is not None and self._shaded[0][0] is light
        return self._shaded[1] if same and self._shaded is not None else light

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

    def _abandon(self) -> None:
        if self._preparing is not None:
            self._preparing.abandon()
        self._preparing = None

    def _background(self) -> ThreadPoolExecutor:
        if self._pool is None:
            self._pool = ThreadPoolExecutor(1, "relighting")
        return self._pool

    def _prepared(self) -> BakedScene:
        if self._scene is None:
            assert self._original is not None
            if self._preparing is None:
                self._scene = self._scenes.scene_of(self._original, thread_count())
                self._shadows = ShownShadows(self._scene, self._objects.points)
            else:
                self._scene, self._shadows = self._preparing.result()
                self._preparing = None
        return self._scene


def _key_of(changes: list[Change], painted: dict[int, Model]) -> _Key:
    """Return what tells sets of changes apart; it keeps the models, which are told by identity."""
    looks = tuple((id_, None, model) for id_, model in painted.items())
    return looks + tuple(change.key for change in changes)

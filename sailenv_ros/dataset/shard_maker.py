"""Shards → files: builds the scenes, puts the cameras, takes the frames. One process each.

What comes out depends on the job and on the shard's number alone.
"""

from __future__ import annotations

import os
import platform
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.authoring.room_rules.names import PREFIX
from sailenv_ros.dataset.camera_tracks import Track, place_cameras, track_of, turning
from sailenv_ros.dataset.findings import Findings
from sailenv_ros.dataset.frame_sink import FrameSink
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.manifest import ShardSummary, summaries_of_files
from sailenv_ros.dataset.recipe_cameras import AgentCamera, AnyCamera, MountedCamera, RuleCamera
from sailenv_ros.dataset.recipe_choices import AGENT_PREFIX, choices_of, fitting_things
from sailenv_ros.dataset.rule_views import aims_at_movers, present_names, rule_views
from sailenv_ros.dataset.scene_names import SceneNames
from sailenv_ros.dataset.shard_plan import Clip, SceneSource, ShardPlan, clip_groups
from sailenv_ros.dataset.shard_writer import ShardWriter
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.errors import NoFreeSpace, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language.scene_facts import SceneFacts
from sailenv_ros.render.cpu.mesh_store import MeshStore
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.cpu.texture_store import TextureStore
from sailenv_ros.render.scene.reflection_store import ReflectionStore
from sailenv_ros.render.scene.room_reflections import Share
from sailenv_ros.simulation.finished_light import bake_missing
from sailenv_ros.simulation.scene_facts import scene_facts
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.space.free_space import named_generator
from sailenv_ros.system.temporary_folders import temporary_folder
from sailenv_ros.types.agents import AgentSpec, due_steps
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rigid_body import STEPS_PER_SECOND
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["ShardMaker"]


class ShardMaker:
    """Makes shards of one job, one after another; a context manager.

    Parameters
    ----------
    job : Job
    storage : Storage or None
        None for who takes frames alone, see `take`.
    on_frame : callable
        Called after each frame.
    scratch : Path or None
        Folder for temporary files; None takes the system's.
    """

    def __init__(
        self,
        job: Job,
        storage: Storage | None,
        on_frame: Callable[[], None] = lambda: None,
        *,
        scratch: Path | None = None,
    ) -> None:
        self._job = job
        self._recipe = job.recipe
        self._plan = ShardPlan(job.recipe)
        self._store = None if storage is None else ResumableStore(storage, job.identity)
        self._on_frame = on_frame
        self._due = due_steps(job.recipe.clip.rate, job.recipe.clip.frames)
        self._camera_data = [one.model_dump(mode="json") for one in self._recipe.cameras]
        self._findings = Findings()
        self._info: tuple[SceneInfo | None, SceneInfo | None] = (None, None)
        # What is drawn of furniture serves all scenes that have it, and what a room mirrors all
        # that are equal to it. Other light does not: it may depend on what was seen before.
        self._stores = MeshStore(), TextureStore()
        self._reflections: ReflectionStore[Share] = ReflectionStore()
        self._temporary = ExitStack()
        self._folder = self._temporary.enter_context(
            temporary_folder("sailenv-scenes-", place=scratch)
        )
        self._baked = self._recipe.light == "baked"
        self._library = SceneLibrary(baked_light=self._baked, drafts=False)
        self._paths = {
            name: self._written(f"{number}/{Path(name).name}", text)
            for number, (name, text) in enumerate(job.scene_texts.items())
        }

    def close(self) -> None:
        """Remove what was kept for the shards."""
        self._temporary.close()

    def __enter__(self) -> ShardMaker:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def make(self, number: int) -> ShardSummary:
        """Make a shard and put it into the data set; its summary is written last.

        Raises
        ------
        SailenvError
            If a scene cannot be built or a file not be written.
        """
        assert self._store is not None
        with self._store.part(self._folder) as part:
            summary = self.make_into(number, part.folder)
            part.note = summary.path, summary.to_json()
        return summary

    def make_into(self, number: int, folder: Path) -> ShardSummary:
        """Make a shard in an empty folder."""
        began = time.monotonic()
        shard = self._plan.shard(number)
        writer = ShardWriter(folder, self._recipe, shard)
        self._findings = Findings()
        try:
            frames, skipped = self.take(number, writer)
            writer.finish()
        except BaseException:
            writer.close()
            raise
        return ShardSummary(
            shard=number,
            split=shard.split,
            first_clip=shard.clips[0].number,
            clips=len(shard.clips),
            frames=frames,
            files=summaries_of_files(folder),
            written={name: dict(one) for name, one in writer.written.items()},
            left_out={name: dict(one) for name, one in writer.left_out.items()},
            skipped=dict(skipped),
            findings=self._findings.plain(),
            made={
                "machine": platform.machine(),
                "processors": os.cpu_count(),
                "seconds": round(time.monotonic() - began, 3),
            },
        )

    def take(self, number: int, sink: FrameSink) -> tuple[int, Counter[str]]:
        """Hand all frames of a shard on; return how many, and the clips that could not be made."""
        frames, skipped = 0, Counter[str]()
        for group in clip_groups(self._plan.shard(number), self._recipe.clip.per_scene):
            frames += self._take(group, sink, skipped)
        return frames, skipped

    # -- one scene ---------------------------------------------------------------------------

    def _take(self, group: tuple[Clip, ...], writer: FrameSink, skipped: Counter[str]) -> int:
        """Take all clips of a group from its scene; return how many frames they have."""
        recipe = self._recipe
        frames = 0
        with self._scene(group[0]) as core:
            if recipe.clip.settle:
                core.step(round(recipe.clip.settle * STEPS_PER_SECOND))
            names = present_names(core, self._library)
            self._note_missed_targets(names, group[0].scene)
            ruled = [one for one in recipe.cameras if isinstance(one, RuleCamera)]
            late = [one for one in ruled if aims_at_movers(one, core, names)]
            chosen = {
                one.name: rule_views(one, group, core, names, recipe.seed)
                for one in ruled
                if one not in late
            }
            for clip in group:
                if clip is not group[0]:
                    core.step(round(recipe.clip.gap * STEPS_PER_SECOND) or 1)
                for one in late:
                    chosen[one.name] = rule_views(one, (clip,), core, names, recipe.seed)
                try:
                    tracks = {
                        one.name: self._track(one, clip, core, chosen.get(one.name, []))
                        for one in recipe.cameras
                    }
                except NoFreeSpace as problem:
                    skipped[f"{clip.scene}: {problem}"] += 1
                    continue
                writer.begin_clip(clip)
                frames += self._take_clip(clip.scene, tracks, core, writer)
                writer.end_clip()
        return frames

    def _take_clip(
        self,
        scene: SceneSource,
        tracks: dict[str, Track | None],
        core: SynchronousSimulation,
        writer: FrameSink,
    ) -> int:
        recipe = self._recipe
        for camera in recipe.cameras:
            core.register_agent(self._agent(camera, core))
        frames = 0
        for number, step in enumerate(self._due):
            if number:
                core.step(step - self._due[number - 1])
            place_cameras(recipe.cameras, tracks, number, core)
            facts = scene_facts(core) if recipe.needs_facts else None
            for camera in recipe.cameras:
                frame = core.capture(recipe.views, agent=_agent_name(camera))
                self._findings.look_at(frame, scene)
                writer.add(camera.name, self._kept(frame, camera, facts))
                frames += 1
                self._on_frame()
        for camera in recipe.cameras:
            core.delete_agent(_agent_name(camera))
        return frames

    def _kept(self, frame: Frame, camera: AnyCamera, facts: SceneFacts | None) -> Frame:
        """Return a frame as the formats get it: without what depends on machine and moment."""
        assert frame.info is not None
        if frame.info is not self._info[0]:
            told = replace(frame.info, renderer="native renderer", scenes=(frame.info.scene,))
            self._info = frame.info, told
        changes: dict[str, Any] = {"agent": camera.name, "timings_s": {}, "info": self._info[1]}
        changes["facts"] = facts
        if not self._recipe.amodal:
            changes["draw_amodal"] = None
        return replace(frame, **changes)

    def _track(
        self, camera: AnyCamera, clip: Clip, core: SynchronousSimulation, chosen: list[Pose]
    ) -> Track | None:
        """Return a camera's poses in a clip; None if an agent's mover or another camera has it."""
        if isinstance(camera, AgentCamera | MountedCamera):
            return None
        times_s = np.array(self._due) / STEPS_PER_SECOND
        random = named_generator(self._recipe.seed, "camera", camera.name, str(clip.number))
        if not isinstance(camera, RuleCamera):
            return track_of(camera, core, times_s, random)
        if not chosen:
            raise NoFreeSpace(f"no more places for the camera {camera.name} by {camera.rule}")
        return turning(chosen.pop(0), camera, times_s, random)

    def _agent(self, camera: AnyCamera, core: SynchronousSimulation) -> AgentSpec:
        spec = AgentSpec(
            name=_agent_name(camera),
            intrinsics=camera.intrinsics,
            rate_hz=0.0,
            views=self._recipe.views,
            following=False,
            picture=camera.picture.to_settings(),
        )
        if not isinstance(camera, AgentCamera):
            return spec
        brought = {one.name: one for one in core.library.agents_of(core.world.scene)}
        if camera.agent is None and not brought:
            return replace(spec, following=True)  # where the scene's first mover goes
        name = camera.agent or next(iter(brought))
        if name not in brought:
            raise UnknownName("agent", name, brought)
        own = brought[name]
        return replace(
            spec, following=own.following, mover=own.mover, pose=own.pose, look_at=own.look_at
        )

    @contextmanager
    def _scene(self, first: Clip) -> Iterator[SynchronousSimulation]:
        """Yield a scene that has just begun."""
        random = named_generator(self._recipe.seed, "scene", str(first.number))
        core = SynchronousSimulation(
            self._library,
            self._path(first.scene),
            NativeRenderer(table=PartTable(*self._stores), reflections=self._reflections),
            mode="lockstep",
            real_time_factor=1.0,
            seed=int(random.integers(2**31)),
            paused=False,
        )
        try:
            if self._baked:
                bake_missing(core.world)
            if self._recipe.randomise:
                seed = int(random.integers(2**31))
                names = present_names(core, self._library)
                things, missed = fitting_things(self._recipe, names)
                for label in missed:
                    self._findings.add(f"nothing was met by `{label}`", first.scene)
                if things:
                    record = core.randomise(seed, index=0, things=things)
                    for name in record["epoch"].get("left_out", ()):
                        self._findings.add(f"no place upon the floor for `{name}`", first.scene)
            yield core
        finally:
            core.close()

    def _note_missed_targets(self, names: SceneNames, scene: SceneSource) -> None:
        for choice in choices_of({"cameras": self._camera_data}):
            if not choice.meets(names):
                self._findings.add(f"nothing was met by `{choice.label}`", scene)

    def _path(self, scene: SceneSource) -> Path:
        """Return the file of a scene; a generated one is made now."""
        if scene.seed is None:
            return self._paths.get(scene.name) or self._library.path(scene.name)
        return self._library.path(f"{PREFIX}{scene.name}:{scene.seed}")

    def _written(self, name: str, text: str) -> Path:
        path = self._folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path


def _agent_name(camera: AnyCamera) -> str:
    """Return the name of a camera's agent, which no agent of a scene has."""
    return f"{AGENT_PREFIX}{camera.name}"

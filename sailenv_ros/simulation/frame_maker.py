"""Frames of one simulation: its world through a camera, drawn by its renderer.

Knows neither when a frame is due nor who gets it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.data import DrawAmodal
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.light.relight.relighter import Relighter
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.picture.auto_exposure import with_exposure
from sailenv_ros.simulation.agent_record import AgentRecord
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.simulation.shutter import exposed
from sailenv_ros.system.memory import give_back_freed_memory
from sailenv_ros.types.camera import MIN_SIZE_PX, Camera, CameraIntrinsics
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.types.views import LIT_VIEWS

if TYPE_CHECKING:
    from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer

__all__ = ["FrameMaker"]

_SMALL = CameraIntrinsics(width=MIN_SIZE_PX, height=MIN_SIZE_PX)

GIVES_BACK = 2
"""Frame before which memory is given back that the start left free, 100 to 280 MB of a furnished
room: not before the first one, which somebody waits for; `prepare` does so for later scenes."""


class FrameMaker:
    """Draws the present scene.

    Parameters
    ----------
    scene : LiveScene
    renderer : RenderBackend
        Owned from now on; closed with this.
    lockstep : bool
        True has light computed at once, whatever time that takes.

    Attributes
    ----------
    run_later : callable
        Runs a function in the thread that this belongs to, and returns its result: for frames
        whose objects are drawn alone when somebody asks for it.
    """

    def __init__(self, scene: LiveScene, renderer: RenderBackend, *, lockstep: bool) -> None:
        self.run_later: Callable[[Callable[[], AmodalMasks]], AmodalMasks] = lambda draw: draw()
        self._scene = scene
        self._renderer = renderer
        self._lockstep = lockstep
        self._amodal: AmodalRenderer | None = None
        self._relighter = Relighter(scene.library.baked_scenes)
        self._made = 0
        self._closed = False
        self.watch_light()

    def work_alone(self) -> None:
        """Do nothing beside the caller's thread, nor ahead of what it asks for.

        Light for moves is prepared by the first one, and a scene is drawn for its first frame: much
        of it may change before, and would be in memory twice.
        """
        self._relighter.beforehand = False

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that the renderer can make, in the order of `frame.VIEWS`."""
        return self._renderer.supported_views

    @property
    def description(self) -> str:
        """The renderer in words."""
        return self._renderer.description

    def watch_light(self) -> None:
        """Take up the light of the present world, which is another one or was baked again."""
        self._is_new = True
        self._relighter.watch(self._scene.world.snapshot())

    def frames(
        self,
        wanted: Sequence[tuple[AgentRecord, tuple[str, ...]]],
        *,
        began_s: float,
        info: SceneInfo,
        randomised: Mapping[str, Any] | None,
        lesson: LessonState | None,
    ) -> list[Frame]:
        """Render one frame of each of some agents now.

        Parameters
        ----------
        wanted : sequence of (AgentRecord, tuple of str)
            Whose frames, and their views: of those that the renderer can make.
        began_s : float
            When their making began, by `time.perf_counter` [s].
        info : SceneInfo
            What clients find the frames' ids in.
        randomised : mapping or None
            What was drawn at random for them.
        lesson : LessonState or None
        """
        before, self._made = self._made, self._made + len(wanted)
        if before < GIVES_BACK <= self._made:
            give_back_freed_memory()
        world = self._scene.world
        lit = any(not LIT_VIEWS.isdisjoint(views) for _, views in wanted)
        snapshot = self._lit(world.snapshot(), wanted=lit)
        exposures = [
            exposed(record, snapshot, self._scene.agents.camera(record, world), world)
            for record, _ in wanted
        ]
        requests = [
            RenderRequest(
                snapshot=exposure.observed.snapshot,
                previous=record.past(exposure.observed.snapshot.sim_time_ns),
                camera=exposure.observed.camera,
                views=views,
                rows=exposure.observed.rows,
                samples=exposure.samples,
            )
            for (record, views), exposure in zip(wanted, exposures, strict=True)
        ]
        made = self._renderer.render_all(requests)
        frames = []
        for (record, _), exposure, request, rendered in zip(
            wanted, exposures, requests, made, strict=True
        ):
            camera, now, past = request.camera, request.snapshot, request.previous
            observed = exposure.observed
            record.remember(replace(observed, depth=rendered.depth, adapted=rendered.adapted))
            record.sequence += 1
            frames.append(
                Frame(
                    agent=record.spec.name,
                    scene=info.scene,
                    epoch=info.epoch,
                    revision=info.revision,
                    sequence=record.sequence,
                    stamp_ns=now.sim_time_ns,
                    dt_ns=0 if past is None else now.sim_time_ns - past.snapshot.sim_time_ns,
                    camera=camera,
                    depth_range_m=record.spec.depth_range_m,
                    views=rendered.views,
                    timings_s={**rendered.timings_s, "render": time.perf_counter() - began_s},
                    info=info,
                    states=exposure.states,
                    row_poses=request.rows,
                    randomised=randomised,
                    lesson=lesson,
                    exposure=with_exposure(camera, rendered.adapted).picture.exposure,
                    draw_amodal=self._draws_alone(None if request.rows else now, camera),
                )
            )
        return frames

    def _draws_alone(self, snapshot: WorldSnapshot | None, camera: Camera) -> DrawAmodal:
        return lambda only=0: self.run_later(lambda: self.draw_amodal(snapshot, camera, only))

    def _lit(self, snapshot: WorldSnapshot, *, wanted: bool) -> WorldSnapshot:
        """Return the present instant in its light, and make the renderer ready meanwhile."""
        light = partial(
            self._relighter.lit,
            snapshot,
            wanted=wanted,
            lockstep=self._lockstep,
            changed_ns=self._scene.world.changed_ns,
        )
        if not (self._is_new and wanted and self._relighter.beforehand):
            return light()
        self._is_new = False
        with ThreadPoolExecutor(1, "preload") as beside:
            ready = beside.submit(self._renderer.preload, snapshot.contents)
            lit = light()
            ready.result()
        return lit

    def look(self, camera: Camera, *views: str) -> Mapping[str, NDArray[Any]]:
        """Render views of the scene as it stands now, through a camera that is no agent's."""
        return self._renderer.render(
            RenderRequest(self._scene.world.snapshot(), camera, views)
        ).views

    def prepare(self, known: str) -> None:
        """Have the renderer take up the present scene, unless it is the known one.

        Its first picture needs meshes, textures and mirrored surroundings, which take a second or
        more: in the request that changes the scene, not in the deadline of a first frame.
        """
        if self._scene.world.scene == known:
            return
        specs = self._scene.agents.specs
        # Else there is nobody to be drawn for, or nothing is done ahead.
        if specs and self._relighter.beforehand:
            lit = any(not LIT_VIEWS.isdisjoint(spec.views) for spec in specs)
            views = ("rgb",) if lit else ("depth",)
            self.look(Camera(intrinsics=_SMALL), *views)
        give_back_freed_memory()  # what the scene of before had

    def draw_amodal(
        self, snapshot: WorldSnapshot | None, camera: Camera, only: int = 0
    ) -> AmodalMasks:
        """Draw each object of a snapshot alone, whatever is seen of it; or only the one of that id.

        Parameters
        ----------
        snapshot : WorldSnapshot or None
            None where there are several: rows of a rolling shutter.
        camera : Camera
        only : int

        Raises
        ------
        InvalidState
            Without a snapshot.
        NativeLibraryError
            If there is no native library, which draws them.
        """
        if snapshot is None:
            raise InvalidState(
                "objects of a rolling shutter are not drawn alone; with row_time_us 0 they are"
            )
        # The renderers are what takes longest to import.
        from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer

        if self._closed:  # whoever keeps a frame may ask later
            with closing(AmodalRenderer()) as alone:
                return alone.draw(snapshot, camera, only)
        if self._amodal is None:
            from sailenv_ros.render.cpu.renderer import NativeRenderer

            renderer = self._renderer
            table = renderer.part_table if isinstance(renderer, NativeRenderer) else None
            self._amodal = AmodalRenderer(table)
        return self._amodal.draw(snapshot, camera, only)

    def close(self) -> None:
        """Free the renderer."""
        self._closed = True
        self._relighter.close()
        if self._amodal is not None:
            self._amodal.close()
        self._renderer.close()

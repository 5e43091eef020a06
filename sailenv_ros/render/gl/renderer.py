"""The OpenGL renderer: which passes run, in which order, and what is read back.

A snapshot, a camera and names of views come in, arrays go out. Passes that no wanted view needs
do not run.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderedViews, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.context import create_context
from sailenv_ros.render.gl.draw_list import DrawList
from sailenv_ros.render.gl.edge_pass import EdgePass
from sailenv_ros.render.gl.geometry_buffers import GeometryBuffers
from sailenv_ros.render.gl.geometry_pass import GeometryPass, Targets, written_views
from sailenv_ros.render.gl.glass_pass import GlassPass
from sailenv_ros.render.gl.lighting_pass import Illumination, LightingPass
from sailenv_ros.render.gl.materials import MaterialBuffers
from sailenv_ros.render.gl.picture_buffers import PictureBuffers
from sailenv_ros.render.gl.programs import ProgramCache
from sailenv_ros.render.gl.scene_light import SceneLight
from sailenv_ros.render.picture.finishing import Arrays, Draw, DrawingRenderer, Timings
from sailenv_ros.render.picture.mirror_pictures import closer_window, reflect
from sailenv_ros.render.scene.drawn_meshes import drawn_meshes
from sailenv_ros.render.scene.flat_mirrors import FlatMirrors, SeenMirror, Window
from sailenv_ros.render.scene.mirrored_lamps import Seen
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import VIEWS, views_of

__all__ = ["Renderer"]

_UPSIDE_DOWN = np.diag([1.0, -1.0, 1.0, 1.0])
"""Row 0 of OpenGL's window becomes the picture's top row: nothing is flipped afterwards."""


class Renderer(DrawingRenderer):
    """Draws with OpenGL, without a window; belongs to the thread that makes it.

    Parameters
    ----------
    device : int or None
        EGL's number of the device; None takes graphics hardware if there is any.

    Raises
    ------
    ContextError
        If no OpenGL context is available.
    """

    def __init__(self, *, device: int | None = None) -> None:
        super().__init__()
        self._context, self._device = create_context(device)
        try:
            with self._context:
                self._programs = ProgramCache(self._context)
                self._geometry = GeometryBuffers(self._context)
                self._materials = MaterialBuffers(self._context, software=self._device.software)
                self._geometry_pass = GeometryPass(self._context, self._programs)
                self._scene_light = SceneLight(self._context, self._programs)
                self._lighting_pass = LightingPass(self._context, self._programs)
                self._glass_pass = GlassPass(self._context, self._programs)
                self._edge_pass = EdgePass(self._context, self._programs)
                self._pictures = PictureBuffers(self._context, self._geometry_pass)
        except BaseException:
            self._context.release()
            raise
        self._outputs = written_views()
        self._mirrors = FlatMirrors()
        self._draws: DrawList | None = None
        self._native: NativeRenderer | None = None

    @property
    def description(self) -> str:
        """One line: back end, device, driver."""
        kind = "software OpenGL" if self.software else "OpenGL"
        device = self._device
        return f"{kind} {device.version} on EGL device {device.index}: {device.renderer}"

    @property
    def software(self) -> bool:
        """True if no graphics hardware is used."""
        return self._device.software

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make, in the order of `frame.VIEWS`."""
        made = {*views_of("lighting", "annotation", "measurement"), *self._outputs}
        return tuple(view for view in VIEWS if view in made)

    def _finished(self, request: RenderRequest, draw: Draw, threads: int) -> RenderedViews:
        """Make views; through bent lenses and rolling shutters by the native renderer."""
        past = request.previous
        is_global = request.rows is None and (past is None or past.rows is None)
        if request.camera.intrinsics.is_pinhole and is_global:
            return super()._finished(request, draw, threads)
        if self._native is None:
            self._native = NativeRenderer(threads=threads)
        return self._native.render(request)

    def _drawing_context(self) -> moderngl.Context:
        return self._context

    def _at_baked_pose(self, snapshot: WorldSnapshot) -> NDArray[np.bool_]:
        return self._draws_of(snapshot).at_baked_pose(snapshot)

    def _release(self) -> None:
        if self._native is not None:
            self._native.close()
        with self._context:
            for resource in (
                self._pictures,
                self._edge_pass,
                self._geometry_pass,
                self._glass_pass,
                self._lighting_pass,
                self._scene_light,
                self._materials,
                self._geometry,
                self._programs,
            ):
                if resource is not None:
                    resource.close()
        self._context.release()

    def _draw(self, observed: Observation, wanted: frozenset[str], timings: Timings) -> Arrays:
        """Run the passes and read back what they left."""
        snapshot, camera = observed.snapshot, observed.camera
        marks = [("", time.perf_counter())]

        def mark(stage: str) -> None:
            # Without this the time of a pass would be booked on whoever reads its result.
            self._context.finish()
            marks.append((stage, time.perf_counter()))

        draws = self._draws_of(snapshot)
        mark("upload")
        shaded = "rgb" in wanted
        illumination = None
        if shaded:
            illumination = self._scene_light.at(
                snapshot, draws, self._geometry, partial(self._radiance, snapshot)
            )
            mark("shadow")
        # Ground truth is of pixel centres; where a picture has more samples, it is drawn apart.
        seen = _of_samples(camera)
        apart = shaded and seen is not camera
        smoothed = apart and _is_smoothed(camera)
        outputs = tuple(view for view in self._outputs if view in wanted)
        targets = self._surfaces(snapshot, camera, shaded=shaded and not apart, outputs=outputs)
        mark("geometry")
        arrays: Arrays = {}
        sampled = camera.picture.supersampling > 1
        mirrors: list[SeenMirror] = []
        if illumination is not None:
            lit = targets
            if apart:
                lit = self._surfaces(snapshot, seen, shaded=True, half_pixels=smoothed)
                mark("geometry")
            self._lighting_pass.draw(lit, seen, illumination)
            self._glass_pass.show(snapshot.contents, self._geometry, self._materials)
            self._glass_pass.draw(
                lit,
                snapshot,
                seen,
                _clip_from_optical(seen.intrinsics),
                illumination,
                self._geometry,
                self._materials,
                half_pixels=smoothed,
            )
            arrays["rgb"] = self._read_lit(lit, camera, smoothed=smoothed)
            mark("lighting")
            mirrors = self._mirrors.seen(snapshot, seen if sampled else camera)
            occluded = sampled and camera.picture.occlusion_strength > 0.0
            if apart and (mirrors or occluded):
                samples = self._pictures.read_surface(lit)
                if sampled:
                    arrays["samples"] = samples
        arrays["surface"] = self._pictures.read_surface(targets)
        for view in outputs:
            arrays[view] = self._pictures.read_output(targets, view)
        mark("readback")
        if illumination is not None and mirrors:
            self._reflect(
                *(snapshot, mirrors, seen if sampled else camera, illumination, arrays),
                samples if smoothed else None,
            )
            mark("lighting")
        for (_, start), (stage, end) in itertools.pairwise(marks):
            timings[stage] = timings.get(stage, 0.0) + end - start
        return arrays

    def _surfaces(
        self,
        snapshot: WorldSnapshot,
        camera: Camera,
        *,
        shaded: bool,
        outputs: tuple[str, ...] = (),
        half_pixels: bool = False,
    ) -> Targets:
        """Draw the surfaces that a camera sees."""
        intrinsics = camera.intrinsics
        targets = self._pictures.targets(
            intrinsics,
            shaded=shaded,
            outputs=outputs,
            baked=snapshot.contents.baked is not None,
        )
        draws = self._draws_of(snapshot)
        draws.place(snapshot, _clip_from_optical(intrinsics), camera.camera_from_world)
        self._geometry_pass.draw(
            *(targets, draws, self._geometry, self._materials, intrinsics),
            baked=self._scene_light.baked,
            half_pixels=half_pixels,
        )
        return targets

    def _read_lit(self, lit: Targets, camera: Camera, *, smoothed: bool) -> NDArray[np.float16]:
        """Read a camera's picture, of samples half a pixel apart after smoothing its edges."""
        if not smoothed:
            return self._pictures.read_picture(lit.picture)
        picture = self._pictures.picture(camera.intrinsics)
        self._edge_pass.draw(lit, picture)
        return self._pictures.read_picture(picture)

    def _reflect(
        self,
        snapshot: WorldSnapshot,
        mirrors: list[SeenMirror],
        camera: Camera,
        illumination: Illumination,
        arrays: Arrays,
        samples: NDArray[np.float32] | None,
    ) -> None:
        """Put into the picture what its flat mirrors show."""

        def closer(window: Window) -> NDArray[np.float32]:
            assert samples is not None
            return samples[closer_window(window)]

        def look(behind: Camera, only: NDArray[np.bool_], window: Window) -> NDArray[np.float16]:
            with self._lit(snapshot, behind, illumination, only) as lit:
                return self._read_lit(lit, behind, smoothed=_is_smoothed(behind))[window]

        surface = arrays["samples" if "samples" in arrays else "surface"]
        reflect(mirrors, camera, arrays["rgb"], surface, look, None if samples is None else closer)

    def _radiance(
        self,
        snapshot: WorldSnapshot,
        camera: Camera,
        illumination: Illumination,
        only: NDArray[np.bool_],
    ) -> Seen:
        """Draw linear radiance and depth of some instances."""
        unexposed = replace(illumination.environment, exposure=0.0)
        light = replace(illumination, environment=unexposed)
        with self._lit(snapshot, camera, light, only) as lit:
            picture = self._read_lit(lit, camera, smoothed=_is_smoothed(camera))
            surface = self._pictures.read_surface(lit)
        return Seen(picture[..., :3].astype(np.float32), surface[..., 0].copy())

    @contextmanager
    def _lit(
        self,
        snapshot: WorldSnapshot,
        camera: Camera,
        illumination: Illumination,
        only: NDArray[np.bool_],
    ) -> Iterator[Targets]:
        """Draw what some instances send out, without glass; lit while the context lasts."""
        seen = _of_samples(camera)
        half_pixels = _is_smoothed(camera)
        draws, intrinsics = self._draws_of(snapshot), seen.intrinsics
        draws.place(snapshot, _clip_from_optical(intrinsics), camera.camera_from_world, only=only)
        targets = self._geometry_pass.make_targets(
            intrinsics.width,
            intrinsics.height,
            shaded=True,
            baked=snapshot.contents.baked is not None,
        )
        try:
            self._geometry_pass.draw(
                *(targets, draws, self._geometry, self._materials, intrinsics),
                baked=self._scene_light.baked,
                half_pixels=half_pixels,
            )
            self._lighting_pass.draw(targets, seen, illumination)
            yield targets
        finally:
            targets.close()

    def _draws_of(self, snapshot: WorldSnapshot) -> DrawList:
        """Return the draw list of the snapshot's contents; kept until the contents change."""
        contents = snapshot.contents
        if self._draws is not None and self._draws.contents is contents:
            return self._draws
        models = [drawn.model for drawn in contents.instances]
        self._geometry.show(mesh for meshes in drawn_meshes(contents) for mesh in meshes)
        self._materials.show(part.material for model in models for part in model.parts)
        self._draws = DrawList(contents, self._geometry, self._materials)
        return self._draws


def _is_smoothed(camera: Camera) -> bool:
    """Tell if a camera's picture is made of samples half a pixel apart."""
    return camera.picture.smooth_edges and camera.picture.supersampling == 1


def _of_samples(camera: Camera) -> Camera:
    """Return the camera of what its picture is made of: itself, unless there are more samples."""
    if camera.picture.supersampling > 1:
        return camera.of_samples()
    return camera.of_half_pixels() if _is_smoothed(camera) else camera


def _clip_from_optical(intrinsics: CameraIntrinsics) -> NDArray[np.float64]:
    clip_from_optical: NDArray[np.float64] = _UPSIDE_DOWN @ intrinsics.clip_from_optical()
    return clip_from_optical

"""The native renderer: draws on the processor, without OpenGL.

A snapshot, a camera and names of views come in, arrays go out. What no wanted view needs is not
drawn.
"""

from __future__ import annotations

import time
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import tells_depth
from sailenv_ros.native.drawing import Drawing, DrawnPoses
from sailenv_ros.native.library import native_library
from sailenv_ros.native.render_types import PART, TRIANGLE_PLACE, VIEW, record
from sailenv_ros.render.cpu.cube_faces import lens_tables
from sailenv_ros.render.cpu.frame_light import FrameLight
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.picture.annotate import POINT_VIEWS
from sailenv_ros.render.picture.finishing import Arrays, DrawingRenderer, Timings
from sailenv_ros.render.picture.mirror_pictures import closer_window, reflect
from sailenv_ros.render.scene.flat_mirrors import FlatMirrors, Window
from sailenv_ros.render.scene.opening_window import OpeningWindows
from sailenv_ros.render.scene.reflection_store import ReflectionStore
from sailenv_ros.render.scene.room_reflections import Share
from sailenv_ros.render.scene.seen_sky import seen_exposure, seen_sky
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import VIEWS, views_of

__all__ = ["NativeRenderer", "native_view"]

_ATTRIBUTES = views_of("geometry")
"""Views that the library writes as they are, in their order."""

_NO_GLASS = np.zeros(0, PART)


class NativeRenderer(DrawingRenderer):
    """Draws with the native library; belongs to the thread that makes it.

    Parameters
    ----------
    threads : int or None
        How many threads draw; None for `library.thread_count`. Frames do not depend on it.
    table : PartTable or None
        With stores of meshes and textures that outlive this renderer; None for its own.
    reflections : ReflectionStore or None
        That outlives this renderer; None keeps what the room that is shown mirrors, alone.

    Raises
    ------
    NativeLibraryError
        If there is no native library.
    """

    def __init__(
        self,
        *,
        threads: int | None = None,
        table: PartTable | None = None,
        reflections: ReflectionStore[Share] | None = None,
    ) -> None:
        super().__init__(threads)
        self._drawing = Drawing(self._threads)
        self._table = PartTable() if table is None else table
        self._reflections = reflections
        self._openings = OpeningWindows()
        self._light = FrameLight(self._drawing, self._threads, reflections)

    @property
    def description(self) -> str:
        """One line: back end, instruction set, threads."""
        threads = "1 thread" if self._threads == 1 else f"{self._threads} threads"
        return f"native renderer on the CPU ({native_library().instruction_set}, {threads})"

    @property
    def part_table(self) -> PartTable:
        """The meshes that are shown; for who draws in the same thread."""
        return self._table

    @property
    def software(self) -> bool:
        """True: no graphics hardware is used."""
        return True

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make, in the order of `frame.VIEWS`."""
        return views_of("lighting", "annotation", "geometry", "measurement")

    def preload(self, contents: SceneContents) -> None:
        """Make meshes, textures and the sky ready; see `RenderBackend.preload`."""
        self._table.show(contents)
        environment = contents.environment
        if environment.sky is not None:
            seen_sky(environment.sky, seen_exposure(environment))

    def forget(self) -> None:
        """Free what was made of the scene that was shown; it is made again if that comes again."""
        self._table.forget()
        self._openings, self._mirrors = OpeningWindows(), FlatMirrors()
        # What kernels draw in grows to what the largest room needed, and never shrinks.
        self._drawing.close()
        self._drawing = Drawing(self._threads)
        self._light = FrameLight(self._drawing, self._threads, self._reflections)

    def _at_baked_pose(self, snapshot: WorldSnapshot) -> NDArray[np.bool_]:
        return self._table.at_baked_pose(snapshot)

    def _release(self) -> None:
        self._drawing.close()

    def _draw(self, observed: Observation, wanted: frozenset[str], timings: Timings) -> Arrays:
        """Draw surfaces, and what else is wanted."""
        began = time.perf_counter()
        snapshot, camera, table = observed.snapshot, observed.camera, self._table
        table.show(snapshot.contents)
        table.deform(snapshot)
        marked = time.perf_counter()
        timings["upload"] = marked - began
        light = None
        if "rgb" in wanted:
            light = self._light.at(snapshot, table, partial(self._radiance, snapshot))
            timings["shadow"] = time.perf_counter() - marked
            marked = time.perf_counter()
        poses = np.ascontiguousarray(snapshot.world_from_body)
        at_baked_pose = table.at_baked_pose(snapshot)
        rows = None if observed.rows is None else _drawn_poses(observed.rows, snapshot)
        # What is seen through openings differs from row to row.
        clip = None if rows is not None else self._openings.of(snapshot, camera)
        instances = table.instances(poses, at_baked_pose, clip=clip)
        # With supersampling the picture is drawn apart: ground truth is of pixel centres.
        sampled = light is not None and camera.picture.supersampling > 1
        height, width = camera.intrinsics.height, camera.intrinsics.width
        arrays: Arrays = {"surface": np.empty((height, width, 2), np.float32)}
        for view in _ATTRIBUTES:
            if view in wanted:
                arrays[view] = np.empty(VIEWS[view].shape(height, width), VIEWS[view].dtype)
        if snapshot.deformations and not wanted.isdisjoint(POINT_VIEWS):
            arrays["places"] = np.empty((height, width), TRIANGLE_PLACE)
        radiance = None
        if light is not None and not sampled:
            radiance = arrays["rgb"] = np.empty((height, width, 4), np.float16)
        self._drawing.picture(
            native_view(camera, lit=radiance is not None),
            instances,
            table.opaque,
            table.glass,
            None if radiance is None else light,
            surface=arrays["surface"],
            radiance=radiance,
            attributes=[arrays.get(view) for view in _ATTRIBUTES],
            places=arrays.get("places"),
            poses=rows,
        )
        if sampled:
            fine = camera.of_samples()
            clip = None if rows is not None else self._openings.of(snapshot, fine)
            instances = table.instances(poses, at_baked_pose, clip=clip)
            height, width = fine.intrinsics.height, fine.intrinsics.width
            arrays["rgb"] = np.empty((height, width, 4), np.float16)
            if camera.picture.occlusion_strength > 0.0:
                arrays["samples"] = np.empty((height, width, 2), np.float32)
            self._drawing.picture(
                native_view(fine),
                instances,
                table.opaque,
                table.glass,
                light,
                surface=arrays.get("samples"),
                radiance=arrays["rgb"],
                poses=rows,
            )
        if light is not None:
            self._reflect(snapshot, fine if sampled else camera, light, arrays)
        timings["draw"] = time.perf_counter() - marked
        return arrays

    def _reflect(
        self,
        snapshot: WorldSnapshot,
        camera: Camera,
        light: NDArray[np.void],
        arrays: Arrays,
    ) -> None:
        """Put into the picture what its flat mirrors show."""
        mirrors = self._mirrors.seen(snapshot, camera)
        if not mirrors:
            return
        poses = np.ascontiguousarray(snapshot.world_from_body)
        at_baked_pose = self._table.at_baked_pose(snapshot)

        def look(behind: Camera, only: NDArray[np.bool_], window: Window) -> NDArray[np.float16]:
            view = native_view(behind, window)
            size = int(view["height"][0]), int(view["width"][0])
            radiance = np.empty((*size, 4), np.float16)
            instances = self._table.instances(poses, at_baked_pose, only)
            opaque = self._table.opaque
            self._drawing.picture(view, instances, opaque, _NO_GLASS, light, radiance=radiance)
            return radiance

        def surface_of(view: NDArray[np.void]) -> NDArray[np.float32]:
            surface = np.empty((int(view["height"][0]), int(view["width"][0]), 2), np.float32)
            instances = self._table.instances(poses, at_baked_pose)
            opaque = self._table.opaque
            self._drawing.picture(view, instances, opaque, _NO_GLASS, None, surface=surface)
            return surface

        def samples(window: Window) -> NDArray[np.float32]:
            closer = closer_window(window)
            return surface_of(native_view(camera.of_half_pixels(), closer, lit=False))

        surface = arrays["samples" if "samples" in arrays else "surface"]
        if surface.shape[:2] != arrays["rgb"].shape[:2]:
            surface = surface_of(native_view(camera, lit=False))
        smoothed = camera.picture.smooth_edges
        reflect(mirrors, camera, arrays["rgb"], surface, look, samples if smoothed else None)

    def _radiance(
        self,
        snapshot: WorldSnapshot,
        camera: Camera,
        light: NDArray[np.void],
        only: NDArray[np.bool_],
        glows: bool,
    ) -> NDArray[np.float32]:
        """Draw linear radiance of some instances, without glass, as an array (H, W, 3)."""
        parts = self._table.unlit
        if not glows:
            parts = parts.copy()
            parts["emission"] = 0.0
        poses = np.ascontiguousarray(snapshot.world_from_body)
        at_baked_pose = self._table.at_baked_pose(snapshot)
        radiance = np.empty((camera.intrinsics.height, camera.intrinsics.width, 4), np.float16)
        self._drawing.picture(
            native_view(camera),
            self._table.instances(poses, at_baked_pose, only),
            parts,
            _NO_GLASS,
            light,
            radiance=radiance,
        )
        return radiance[..., :3].astype(np.float32)


def _drawn_poses(rows: RowPoses, snapshot: WorldSnapshot) -> DrawnPoses:
    return DrawnPoses(
        camera_from_world=np.ascontiguousarray(rows.camera_from_world),
        world_from_camera=np.ascontiguousarray(rows.world_from_camera),
        moving=np.flatnonzero(np.isin(snapshot.contents.instance_ids, rows.ids)),
        world_from_moving=np.ascontiguousarray(rows.world_from_instance),
    )


def native_view(
    camera: Camera, window: Window | None = None, *, lit: bool = True
) -> NDArray[np.void]:
    """Return (1,) VIEW of a camera or of a window of it, as the native kernels read it.

    Parameters
    ----------
    camera : Camera
    window : Window or None
        Of a lens that bends straight lines all of the picture alone.
    lit : bool
        Whether a picture is drawn: edges are smoothed in pictures alone.
    """
    lens = camera.intrinsics
    rows, columns = window or (slice(0, lens.height), slice(0, lens.width))
    smooth = lit and camera.picture.smooth_edges
    return record(
        VIEW,
        camera_from_world=camera.camera_from_world.reshape(-1),
        world_from_camera=camera.world_from_camera.reshape(-1),
        lens=lens.lens_of_window(rows, columns)[0],
        width=columns.stop - columns.start,
        height=rows.stop - rows.start,
        smooth_edges=smooth,
        parallel=lens.is_parallel,
        **({} if tells_depth(lens) else lens_tables(lens, smooth)),
    )

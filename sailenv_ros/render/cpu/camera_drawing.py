"""One camera's arrays, drawn by the native library in memory of their own.

A `PartTable` of what is shown and its light come in, arrays go out. Several cameras can be drawn
side by side, each with a `CameraDrawing`, as long as nobody changes table and light.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import tells_depth
from sailenv_ros.native.drawing import Drawing, DrawnPoses
from sailenv_ros.native.render_types import PART, TRIANGLE_PLACE, VIEW, record
from sailenv_ros.render.cpu.cube_faces import lens_tables
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.picture.annotate import POINT_VIEWS
from sailenv_ros.render.picture.finishing import Arrays
from sailenv_ros.render.picture.mirror_pictures import closer_window, reflect
from sailenv_ros.render.scene.flat_mirrors import FlatMirrors, Window
from sailenv_ros.render.scene.mirrored_lamps import Seen
from sailenv_ros.render.scene.opening_window import OpeningWindows
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.lights import Light
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import VIEWS, views_of

__all__ = ["CameraDrawing", "native_view"]

_ATTRIBUTES = views_of("geometry")
"""Views that the library writes as they are, in their order."""

_NO_GLASS = np.zeros(0, PART)


class CameraDrawing:
    """Draws one camera at a time; belongs to one thread at a time.

    Parameters
    ----------
    threads : int
        How many threads draw. The arrays do not depend on it.
    table : PartTable
        Up to date for what is drawn.

    Attributes
    ----------
    kernels : Drawing

    Raises
    ------
    NativeLibraryError
        If there is no native library.
    """

    def __init__(self, threads: int, table: PartTable) -> None:
        self.kernels = Drawing(threads)
        self._table = table
        self._openings = OpeningWindows()
        self._mirrors = FlatMirrors()

    def close(self) -> None:
        """Free the memory; a second call does nothing."""
        self.kernels.close()

    def arrays(
        self, observed: Observation, wanted: frozenset[str], light: NDArray[np.void] | None
    ) -> Arrays:
        """Draw surfaces, and what else is wanted; see `DrawingRenderer._draw`.

        Parameters
        ----------
        observed : Observation
        wanted : frozenset of str
        light : (1,) LIGHT or None
            None where no picture is wanted.
        """
        snapshot, camera, table = observed.snapshot, observed.camera, self._table
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
        self.kernels.picture(
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
            self.kernels.picture(
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
            self.kernels.picture(view, instances, opaque, _NO_GLASS, light, radiance=radiance)
            return radiance

        def surface_of(view: NDArray[np.void]) -> NDArray[np.float32]:
            surface = np.empty((int(view["height"][0]), int(view["width"][0]), 2), np.float32)
            instances = self._table.instances(poses, at_baked_pose)
            opaque = self._table.opaque
            self.kernels.picture(view, instances, opaque, _NO_GLASS, None, surface=surface)
            return surface

        def samples(window: Window) -> NDArray[np.float32]:
            closer = closer_window(window)
            return surface_of(native_view(camera.of_half_pixels(), closer, lit=False))

        surface = arrays["samples" if "samples" in arrays else "surface"]
        if surface.shape[:2] != arrays["rgb"].shape[:2]:
            surface = surface_of(native_view(camera, lit=False))
        smoothed = camera.picture.smooth_edges
        reflect(mirrors, camera, arrays["rgb"], surface, look, samples if smoothed else None)

    def radiance(
        self,
        snapshot: WorldSnapshot,
        camera: Camera,
        light: NDArray[np.void],
        only: NDArray[np.bool_],
        alone: Light | None,
        lit: bool,
    ) -> Seen:
        """Draw linear radiance and depth of some instances, without glass; see `Radiance`."""
        poses = np.ascontiguousarray(snapshot.world_from_body)
        at_baked_pose = self._table.at_baked_pose(snapshot)
        size = camera.intrinsics.height, camera.intrinsics.width
        radiance = np.empty((*size, 4), np.float16)
        surface = np.empty((*size, 2), np.float32)
        self.kernels.picture(
            native_view(camera),
            self._table.instances(poses, at_baked_pose, only),
            self._table.glowing_by(alone, lit=lit),
            _NO_GLASS,
            light,
            radiance=radiance,
            surface=surface,
        )
        return Seen(radiance[..., :3].astype(np.float32), surface[..., 0].copy())


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

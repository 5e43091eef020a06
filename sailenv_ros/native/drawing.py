"""Pictures, shadow maps and objects alone, drawn by the kernels of render.cpp and amodal.cpp.

Structures of `render_types` come in; arrays of the caller are filled. One `Drawing` or
`AmodalDrawing` holds the memory that is drawn in.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens_tables import CUBE_FACE, LENS_TABLE, LENS_TILES
from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.records import RecordKernel
from sailenv_ros.native.render_types import (
    DRAW_LIST,
    INSTANCES,
    LAYER_SUM,
    LIGHT,
    OUTPUTS,
    PART,
    TRIANGLE_PLACE,
    VIEW,
    address,
    record,
)
from sailenv_ros.native.traced_types import TRACED_INSTANCE, TRACED_SCENE

__all__ = ["ROW_PADDING", "AmodalDrawing", "Drawing", "DrawnPoses", "mip_chain", "structure_sizes"]

_PICTURE = Kernel("draw_picture", "iaaaaaaa")
_ROLLING = RecordKernel(
    "rolling_picture",
    ("array", "scratch view instances parts glass light outputs"),
    ("integer", "poses lines"),
    ("array", "camera_from_world world_from_camera"),
    ("integer", "moving_count"),
    ("array", "moving world_from_moving"),
)
_SHADOW = Kernel("draw_shadow_map", "iaaaaiaaa")
_AMODAL = Kernel("draw_amodal", "iaaaaaia")
_AMODAL_CROPS = Kernel("copy_amodal", "aia")
_MIPS = Kernel("mip_chain", "aia")
_STRUCTURES = Kernel("structure_sizes", "a")


ROW_PADDING = 8
"""Numbers behind each row of a shadow map: rows are drawn in steps of eight."""


AMODAL_NUMBERS = 10
"""Numbers of an object's result in `AmodalDrawing.draw`."""


class DrawnPoses(NamedTuple):
    """Where a camera and what moves stand at each row of a sensor.

    Attributes
    ----------
    camera_from_world, world_from_camera : (R, 4, 4) float64
    moving : (M,) int64
        Rows of the instances that move; the others stand as `INSTANCES` says.
    world_from_moving : (R, M, 4, 4) float64
    """

    camera_from_world: NDArray[np.float64]
    world_from_camera: NDArray[np.float64]
    moving: NDArray[np.int64]
    world_from_moving: NDArray[np.float64]


class _Scratch:
    """The memory that kernels draw in; belongs to one thread at a time.

    Parameters
    ----------
    threads : int
        How many threads draw; may be changed at any time. The result does not depend on it.

    Raises
    ------
    NativeLibraryError
        If there is no native library.
    """

    _MAKE: ClassVar[Kernel]
    _FREE: ClassVar[Kernel]

    def __init__(self, threads: int) -> None:
        self.threads = threads
        self._handle = np.zeros(1, np.uint64)
        self._MAKE(self._handle)

    def close(self) -> None:
        """Free the memory; a second call does nothing."""
        if self._handle[0]:
            self._FREE(self._handle)


class Drawing(_Scratch):
    """Draws pictures and shadow maps; parameters and errors as `_Scratch`."""

    _MAKE = Kernel("make_scratch", "a")
    _FREE = Kernel("free_scratch", "a")

    def picture(
        self,
        view: NDArray[np.void],
        instances: NDArray[np.void],
        parts: NDArray[np.void],
        glass: NDArray[np.void],
        light: NDArray[np.void] | None,
        *,
        surface: NDArray[np.float32] | None = None,
        radiance: NDArray[np.float16] | None = None,
        attributes: Sequence[NDArray[np.float32] | None] = (),
        places: NDArray[np.void] | None = None,
        poses: DrawnPoses | None = None,
    ) -> None:
        """Draw what a camera sees.

        Parameters
        ----------
        view : (1,) VIEW
        instances : (1,) INSTANCES
        parts, glass : (N,) PART
            What is opaque, and what is see-through.
        light : (1,) LIGHT or None
            Needed for radiance.
        surface : (H, W, 2) float32 or None
            Takes depth along the optical axis [m] (inf: nothing was hit) and the instance id.
        radiance : (H, W, 4) float16 or None
            Takes exposed linear radiance, and the share of it that came from around.
        attributes : sequence of (H, W, C) float32 or None
            Take the views of source 'geometry', in their order; see `types.views.VIEWS`.
        places : (H, W) TRIANGLE_PLACE or None
            Takes where on its triangle each pixel is, of models that deform: vertices of all parts
            of the model, one part after another, and their weights. Elsewhere it is left alone.
        poses : DrawnPoses or None
            Of a rolling shutter, for each row or, where the picture has samples, each so many
            rows; counts instead of the view's. None draws all rows from one place.
        """
        height, width = int(view["height"][0]), int(view["width"][0])
        checked("view", view, VIEW, (1,))
        checked("instances", instances, INSTANCES, (1,))
        if light is not None:
            checked("light", light, LIGHT, (1,))
        for name, array, dtype, channels in (
            ("surface", surface, np.float32, 2),
            ("radiance", radiance, np.float16, 4),
            *(("attribute", array, np.float32, None) for array in attributes),
        ):
            if array is not None:
                checked(name, array, dtype, (height, width, channels))
        if places is not None:
            checked("places", places, TRIANGLE_PLACE, (height, width))
        outputs = record(
            OUTPUTS,
            surface_at=address(surface),
            radiance_at=address(radiance),
            places_at=address(places),
        )
        outputs["attributes_at"][0, : len(attributes)] = [address(a) for a in attributes]
        listed = view, instances, _listed(parts), _listed(glass), light, outputs
        if poses is None:
            _PICTURE(self.threads, self._handle, *listed)
            return
        names = ("view", "instances", "parts", "glass", "light", "outputs")
        rows, moving = len(poses.camera_from_world), len(poses.moving)
        checked("camera_from_world", poses.camera_from_world, np.float64, (rows, 4, 4))
        checked("world_from_camera", poses.world_from_camera, np.float64, (rows, 4, 4))
        checked("moving", poses.moving, np.int64, (moving,))
        checked("world_from_moving", poses.world_from_moving, np.float64, (rows, moving, 4, 4))
        _ROLLING(
            self.threads,
            scratch=self._handle,
            **dict(zip(names, listed, strict=True)),
            poses=rows,
            lines=height // max(rows, 1),
            camera_from_world=poses.camera_from_world,
            world_from_camera=poses.world_from_camera,
            moving_count=moving,
            moving=poses.moving,
            world_from_moving=poses.world_from_moving,
        )

    def shadow_map(
        self,
        map_from_world: NDArray[np.float64],
        instances: NDArray[np.void],
        casters: NDArray[np.void],
        nearness: NDArray[np.float32],
        changed: NDArray[np.uint8],
        *,
        resting: NDArray[np.float32] | None,
    ) -> None:
        """Draw what a directional light sees.

        Parameters
        ----------
        map_from_world : (4, 4) float64
            To texels (integers are their centres) and depth, 0 to 1.
        casters : (N,) PART
        nearness : (S, S + `ROW_PADDING`) float32
            Takes 1 - depth of the nearest surface, 0 where there is none.
        changed : (ceil(S / 16),) uint8
            1 for each 16 rows in which the map may differ from `resting`; updated.
        resting : float32 array like `nearness`, or None
            What the map begins as, the map itself, too; None begins with an empty one.
        """
        checked("map_from_world", map_from_world, np.float64, (4, 4))
        checked("instances", instances, INSTANCES, (1,))
        size = len(nearness)
        for name, array in (("nearness", nearness), ("resting", resting)):
            if array is not None:
                checked(name, array, np.float32, (size, size + ROW_PADDING))
        checked("changed", changed, np.uint8, ((size + 15) // 16,))
        _SHADOW(
            self.threads,
            self._handle,
            map_from_world,
            instances,
            _listed(casters),
            size,
            resting,
            changed,
            nearness,
        )


class AmodalDrawing(_Scratch):
    """Draws objects, each alone; parameters and errors as `_Scratch`."""

    _MAKE = Kernel("make_amodal_scratch", "a")
    _FREE = Kernel("free_amodal_scratch", "a")

    def draw(
        self,
        view: NDArray[np.void],
        instances: NDArray[np.void],
        parts: NDArray[np.void],
        starts: NDArray[np.int64],
    ) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
        """Draw objects, each on a canvas of three times the picture's width and height.

        Parameters
        ----------
        view : (1,) VIEW
        instances : (1,) INSTANCES
        parts : (P,) PART
        starts : (N + 1,) int64
            Object k consists of the parts from ``starts[k]`` to ``starts[k + 1]``.

        Returns
        -------
        results : (N, 10) int64
            Pixels that it covers on the canvas, and in the picture; the box around the ones (left,
            top, right, bottom, the last ones included), and around the others; -1 for none.
        depths : (M,) float32
            Of each object's box in the picture, row by row, one after the other [m]; ``inf`` where
            it is not, NaN where it is nearer than near.
        """
        checked("view", view, VIEW, (1,))
        checked("instances", instances, INSTANCES, (1,))
        checked("starts", starts, np.int64, (None,))
        count = len(starts) - 1
        results = np.empty((count, AMODAL_NUMBERS), np.int64)
        listed = _listed(parts)
        _AMODAL(self.threads, self._handle, view, instances, listed, starts, count, results)
        boxes = results[results[:, 1] > 0, 6:]
        size = int(((boxes[:, 2] - boxes[:, 0] + 1) * (boxes[:, 3] - boxes[:, 1] + 1)).sum())
        depths = np.empty(size, np.float32)
        _AMODAL_CROPS(self._handle, size, depths)
        return results, depths


def mip_chain(texels: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """Return a texture with all its levels, as kernels read it.

    Parameters
    ----------
    texels : (N, N, 4) uint8
        The finest level; N is a power of two from 1 to 4096.

    Returns
    -------
    chain : (M,) uint32
        Level by level from the finest; a row of n texels is followed by its first one. Each texel
        is the mean of four of the level before, rounded.
    """
    edge = len(texels)
    checked("texels", texels, np.uint8, (edge, edge, 4))
    # Two neighbours of the last row are read in one step with the next ones.
    chain = np.empty(sum(s * (s + 1) for s in _edges(edge)) + 2, np.uint32)
    chain[-2:] = 0
    _MIPS(texels, edge, chain)
    return chain


def structure_sizes() -> dict[str, tuple[int, int]]:
    """Return the size of each structure [bytes]: the library's and NumPy's."""
    ours = {
        "part": PART,
        "instances": INSTANCES,
        "light": LIGHT,
        "view": VIEW,
        "outputs": OUTPUTS,
        "layer_sum": LAYER_SUM,
        "lens_table": LENS_TABLE,
        "cube_face": CUBE_FACE,
        "lens_tiles": LENS_TILES,
        "triangle_place": TRIANGLE_PLACE,
        "traced_instance": TRACED_INSTANCE,
        "traced_scene": TRACED_SCENE,
    }
    sizes = np.zeros(len(ours), np.int64)
    _STRUCTURES(sizes)
    return {
        name: (int(size), structure.itemsize)
        for (name, structure), size in zip(ours.items(), sizes, strict=True)
    }


def _edges(edge: int) -> list[int]:
    return [edge >> level for level in range(edge.bit_length())]


def _listed(parts: NDArray[np.void]) -> NDArray[np.void]:
    checked("parts", parts, PART, (None,))
    return record(DRAW_LIST, parts_at=address(parts), count=len(parts))

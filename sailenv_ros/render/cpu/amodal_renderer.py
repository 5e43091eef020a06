"""Draws each object of a snapshot alone: what it covers, whatever lies in front of it.

A snapshot and a camera come in, `AmodalMasks` go out. By the rasteriser of the native renderer, so
what nothing hides covers the very pixels that the native renderer gives it.
"""

from __future__ import annotations

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.lens_rays import depth_shares, tells_depth
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.native.drawing import AmodalDrawing
from sailenv_ros.render.cpu.camera_drawing import native_view
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["AmodalRenderer"]


class AmodalRenderer:
    """Draws objects alone; belongs to one thread at a time.

    Parameters
    ----------
    table : PartTable or None
        Of a renderer, whose meshes are used then; None makes an own one.
    threads : int or None
        How many threads draw; None for `system.threads.thread_count`. Masks do not depend on it.

    Raises
    ------
    NativeLibraryError
        If there is no native library.
    """

    def __init__(self, table: PartTable | None = None, *, threads: int | None = None) -> None:
        self._table = PartTable() if table is None else table
        self._drawing = AmodalDrawing(thread_count() if threads is None else threads)

    def draw(self, snapshot: WorldSnapshot, camera: Camera, only: int = 0) -> AmodalMasks:
        """Draw every object of a snapshot, each alone, or only the one of that id.

        Raises
        ------
        InvalidRequest
            If there is no object of that id.
        """
        self._table.show(snapshot.contents)
        self._table.deform(snapshot)
        parts = self._table.opaque
        poses = np.ascontiguousarray(snapshot.world_from_body)
        ids = snapshot.contents.instance_ids
        # Parts lie in the order of the snapshot's rows.
        starts = np.searchsorted(parts["instance"], np.arange(len(ids) + 1)).astype(np.int64)
        if only:
            row = np.flatnonzero(ids == only)
            if not len(row):
                raise InvalidRequest("instance id", only, "the id of an object in the scene")
            ids, starts = ids[row], starts[row[0] : row[0] + 2]
        order = np.argsort(ids, kind="stable")
        lens = camera.intrinsics
        results, depths = self._drawing.draw(
            native_view(camera, lit=False), self._table.instances(poses, None), parts, starts
        )
        crops = []
        at = 0
        for row in results.tolist():
            height, width = (0, 0) if row[6] < 0 else (row[9] - row[7] + 1, row[8] - row[6] + 1)
            crop = depths[at : at + height * width].reshape(height, width)
            if crop.size and not tells_depth(lens):
                shares = depth_shares(lens)[row[7] : row[9] + 1, row[6] : row[8] + 1]
                crop = np.where(np.isposinf(crop), crop, crop * shares)
            crops.append(crop)
            at += height * width
        found = results[order]
        kept = tuple(crops[row] for row in order.tolist())
        return AmodalMasks(
            height=lens.height,
            width=lens.width,
            ids=ids[order],
            pixels=found[:, 1],
            whole_pixels=found[:, 0],
            whole_boxes=found[:, 2:6].astype(np.int32),
            boxes=found[:, 6:].astype(np.int32),
            crops=tuple(~np.isposinf(crop) for crop in kept),
            depths=kept,
        )

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        self._drawing.close()

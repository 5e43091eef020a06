"""Objects drawn each alone, by the kernels of src/kernels/amodal.cpp.

Structures of `render_types` come in, arrays go out. One `AmodalDrawing` holds the memory that
objects are drawn in.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.render_types import DRAW_LIST, INSTANCES, PART, VIEW, address, record

__all__ = ["AmodalDrawing"]

_MAKE = Kernel("make_amodal_scratch", "array")
_FREE = Kernel("free_amodal_scratch", "array")
_DRAW = Kernel(
    "draw_amodal",
    *("integer", "array", "array", "array", "array", "array", "integer", "array"),
)
_COPY = Kernel("copy_amodal", "array", "integer", "array")

_NUMBERS = 10


class AmodalDrawing:
    """Draws objects alone; belongs to one thread at a time.

    Parameters
    ----------
    threads : int
        How many threads draw. The result does not depend on it.

    Raises
    ------
    NativeLibraryError
        If there is no native library.
    """

    def __init__(self, threads: int) -> None:
        self._threads = threads
        self._handle = np.zeros(1, np.uint64)
        _MAKE(self._handle)

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
        checked("parts", parts, PART, (None,))
        checked("starts", starts, np.int64, (None,))
        count = len(starts) - 1
        results = np.empty((count, _NUMBERS), np.int64)
        listed = record(DRAW_LIST, parts_at=address(parts), count=len(parts))
        _DRAW(
            *(self._threads, self._handle, view, instances, listed),
            *(starts, count, results),
        )
        boxes = results[results[:, 1] > 0, 6:]
        size = int(((boxes[:, 2] - boxes[:, 0] + 1) * (boxes[:, 3] - boxes[:, 1] + 1)).sum())
        depths = np.empty(size, np.float32)
        _COPY(self._handle, size, depths)
        return results, depths

    def close(self) -> None:
        """Free the memory; a second call does nothing."""
        if self._handle[0]:
            _FREE(self._handle)

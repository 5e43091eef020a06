"""Amodal masks: what each object covers of a picture, whatever lies in front of it.

Made by `render.cpu.amodal_renderer`, read out of messages; goes to tables, files and windows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.truth.rows_by_id import RowsById

__all__ = ["NO_BOX", "AmodalMasks"]

NO_BOX = (-1, -1, -1, -1)
"""The box of what covers no pixel."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AmodalMasks(RowsById):
    """Amodal masks of one frame: the pixels of each object, drawn alone.

    The canvas has three times the picture's width and height, with the picture in its middle: what
    of an object lies farther outside is not counted.

    Attributes
    ----------
    height, width : int
        Of the picture [px].
    ids : (N,) uint16
        Instance ids, ascending.
    pixels : (N,) int64
        Pixels that the object covers in the picture.
    whole_pixels : (N,) int64
        Pixels that it covers on the canvas.
    boxes, whole_boxes : (N, 4) int32
        Around the ones and the others: left, top, right, bottom [px], the last ones included;
        -1 for none. Those on the canvas may lie beside the picture.
    crops : tuple of (h, w) bool
        Mask of each object in its box in the picture; (0, 0) for none.
    depths : tuple of (h, w) float32 or None
        Its depth there, along the optical axis [m]; ``inf`` where it is not, NaN where it is
        nearer than the near plane. None if it was not kept.
    """

    height: int
    width: int
    ids: NDArray[np.uint16]
    pixels: NDArray[np.int64]
    whole_pixels: NDArray[np.int64]
    boxes: NDArray[np.int32]
    whole_boxes: NDArray[np.int32]
    crops: tuple[NDArray[np.bool_], ...]
    depths: tuple[NDArray[np.float32], ...] | None = None

    def __len__(self) -> int:
        return len(self.ids)

    def mask(self, instance_id: int) -> NDArray[np.bool_]:
        """Return where an object is: (H, W) bool, a new array."""
        row = self.row(instance_id)
        mask = np.zeros((self.height, self.width), bool)
        mask[self._place(row)] = self.crops[row]
        return mask

    def depth(self, instance_id: int) -> NDArray[np.float32]:
        """Return how far an object is: (H, W) float32 [m], ``inf`` where it is not; a new array.

        Raises
        ------
        InvalidState
            If depths were not kept, as in messages and recordings.
        """
        row = self.row(instance_id)
        if self.depths is None:
            raise InvalidState(
                "amodal depth is not sent or recorded; take it from a frame of a Simulation"
            )
        depth = np.full((self.height, self.width), np.inf, np.float32)
        depth[self._place(row)] = self.depths[row]
        return depth

    def _place(self, row: int) -> tuple[slice, slice]:
        left, top, right, bottom = self.boxes[row].tolist()
        if left < 0:
            return slice(0, 0), slice(0, 0)
        return slice(top, bottom + 1), slice(left, right + 1)

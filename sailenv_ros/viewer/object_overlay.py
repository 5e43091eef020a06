"""Overlay of a frame's objects on the page: boxes, boxes in space, a whole object's outline.

`Frame` in, JSON out.
"""

from __future__ import annotations

import numpy as np

from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.object_table import EDGES
from sailenv_ros.viewer.encoding import outline
from sailenv_ros.viewer.messages import Overlay

__all__ = ["overlay_of"]


def overlay_of(frame: Frame, *, boxes: bool, space: bool, whole: int) -> Overlay:
    """Return what is drawn over a frame.

    Parameters
    ----------
    frame : Frame
    boxes : bool
        Whether the boxes of what is visible are wanted.
    space : bool
        Whether the oriented boxes are.
    whole : int
        Instance whose amodal outline is wanted, 0 for none.

    Returns
    -------
    overlay : Overlay
        Edges are those that lie before the camera.
    """
    told: Overlay = {"boxes": [], "edges": [], "whole": []}
    if boxes or space:
        table = frame.objects.select(frame.objects.visible)
        if boxes:
            rows = np.concatenate([table.ids[:, None], table.visible_boxes], axis=1)
            told["boxes"] = rows.tolist()
        if space:
            corners = np.round(table.corner_pixels, 1)
            for row, id_ in enumerate(table.ids.tolist()):
                ends = [np.concatenate(corners[row, list(edge)]) for edge in EDGES]
                seen = [end.tolist() for end in ends if np.isfinite(end).all()]
                told["edges"].append((id_, seen))
    if whole:
        mask = frame.amodal_of(whole).mask(whole)
        told["whole"] = outline(mask.astype(np.uint16), 1)
    return told

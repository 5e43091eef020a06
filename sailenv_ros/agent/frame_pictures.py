"""The dict of one frame as pictures for people: a labelled RGB picture of each of its views."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame import VIEWS
from sailenv_ros.labels import CategoryTable
from sailenv_ros.pictures.colours import view_picture

__all__ = ["frame_pictures"]

_KEYS = {"main": "rgb", "depth_m": "depth", "category": "category", "instance": "instance"}


def frame_pictures(
    frame: Mapping[str, Any], table: CategoryTable, *, depth_range_m: float = 10.0
) -> dict[str, NDArray[np.uint8]]:
    """Show every view of a frame.

    Parameters
    ----------
    frame : mapping
        As `frame_dict` makes it.
    table : CategoryTable
        Colours of the categories.
    depth_range_m : float
        Depth that is shown as black [m].

    Returns
    -------
    pictures : dict of str to (H, W, 3) uint8
        RGB, labelled by the frame's own keys.
    """
    pictures = {}
    for key, values in frame.items():
        view = _KEYS.get(key, key)
        if key == "flow_valid" and np.all(values):
            continue  # nothing to see: every pixel has a flow
        if view in VIEWS and key not in ("depth", "rgb"):
            shown = values[..., ::-1] if key == "main" else values
            label = {"depth_m": "depth", "instance": "object"}.get(key, key)
            pictures[label] = view_picture(view, shown, table=table, depth_range_m=depth_range_m)
    return pictures

"""Pictures of a frame's views for people, and boxes for detectors, from a frame's dict."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import UnknownName
from sailenv_ros.frame.pictures.colours import colour_categories, colour_flow, view_picture
from sailenv_ros.frame.truth.visible_parts import VisibleParts, visible_parts
from sailenv_ros.simulation.operations.operation import Caller
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import VIEWS

__all__ = ["FramePictures", "frame_pictures"]

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
        if view not in VIEWS or key == "depth":
            continue  # no view; the same as `depth_m`
        if VIEWS[view].validity_of and np.all(values):
            continue  # nothing to see: every pixel has a value
        shown = values[..., ::-1] if key == "main" else values
        label = {"depth_m": "depth", "instance": "object"}.get(key, key)
        pictures[label] = view_picture(view, shown, table=table, depth_range_m=depth_range_m)
    return pictures


class FramePictures(Caller):
    """Pictures of frames for people, and boxes for detectors."""

    def save_contact_sheet(
        self, path: str | Path, frame: Mapping[str, Any], *, boxes: bool = False
    ) -> Path:
        """Write all views of a frame as one labelled PNG file; return its path.

        With `boxes` the picture shows the box and the category of each object that is visible.
        """
        # They need Pillow and OpenCV.
        from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
        from sailenv_ros.frame.pictures.object_pictures import draw_boxes

        ranges = {spec.name: spec.depth_range_m for spec in self.info.agents}
        table, range_m = self.info.categories, ranges.get(self.own_agent or "", 10.0)
        pictures = frame_pictures(frame, table, depth_range_m=range_m)
        if boxes and "main" in pictures:
            known = frame.get("instances", {})
            names = {id_: instance.category for id_, instance in known.items()}
            pictures["main"] = draw_boxes(pictures["main"], self.boxes(frame), names)
        return save_contact_sheet(path, pictures)

    def colour_categories(self, category: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Show a category view as (H, W, 3) uint8 BGR, each category in its own colour."""
        return _reversed(colour_categories(category, self.info.categories))

    @staticmethod
    def draw_flow_map(
        flow: NDArray[np.float32], *, full_px_s: float | None = None
    ) -> NDArray[np.uint8]:
        """Show a flow view as (H, W, 3) uint8 BGR: hue by direction, value by speed.

        Parameters
        ----------
        flow : (H, W, 2) float32
            Velocity in the image [px/s].
        full_px_s : float or None
            Speed that is shown at full brightness [px/s]; None means the fastest of the picture.
        """
        return _reversed(colour_flow(flow, full_px_s=full_px_s))

    @staticmethod
    def boxes(frame: Mapping[str, Any]) -> VisibleParts:
        """Return the box and the number of visible pixels of each instance that is seen.

        Raises
        ------
        UnknownName
            If the frame has no instance view.
        """
        if "instance" not in frame:
            raise UnknownName("view of the frame", "instance", [k for k in frame if k != "sizes"])
        return visible_parts(frame["instance"])


def _reversed(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Exchange red and blue, into a picture that OpenCV takes as it is."""
    return np.ascontiguousarray(picture[..., ::-1])

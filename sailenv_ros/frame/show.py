"""Showing a frame: in a notebook below the cell, elsewhere as a PNG file."""

from __future__ import annotations

import importlib
import os
import sys
import tempfile
import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.html import frame_html, tiles_html, view_pictures
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
from sailenv_ros.frame.pictures.object_pictures import (
    draw_amodal_outlines,
    draw_boxes,
    draw_boxes_in_space,
)
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import VIEWS

__all__ = ["show"]

_VIEW_OF_KEY = {"main": "rgb", "depth_m": "depth"}
"""Views that an `Agent`'s dict holds under other names."""


def show(
    frame: Frame | Mapping[str, Any],
    path: str | Path | None = None,
    *,
    categories: CategoryTable | None = None,
    objects: bool = False,
) -> Path | None:
    """Show all views of a frame: in a notebook below the cell, elsewhere as a PNG file.

    Outside of a notebook the file is opened in the desktop's viewer if no path is given and there
    is a desktop.

    Parameters
    ----------
    frame : Frame or mapping
        A frame, or the dict that `Agent.get_frame` returns.
    path : str, Path or None
        File to write, ``.png`` or ``.jpg``. None writes one only outside of a notebook, into the
        folder for temporary files.
    categories : CategoryTable or None
        Colours of the categories; None takes the fixed table.
    objects : bool
        True shows what is known of a `Frame`'s objects too: boxes, boxes in space, and the
        outlines of whole objects where they can be drawn.

    Returns
    -------
    path : Path or None
        The file that was written; None if there is none.

    Raises
    ------
    InvalidRequest
        If the frame has no view, or the name of the file does not end in ``.png`` or ``.jpg``.
    """
    pictures = view_pictures(_views(frame), categories)
    if objects and isinstance(frame, Frame):
        pictures |= _object_pictures(frame)
    if not pictures:
        raise InvalidRequest("frame", type(frame).__name__, "a frame with at least one view")
    written = None if path is None else save_contact_sheet(path, pictures)
    if _in_a_notebook():
        if isinstance(frame, Frame) and not objects:
            text = frame_html(frame, categories=categories)
        else:
            text = tiles_html(pictures)
        display = importlib.import_module("IPython.display")
        display.display(display.HTML(text))
        return written
    if written is None:
        handle, name = tempfile.mkstemp(prefix="sailenv_frame_", suffix=".png")
        os.close(handle)
        written = save_contact_sheet(name, pictures)
        if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
            webbrowser.open(written.as_uri())
    return written


def _object_pictures(frame: Frame) -> dict[str, NDArray[np.uint8]]:
    """Return the picture with what is known of the objects drawn over it."""
    below = frame.views.get("rgb")
    if below is None:
        height, width = frame.camera.intrinsics.height, frame.camera.intrinsics.width
        below = np.zeros((height, width, 3), np.uint8)
    pictures = {
        "boxes": draw_boxes(below, frame.objects),
        "boxes in space": draw_boxes_in_space(below, frame.objects),
    }
    if frame.draw_amodal is not None:
        shown = frame.objects.select(frame.objects.visible)
        pictures["whole objects"] = draw_amodal_outlines(below, frame.amodal, shown.ids.tolist())
    return pictures


def _views(frame: Frame | Mapping[str, Any]) -> Mapping[str, NDArray[Any]]:
    if isinstance(frame, Frame):
        return frame.views
    views = {}
    for key, values in frame.items():
        view = _VIEW_OF_KEY.get(key, key)
        # The dict's own "depth" is an 8-bit picture.
        if view in VIEWS and key != "depth":
            views[view] = values[..., ::-1] if key == "main" else values
    return views


def _in_a_notebook() -> bool:
    """Return whether this is a kernel that shows HTML; a terminal with IPython is none."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None

"""Frames and scenes as HTML for notebooks, and `show`, which shows a frame wherever it is called.

`Frame`s and `SceneInfo`s in, HTML with embedded pictures or a PNG file out. Works without IPython.
Importing this module makes frames display themselves in notebooks.
"""

from __future__ import annotations

import base64
import html
import importlib
import io
import os
import sys
import tempfile
import webbrowser
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame import VIEWS, Frame
from sailenv_ros.labels import CategoryTable
from sailenv_ros.object_truth.object_table import ObjectTable
from sailenv_ros.pictures.colours import view_picture
from sailenv_ros.pictures.contact_sheet import save_contact_sheet
from sailenv_ros.pictures.object_pictures import (
    draw_amodal_outlines,
    draw_boxes,
    draw_boxes_in_space,
)
from sailenv_ros.scene_info import SceneInfo

__all__ = ["frame_html", "objects_html", "scene_html", "show"]

TILE_WIDTH_PX = 320
"""Larger views are shown at this width."""

_VIEW_OF_KEY = {"main": "rgb", "depth_m": "depth"}
"""Views that an `Agent`'s dict holds under other names."""


def frame_html(frame: Frame, *, categories: CategoryTable | None = None) -> str:
    """Return a frame as HTML: a line about it, and its views as pictures.

    Parameters
    ----------
    frame : Frame
    categories : CategoryTable or None
        Colours of the categories; None takes the fixed table, in which categories that a scene
        defines are grey.

    Returns
    -------
    text : str
        Needs no other file.
    """
    lens = frame.camera.intrinsics
    about = (
        f"{frame.agent} in {frame.scene}: frame {frame.sequence}, "
        f"t = {frame.stamp_ns * 1e-9:.3f} s, Δt = {frame.dt_s:.3f} s, "
        f"{lens.width} × {lens.height} px"
    )
    pictures = _pictures(frame, categories)
    tiles = "".join(_tile(name, picture) for name, picture in pictures.items())
    return (
        f'<div><p style="margin:0 0 4px"><b>Frame</b> {html.escape(about)}</p>'
        f'<div style="display:flex;flex-wrap:wrap;gap:6px">{tiles}</div></div>'
    )


def scene_html(title: str, info: SceneInfo) -> str:
    """Return a table of what is simulated.

    Parameters
    ----------
    title : str
        E.g. the name of the class that is shown.
    info : SceneInfo
    """
    agents = (
        f"{a.name} ({a.intrinsics.width} × {a.intrinsics.height} px: {', '.join(a.views)})"
        for a in info.agents
    )
    rows = {
        "scene": info.scene,
        "time": f"{info.mode}{', paused' if info.paused else ''}, seed {info.seed}",
        "agents": _listed(agents),
        "objects": str(len(info.instances)),
        "lights": _listed(light.name for light in info.lights),
        "movers": _listed(f"{mover.name} ({mover.controller})" for mover in info.movers),
        "renderer": info.renderer,
    }
    cells = "".join(
        f'<tr><th style="text-align:left">{name}</th>'
        f'<td style="text-align:left">{html.escape(value)}</td></tr>'
        for name, value in rows.items()
    )
    return f"<div><p><b>{html.escape(title)}</b></p><table>{cells}</table></div>"


def objects_html(table: ObjectTable) -> str:
    """Return a table of objects as HTML: those that are visible first, the largest first.

    Parameters
    ----------
    table : ObjectTable
    """
    order = np.argsort(-table.visible_pixels, kind="stable").tolist()
    shares, truncated = table.visible_share, table.truncated_share
    heads = ("id", "name", "category", "pixels", "box", "visible", "truncated", "distance", "size")
    rows = [
        (
            str(table.ids[row]),
            table.names[row],
            table.categories[row],
            str(table.visible_pixels[row]) if table.visible_pixels[row] else "",
            ", ".join(map(str, table.visible_boxes[row])) if table.visible_pixels[row] else "",
            _percent(shares[row]),
            _percent(truncated[row]),
            "" if np.isnan(table.distances[row]) else f"{table.distances[row]:.2f} m",
            " × ".join(f"{side:.2f}" for side in table.box_sizes[row]) + " m",
        )
        for row in order
    ]
    head = "".join(f'<th style="text-align:left">{name}</th>' for name in heads)
    body = "".join(
        "<tr>"
        + "".join(f'<td style="text-align:left">{html.escape(value)}</td>' for value in row)
        + "</tr>"
        for row in rows
    )
    seen = int(table.visible.sum())
    about = f"{len(table)} objects, {seen} of them visible"
    return f"<div><p><b>{about}</b></p><table><tr>{head}</tr>{body}</table></div>"


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
    pictures = _pictures(frame, categories)
    if objects and isinstance(frame, Frame):
        pictures |= _object_pictures(frame)
    if not pictures:
        raise InvalidRequest("frame", type(frame).__name__, "a frame with at least one view")
    written = None if path is None else save_contact_sheet(path, pictures)
    if _in_a_notebook():
        if isinstance(frame, Frame) and not objects:
            text = frame_html(frame, categories=categories)
        else:
            tiles = "".join(_tile(name, picture) for name, picture in pictures.items())
            text = f'<div style="display:flex;flex-wrap:wrap;gap:6px">{tiles}</div>'
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


def _pictures(
    frame: Frame | Mapping[str, Any], categories: CategoryTable | None
) -> dict[str, NDArray[np.uint8]]:
    """Return (H, W, 3) RGB pictures of all views, by their names."""
    table = load_categories() if categories is None else categories
    return {name: view_picture(name, values, table=table) for name, values in _views(frame).items()}


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


def _views(frame: Frame | Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    if isinstance(frame, Frame):
        return {name: frame.views[name] for name in VIEWS if name in frame.views}
    views = {}
    for key, values in frame.items():
        view = _VIEW_OF_KEY.get(key, key)
        # The dict's own "depth" is an 8-bit picture.
        if view in VIEWS and key != "depth":
            views[view] = values[..., ::-1] if key == "main" else values
    return views


def _tile(name: str, picture: NDArray[np.uint8]) -> str:
    image = Image.fromarray(np.ascontiguousarray(picture))
    if image.width > TILE_WIDTH_PX:
        size = (TILE_WIDTH_PX, max(1, round(image.height * TILE_WIDTH_PX / image.width)))
        # The colours of ids mean something: they are not mixed.
        kind = Image.Resampling.LANCZOS if name == "rgb" else Image.Resampling.NEAREST
        image = image.resize(size, kind)
    data = io.BytesIO()
    image.save(data, format="PNG")
    text = base64.b64encode(data.getvalue()).decode("ascii")
    label = html.escape(name)
    return (
        f'<figure style="margin:0"><img alt="{label}" width="{image.width}" '
        f'height="{image.height}" src="data:image/png;base64,{text}">'
        f"<figcaption>{label}</figcaption></figure>"
    )


def _percent(share: float) -> str:
    return "" if np.isnan(share) else f"{100.0 * share:.0f} %"


def _listed(names: Iterable[str], most: int = 8) -> str:
    every = list(names)
    more = f" and {len(every) - most} more" if len(every) > most else ""
    return (", ".join(every[:most]) + more) or "none"


def _in_a_notebook() -> bool:
    """Return whether this is a kernel that shows HTML; a terminal with IPython is none."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None

"""Frames and scenes as HTML, for notebooks."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.frame.data import FrameData
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import VIEWS

__all__ = ["frame_html", "scene_html", "tiles_html", "view_pictures"]

TILE_WIDTH_PX = 320
"""Larger views are shown at this width."""


def frame_html(frame: FrameData, *, categories: CategoryTable | None = None) -> str:
    """Return a frame as HTML: a line about it, and its views as pictures.

    Parameters
    ----------
    frame : FrameData
    categories : CategoryTable or None
        Colours of the categories; None takes the fixed table, in which categories that a scene
        defines are grey.

    Returns
    -------
    text : str
        Needs no other file.
    """
    pictures = view_pictures(frame, categories)
    return (
        f'<div><p style="margin:0 0 4px"><b>Frame</b> {html.escape(frame.about)}</p>'
        f"{tiles_html(pictures)}</div>"
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


def view_pictures(
    views: Mapping[str, NDArray[Any]], categories: CategoryTable | None
) -> dict[str, NDArray[np.uint8]]:
    """Return (H, W, 3) RGB pictures of all views of a frame, by their names, in one order.

    Parameters
    ----------
    views : mapping of str to array
        A frame, or the views that the dict of `Agent.get_frame` has.
    categories : CategoryTable or None
        Colours of the categories; None takes the fixed table.
    """
    table = load_categories() if categories is None else categories
    return {name: view_picture(name, views[name], table=table) for name in VIEWS if name in views}


def tiles_html(pictures: Mapping[str, NDArray[np.uint8]]) -> str:
    """Return pictures side by side as HTML, each with its name below."""
    tiles = "".join(_tile(name, picture) for name, picture in pictures.items())
    return f'<div style="display:flex;flex-wrap:wrap;gap:6px">{tiles}</div>'


def _tile(name: str, picture: NDArray[np.uint8]) -> str:
    from PIL import Image

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


def _listed(names: Iterable[str], most: int = 8) -> str:
    every = list(names)
    more = f" and {len(every) - most} more" if len(every) > most else ""
    return (", ".join(every[:most]) + more) or "none"

"""Data set → one HTML page to look at it: frames with masks and boxes, filters, counts.

The page needs no server and nothing from elsewhere. It comes from files that others may have
made: their texts are data to the page's one script, which a policy of the page names by its hash.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping
from functools import lru_cache
from html import escape
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.dataset.content_counts import ContentCounts, content_counts
from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.formats.annotated_objects import NO_CATEGORY
from sailenv_ros.dataset.formats.object_records import object_record
from sailenv_ros.dataset.manifest import done_shards
from sailenv_ros.dataset.merging import frame_records
from sailenv_ros.dataset.opening import open_dataset
from sailenv_ros.dataset.reader import Dataset, DatasetFrame
from sailenv_ros.dataset.shown_frames import shown_frames, shown_views
from sailenv_ros.frame.pictures.codecs import encode_jpeg, encode_png
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.system.files import storage_errors, write_file
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import VIEWS

__all__ = ["preview_html", "save_preview"]

PARTS = Path(__file__).with_name("preview")

PICTURE_WIDTH = 640
OTHER_WIDTH = 480
"""Largest widths of the picture, and of the other views [px]."""

OUTLINE_ERROR_PX = 0.7
"""Greatest error of a simplified outline [px]."""

HUES = 997

ROOM_PARTS = frozenset(("floor", "wall", "ceiling", "skirting"))
"""Categories that are everywhere: the page draws them over pictures only if it is told to."""


def save_preview(folder: str | Path, path: str | Path, *, split: str = "", frames: int = 36) -> int:
    """Write the page of a data set.

    Parameters
    ----------
    folder : str or Path
        Of the data set.
    path : str or Path
        An HTML file.
    split : str
        Frames of that one alone; empty for all. What is counted is the whole.
    frames : int
        At most so many, from all over the data set.

    Returns
    -------
    count : int
        Frames that are shown.

    Raises
    ------
    RecordingError
        If the data set cannot be read, or has no frames.
    StorageError
        If the page cannot be written.
    """
    with open_dataset(folder, split) as dataset:
        numbers = shown_frames(dataset, frames)
        page = preview_html(dataset, numbers)
    with storage_errors("the page", Path(path)):
        write_file(Path(path), page.encode())
    return len(numbers)


def preview_html(dataset: Dataset, numbers: list[int]) -> str:
    """Return the page that shows these frames of a data set."""
    storage = FolderStorage(dataset.folder)
    shards = done_shards(storage)
    counts = content_counts(frame_records(storage, shards))
    table = load_categories()
    views = shown_views(dataset, VIEWS)
    total_bytes = sum(file.bytes for one in shards.values() for file in one.files.values())
    told = {
        "views": views,
        "splits": _rows(counts.frames),
        "scenes": _rows(counts.scenes),
        "categories": [
            {**row, "colour": _colour(row["name"], table), "told": _in_frames(row["name"], counts)}
            for row in _rows(counts.objects)
        ],
        "frames": [_frame(dataset[number], views, table) for number in numbers],
    }
    recipe = dataset.recipe
    line = (
        f"{sum(counts.frames.values())} frames · {sum(counts.objects.values())} objects of "
        f"{len(counts.objects)} categories · {len(counts.scenes)} scenes · "
        f"{total_bytes / 1e6:.0f} MB as {', '.join(recipe.formats)}"
    )
    return _page(recipe.name, recipe.description.strip(), line, told, counts)


def _rows(counts: Mapping[str, int]) -> list[dict[str, Any]]:
    ordered = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
    return [{"name": name, "count": count} for name, count in ordered]


def _in_frames(category: str, counts: ContentCounts) -> str:
    return f"in {counts.frames_with[category]} frames"


# -- one frame ---------------------------------------------------------------------------------


def _frame(one: DatasetFrame, views: list[str], table: CategoryTable) -> dict[str, Any]:
    frame = one.frame
    instance = frame.views.get("instance")
    return {
        "number": one.number,
        "split": one.split,
        "clip": one.clip,
        "time": one.time,
        "camera": one.camera,
        "scene": frame.scene,
        "width": frame.camera.intrinsics.width,
        "height": frame.camera.intrinsics.height,
        "pictures": {view: _picture(view, frame[view], table) for view in views},
        "objects": [
            {
                "name": record["name"],
                "category": record["category"],
                "colour": _colour(record["category"], table),
                "room": record["category"] in ROOM_PARTS,
                "box": record["box"],
                "pixels": record["visible_pixels"],
                "share": record["visible_share"],
                "distance": record["distance"],
                "outline": "" if instance is None else _outline(instance, record),
            }
            for record in sorted(_objects(one), key=lambda record: -record["visible_pixels"])
        ],
    }


def _objects(one: DatasetFrame) -> list[Mapping[str, Any]]:
    """Return the records of the visible objects that have a category."""
    if one.objects or one.frame.info is None or "instance" not in one.frame.views:
        return list(one.objects)
    table = one.frame.objects
    labelled = table.select(table.visible & ~np.isin(table.category_ids, NO_CATEGORY))
    return [object_record(labelled, row) for row in range(len(labelled))]


def _outline(instance: NDArray[np.uint16], record: Mapping[str, Any]) -> str:
    """Return the SVG path around what is visible of an object, its holes left out."""
    left, top, right, bottom = record["box"]
    mask = (instance[top : bottom + 1, left : right + 1] == record["id"]).astype(np.uint8)
    contours, _ = cv2.findContours(
        mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE, offset=(left, top)
    )
    path = []
    for contour in contours:
        corners = cv2.approxPolyDP(contour, OUTLINE_ERROR_PX, closed=True).reshape(-1, 2)
        if len(corners) > 2:
            path.append("M" + "L".join(f"{x} {y}" for x, y in corners.tolist()) + "Z")
    return "".join(path)


def _picture(view: str, values: NDArray[Any], table: CategoryTable) -> str:
    """Return a view as a picture that stands in the page itself."""
    colours = view_picture(view, values, table=table)
    height, width = colours.shape[:2]
    most = PICTURE_WIDTH if view == "rgb" else OTHER_WIDTH
    labels = VIEWS[view].is_label
    if width > most:
        method = cv2.INTER_NEAREST if labels else cv2.INTER_AREA
        size = most, max(1, round(height * most / width))
        colours = np.asarray(cv2.resize(colours, size, interpolation=method), np.uint8)
    kind, data = (
        ("png", encode_png(colours)) if labels else ("jpeg", encode_jpeg(colours, quality=85))
    )
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


@lru_cache(maxsize=4096)
def _hue(name: str) -> int:
    digest = hashlib.blake2b(name.encode(), digest_size=4).digest()
    return int.from_bytes(digest, "big") % HUES * 360 // HUES


def _colour(category: str, table: CategoryTable) -> str:
    """Return a category's colour, as its view has it; one of its own for what the scene added."""
    if category in {one.name for one in table.values()}:
        red, green, blue = table.named(category).colour
        return f"#{red:02x}{green:02x}{blue:02x}"
    return f"hsl({_hue(category)} 70% 55%)"


# -- the page ----------------------------------------------------------------------------------


def _page(
    name: str, description: str, line: str, told: Mapping[str, Any], counts: ContentCounts
) -> str:
    style = (PARTS / "preview.css").read_text(encoding="utf-8")
    script = (PARTS / "preview.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = (
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
        f"script-src 'sha256-{digest}'"
    )
    # Within a script element only this could end it.
    data = json.dumps(told).replace("<", "\\u003c")
    drawings = "".join(
        f'<img class="histogram" alt="{escape(kind)}" src="data:image/svg+xml;base64,'
        f'{base64.b64encode(drawing.encode()).decode()}">'
        for kind, drawing in counts.histograms().items()
    )
    about = f"<p>{escape(description)}</p>" if description else ""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(name)} – data set</title>
<style>
{style}</style>
</head>
<body>
<header>
<div><h1>{escape(name)}</h1><p>{escape(line)}</p>{about}</div>
<span class="spread"></span>
<div class="group" id="views"></div>
<div class="group">
<label><input type="checkbox" id="masks" checked>masks</label>
<label><input type="checkbox" id="boxes" checked>boxes</label>
<label><input type="checkbox" id="names" checked>names</label>
<label title="walls, floors, ceilings"><input type="checkbox" id="room">room</label>
</div>
</header>
<aside id="lists"><h2>Objects</h2>{drawings}</aside>
<main>
<p class="told" id="shown"></p>
<div class="grid" id="frames"></div>
<p class="nothing" id="nothing" hidden>No frame on this page has all of that.</p>
</main>
<dialog id="large">
<div class="large">
<div class="bar"><span class="title" id="large-title"></span>
<button id="before" title="the frame before (←)">←</button>
<button id="after" title="the next frame (→)">→</button>
<button id="close" title="close (Esc)">Close</button></div>
<div class="left" id="large-left"></div>
<div class="right" id="large-right"></div>
</div>
</dialog>
<script type="application/json" id="told">{data}</script>
<script>{script}</script>
</body>
</html>
"""

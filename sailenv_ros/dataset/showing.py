"""Data set → a sheet of some of its frames, all views beside each other."""

from __future__ import annotations

from pathlib import Path

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.dataset.opening import open_dataset
from sailenv_ros.dataset.shown_frames import shown_frames, shown_views
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet

__all__ = ["save_sheet"]

TILE_WIDTH = 320
SHOWN_VIEWS = ("rgb", "depth", "instance", "category", "flow", "normals")


def save_sheet(folder: str | Path, path: str | Path, *, split: str = "", frames: int = 12) -> int:
    """Write a contact sheet: a row for each of some frames from all over the data set.

    Parameters, result and errors are those of `preview_page.save_preview`; `path` is a PNG or JPEG
    file.
    """
    pictures = {}
    with open_dataset(folder, split) as dataset:
        numbers = shown_frames(dataset, frames)
        views = shown_views(dataset, SHOWN_VIEWS)
        table = load_categories()
        for number in numbers:
            one = dataset[number]
            for view in views:
                label = f"{one.number} {one.split} {one.frame.scene}" if view == "rgb" else view
                picture = view_picture(view, one.frame[view], table=table)
                # A label is a key: the same view stands in each row.
                pictures[label + " " * (1 + number)] = picture
    save_contact_sheet(path, pictures, columns=len(views), tile_width=TILE_WIDTH)
    return len(numbers)

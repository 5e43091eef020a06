"""A frame as the page takes it: one binary message of a JSON head and a picture of each view.

`Frame` in, bytes out. The picture is a JPEG, of ids a PNG, which loses nothing. The message begins
with the head's length (4 bytes, little-endian); the pictures follow in the order of the head.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.codecs import encode_jpeg, encode_png
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.frame.pictures.contact_sheet import contact_sheet
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import view_spec
from sailenv_ros.viewer.messages import FileHead, FrameForAll, FrameForClient, ViewInfo
from sailenv_ros.viewer.scene_json import lens_to_json

__all__ = ["FrameMessages", "outline", "packed", "sheet_png", "view_png", "views_to_json"]

JPEG_QUALITY = 85

SPECK_PX = 6.0
"""Area of the smallest hole or island that an outline goes around [px²]."""


class FrameMessages:
    """Messages of one frame for all who watch it: what they share is made once.

    Parameters
    ----------
    frame : Frame
        Its instance view, if any, tells what is visible.
    categories : CategoryTable
    depth_range_m : float
        Depth that is shown as black [m].
    """

    def __init__(self, frame: Frame, *, categories: CategoryTable, depth_range_m: float) -> None:
        self.frame = frame
        self._categories = categories
        self._depth_range_m = depth_range_m
        self._pictures: dict[str, tuple[str, bytes]] = {}
        self._about = _head_of(frame)

    def message(
        self, views: Sequence[str], *, number: int, selected: int = 0, dropped: int = 0
    ) -> bytes:
        """Write it for one client.

        Parameters
        ----------
        views : sequence of str
            Views that the frame has.
        number : int
            By which the page asks for its values and says that it has shown it.
        selected : int
            Instance whose outline is told; 0 for none.
        dropped : int
            How many frames were not sent before it because the page had not shown those it had.
        """
        pictures = [self._picture(view) for view in views]
        head: FrameForClient = {
            "number": number,
            "dropped": dropped,
            "views": [
                {"name": view, "mime": mime, "size": len(data)}
                for view, (mime, data) in zip(views, pictures, strict=True)
            ],
        }
        if "instance" in self.frame.views:
            head["outline"] = self._outline(selected) if selected else []
        text = f"{_json(head)[:-1]},{self._about[1:]}"
        return _packed(text, (data for _, data in pictures))

    def _outline(self, selected: int) -> list[list[int]]:
        """Return the lines around an instance and the parts of its model."""
        own, info = [selected], self.frame.info
        if info is not None:
            own += [one.id for one in info.instances if one.is_part and one.parent == selected]
        return outline(np.isin(self.frame["instance"], own).astype(np.uint16), 1)

    def _picture(self, view: str) -> tuple[str, bytes]:
        if view not in self._pictures:
            self._pictures[view] = _encoded(self.frame, view, self._categories, self._depth_range_m)
        return self._pictures[view]


def packed(head: FileHead, pieces: Iterable[bytes] = ()) -> bytes:
    """Put a head and what belongs to it into one message."""
    return _packed(_json(head), pieces)


def _packed(head: str, pieces: Iterable[bytes]) -> bytes:
    data = head.encode()
    return b"".join([len(data).to_bytes(4, "little"), data, *pieces])


def _json(value: Mapping[str, object]) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def _head_of(frame: Frame) -> str:
    """Write what every client is told of a frame, as JSON."""
    lens = frame.camera.intrinsics
    head: FrameForAll = {
        "type": "frame",
        "agent": frame.agent,
        "scene": frame.scene,
        "epoch": frame.epoch,
        "revision": frame.revision,
        "sequence": frame.sequence,
        "time_s": frame.stamp_ns * 1e-9,
        "width": lens.width,
        "height": lens.height,
        "fov_deg": lens.vertical_fov_deg,
        "lens": lens_to_json(lens),
        "position": frame.camera.pose.position_m,
        "rpy_deg": frame.camera.pose.rpy_deg,
        "lesson": "" if frame.lesson is None else str(frame.lesson),
        "timings_ms": {name: 1e3 * seconds for name, seconds in frame.timings_s.items()},
    }
    if "instance" in frame.views:
        counts = np.bincount(frame["instance"].reshape(-1))
        ids = np.flatnonzero(counts[1:]) + 1
        head["visible"] = np.stack([ids, counts[ids]], axis=-1).tolist()
    return _json(head)


def views_to_json(views: Iterable[str]) -> list[ViewInfo]:
    """Return what the page must know of views: which are shown at first, how values are written.

    Parameters
    ----------
    views : iterable of str
        Names in `sailenv_ros.types.views.VIEWS`, in the order in which the page lays them out.
    """
    return [
        {
            "name": spec.name,
            "meaning": spec.meaning,
            "unit": spec.unit,
            "display": spec.display,
            "shown": spec.by_default,
        }
        for spec in map(view_spec, views)
    ]


def view_png(frame: Frame, view: str, *, categories: CategoryTable, depth_range_m: float) -> bytes:
    """Return one view's picture as a PNG file."""
    return encode_png(_picture(frame, view, categories, depth_range_m))


def sheet_png(
    frame: Frame, views: Sequence[str], *, categories: CategoryTable, depth_range_m: float
) -> bytes:
    """Return several views' pictures on one sheet, labelled, as a PNG file."""
    pictures = {view: _picture(frame, view, categories, depth_range_m) for view in views}
    return encode_png(contact_sheet(pictures))


def outline(instance: NDArray[np.uint16], number: int) -> list[list[int]]:
    """Return the closed lines around an instance's pixels: u, v, u, v, … of each [px].

    Specks beside the largest of them are left out.
    """
    mask = (instance == number).astype(np.uint8)
    lines, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)
    areas = [cv2.contourArea(line) for line in lines]
    least = min(SPECK_PX, max(areas, default=0.0))
    kept = (line for line, area in zip(lines, areas, strict=True) if area >= least)
    return [line.reshape(-1).tolist() for line in kept]


def _picture(
    frame: Frame, view: str, categories: CategoryTable, depth_range_m: float
) -> NDArray[np.uint8]:
    return view_picture(
        view,
        frame[view],
        table=categories,
        near_m=frame.camera.intrinsics.near_m,
        depth_range_m=depth_range_m,
    )


def _encoded(
    frame: Frame, view: str, categories: CategoryTable, depth_range_m: float
) -> tuple[str, bytes]:
    picture = _picture(frame, view, categories, depth_range_m)
    if view_spec(view).is_label:
        return "image/png", encode_png(picture, "quick")
    return "image/jpeg", encode_jpeg(picture, JPEG_QUALITY)

"""Objects drawn over a picture: boxes, boxes in space, outlines of what is hidden too."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import EDGES, ObjectTable
from sailenv_ros.frame.truth.visible_parts import VisibleParts
from sailenv_ros.types.labels import instance_colours

__all__ = ["draw_amodal_outlines", "draw_boxes", "draw_boxes_in_space"]

LEAST_LIGHT = 110
"""Lightest channel of a colour in which something is drawn; darker ones are made lighter."""

LABEL_BACK, LABEL_INK = (0, 0, 0, 150), (255, 255, 255, 255)

Rgb = NDArray[np.uint8]

_COLOURS = instance_colours()


def draw_boxes(
    picture: Rgb, objects: ObjectTable | VisibleParts, names: dict[int, str] | None = None
) -> Rgb:
    """Draw the box around what is visible of each object, in its colour.

    Parameters
    ----------
    picture : (H, W, 3) uint8
        RGB; stays as it is.
    objects : ObjectTable or VisibleParts
    names : dict of int to str or None
        Labels by instance ids; None takes the categories of a table, and none of parts.

    Returns
    -------
    rgb : (H, W, 3) uint8
    """
    if isinstance(objects, ObjectTable):
        shown = objects.select(objects.visible)
        ids, boxes = shown.ids.tolist(), shown.visible_boxes.tolist()
        labels = dict(zip(ids, shown.categories, strict=True)) if names is None else names
    else:
        ids, boxes, labels = objects.ids.tolist(), objects.corners.tolist(), names or {}
    image = Image.fromarray(picture)
    pen = ImageDraw.Draw(image, "RGBA")
    line = max(1, image.width // 400)
    font = ImageFont.load_default(size=max(9, image.width // 55))
    # The largest first, so that what is small lies above.
    order = sorted(range(len(ids)), key=lambda row: -_area(boxes[row]))
    for row in order:
        left, top, right, bottom = boxes[row]
        pen.rectangle((left, top, right, bottom), outline=_colour(ids[row]), width=line)
    for row in order:
        label = labels.get(ids[row], "")
        left, top, right, _ = boxes[row]
        if label and right - left > pen.textlength(label, font=font):
            corner = pen.textbbox((left + line, top + line), label, font=font)
            pen.rectangle(corner, fill=LABEL_BACK)
            pen.text((left + line, top + line), label, font=font, fill=LABEL_INK)
    return np.asarray(image).copy()


def draw_boxes_in_space(picture: Rgb, table: ObjectTable) -> Rgb:
    """Draw the edges of each visible object's oriented box that lie before the camera.

    Static surroundings, whose box the camera stands in, are left out.

    Returns
    -------
    rgb : (H, W, 3) uint8
    """
    drawn = np.ascontiguousarray(picture).copy()
    width = drawn.shape[1]
    line = max(1, width // 400)
    for row in np.flatnonzero(table.visible).tolist():
        corners = table.corner_pixels[row]
        if not np.isfinite(corners).all():
            continue
        # OpenCV clips lines to the picture; what is far outside would not fit its integers.
        places = np.clip(corners, -8 * width, 8 * width) * 16.0
        for a, b in EDGES:
            start, end = (tuple(np.rint(places[k]).astype(int).tolist()) for k in (a, b))
            cv2.line(drawn, start, end, _colour(int(table.ids[row])), line, cv2.LINE_AA, 4)
    return drawn


def draw_amodal_outlines(picture: Rgb, masks: AmodalMasks, ids: list[int] | None = None) -> Rgb:
    """Draw the outline of what objects cover, whatever lies in front of them.

    Parameters
    ----------
    picture : (H, W, 3) uint8
        RGB; stays as it is.
    masks : AmodalMasks
    ids : list of int or None
        Of which objects; None means all.

    Returns
    -------
    rgb : (H, W, 3) uint8
    """
    drawn = np.ascontiguousarray(picture).copy()
    line = max(1, drawn.shape[1] // 320)
    for id_ in masks.ids.tolist() if ids is None else ids:
        outlines, _ = cv2.findContours(
            masks.mask(id_).astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE
        )
        cv2.drawContours(drawn, outlines, -1, _colour(id_), line, cv2.LINE_AA)
    return drawn


def _colour(id_: int) -> tuple[int, int, int]:
    """Return the colour of an instance, light enough to be seen upon a picture."""
    red, green, blue = (int(value) for value in _COLOURS[id_])
    lift = max(0, LEAST_LIGHT - max(red, green, blue))
    return red + lift, green + lift, blue + lift


def _area(box: list[int]) -> int:
    left, top, right, bottom = box
    return (right - left + 1) * (bottom - top + 1)

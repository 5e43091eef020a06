"""The table of a frame's objects: a row for each, a column for each thing that is known of it.

Made of a `Frame` by `frame_objects`; all frames' tables have the same columns.
"""

from __future__ import annotations

import html
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.rows_by_id import RowsById
from sailenv_ros.types.labels import Keypoint

__all__ = ["CORNER_SIGNS", "EDGES", "Keypoints", "ObjectTable"]

CORNER_SIGNS: NDArray[np.float64] = np.array(
    [[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
)
"""(8, 3) sides of the box on which each corner lies: x changes most slowly, z fastest."""
CORNER_SIGNS.flags.writeable = False

EDGES: tuple[tuple[int, int], ...] = tuple(
    (a, b)
    for a in range(8)
    for b in range(a + 1, 8)
    if np.abs(CORNER_SIGNS[a] - CORNER_SIGNS[b]).sum() == 2.0
)
"""Pairs of corners that the box's twelve edges join."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Keypoints:
    """Named points of one object.

    Attributes
    ----------
    names : (K,) tuple of str
    world : (K, 3) float64
        World frame [m].
    pixels : (K, 2) float64
        Column and row in the picture [px]; NaN behind the camera.
    visible : (K,) bool
        True if it lies in the picture and nothing is seen in front of it.
    hidden_by : (K,) int64
        Id of the instance that hides it; 0 where nothing does, -1 where it is out of view.
    """

    names: tuple[str, ...]
    world: NDArray[np.float64]
    pixels: NDArray[np.float64]
    visible: NDArray[np.bool_]
    hidden_by: NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class ObjectTable(RowsById):
    """Ground truth of every object of the scene at a frame's instant, visible or not.

    Columns of the pose are NaN where the frame has no `states`, those of the instance view 0 and -1
    where it has none. Those of amodal masks are -1 and NaN but in a table made by `with_amodal`.

    Attributes
    ----------
    ids : (N,) uint16
        Instance ids, ascending.
    names, categories, assets : (N,) tuple of str
    category_ids, parents : (N,) uint16
        A parent is the id of the object that it is a part of; 0 for none.
    static : (N,) bool
    visible_pixels : (N,) int64
    visible_boxes : (N, 4) int32
        Around the visible pixels: left, top, right, bottom [px], the last ones included; -1 if
        none is visible.
    flow : (N, 2) float64
        Mean of the flow view over the visible pixels [px/s]; NaN without it.
    amodal_pixels : (N,) int64
        Pixels of the picture that it covers when nothing hides it.
    amodal_boxes : (N, 4) int32
        Around these.
    whole_pixels : (N,) int64
        Pixels that it covers on a canvas of three times the picture's width and height, in whose
        middle the picture lies.
    whole_boxes : (N, 4) int32
        Around these; may lie beside the picture.
    world_from_object, camera_from_object : (N, 4, 4) float64
        Rigid; the camera's frame is the optical one. Columns of the rotation are the axes of the
        oriented box.
    box_centres : (N, 3) float64
        Centre of the box around its mesh, world frame [m].
    box_sizes : (N, 3) float64
        Along the object's own axes [m].
    corners : (N, 8, 3) float64
        Of that box, world frame [m], in the order of `CORNER_SIGNS`.
    corner_pixels : (N, 8, 2) float64
        Column and row [px]; NaN behind the camera.
    corners_visible : (N, 8) bool
        True if it lies in the picture and nothing is seen in front of it.
    distances : (N,) float64
        From the camera to the centre of the box [m].
    linear_velocities : (N, 3) float64
        Of the object's origin, world axes [m/s].
    angular_velocities : (N, 3) float64
        World axes [rad/s].
    """

    ids: NDArray[np.uint16]
    names: tuple[str, ...]
    categories: tuple[str, ...]
    assets: tuple[str, ...]
    category_ids: NDArray[np.uint16]
    parents: NDArray[np.uint16]
    static: NDArray[np.bool_]
    visible_pixels: NDArray[np.int64]
    visible_boxes: NDArray[np.int32]
    flow: NDArray[np.float64]
    amodal_pixels: NDArray[np.int64]
    amodal_boxes: NDArray[np.int32]
    whole_pixels: NDArray[np.int64]
    whole_boxes: NDArray[np.int32]
    world_from_object: NDArray[np.float64]
    camera_from_object: NDArray[np.float64]
    box_centres: NDArray[np.float64]
    box_sizes: NDArray[np.float64]
    corners: NDArray[np.float64]
    corner_pixels: NDArray[np.float64]
    corners_visible: NDArray[np.bool_]
    distances: NDArray[np.float64]
    linear_velocities: NDArray[np.float64]
    angular_velocities: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def visible_share(self) -> NDArray[np.float64]:
        """(N,) share of its pixels in the picture that are visible; NaN if it covers none."""
        return _ratio(self.visible_pixels, self.amodal_pixels)

    @property
    def truncated_share(self) -> NDArray[np.float64]:
        """(N,) share of all its pixels that lie beside the picture; NaN if it covers none."""
        return 1.0 - _ratio(self.amodal_pixels, self.whole_pixels)

    @property
    def visible(self) -> NDArray[np.bool_]:
        """(N,) True where at least one pixel is visible."""
        seen: NDArray[np.bool_] = self.visible_pixels > 0
        return seen

    def select(self, rows: ArrayLike) -> ObjectTable:
        """Return a table of some rows: numbers of rows, or truth values."""
        picked = np.arange(len(self))[np.asarray(rows)]
        columns: dict[str, Any] = {}
        for column in fields(self):
            values = getattr(self, column.name)
            if isinstance(values, tuple):
                columns[column.name] = tuple(values[row] for row in picked.tolist())
            else:
                columns[column.name] = values[picked]
        return ObjectTable(**columns)

    def with_amodal(self, masks: AmodalMasks) -> ObjectTable:
        """Return the table with what is known of objects that were drawn alone.

        Parameters
        ----------
        masks : AmodalMasks
            Of the same frame; objects that it lacks have -1.
        """
        count = len(self)
        amodal, whole = np.full(count, -1, np.int64), np.full(count, -1, np.int64)
        amodal_boxes = np.full((count, 4), -1, np.int32)
        whole_boxes = np.full((count, 4), -1, np.int32)
        rows = np.searchsorted(self.ids, masks.ids)
        known = rows < count
        known[known] = self.ids[rows[known]] == masks.ids[known]
        own = rows[known]
        amodal[own], whole[own] = masks.pixels[known], masks.whole_pixels[known]
        amodal_boxes[own], whole_boxes[own] = masks.boxes[known], masks.whole_boxes[known]
        return replace(
            self,
            amodal_pixels=amodal,
            amodal_boxes=amodal_boxes,
            whole_pixels=whole,
            whole_boxes=whole_boxes,
        )

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield each object as a dict of plain numbers, lists and texts, by the columns' names."""
        columns = {
            column.name: values if isinstance(values, tuple) else values.tolist()
            for column in fields(self)
            for values in (getattr(self, column.name),)
        }
        for row in range(len(self)):
            yield {name: values[row] for name, values in columns.items()}

    def _repr_html_(self) -> str:
        """Return the table as HTML for notebooks: visible objects first, the largest first."""
        order = np.argsort(-self.visible_pixels, kind="stable").tolist()
        shares, truncated = self.visible_share, self.truncated_share
        heads = [
            "id",
            "name",
            "category",
            "pixels",
            "box",
            "visible",
            "truncated",
            "distance",
            "size",
        ]
        rows = [
            (
                str(self.ids[row]),
                self.names[row],
                self.categories[row],
                str(self.visible_pixels[row]) if self.visible_pixels[row] else "",
                ", ".join(map(str, self.visible_boxes[row])) if self.visible_pixels[row] else "",
                _percent(shares[row]),
                _percent(truncated[row]),
                "" if np.isnan(self.distances[row]) else f"{self.distances[row]:.2f} m",
                " × ".join(f"{side:.2f}" for side in self.box_sizes[row]) + " m",
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
        about = f"{len(self)} objects, {int(self.visible.sum())} of them visible"
        return f"<div><p><b>{about}</b></p><table><tr>{head}</tr>{body}</table></div>"


def _percent(share: float) -> str:
    return "" if np.isnan(share) else f"{100.0 * share:.0f} %"


def corner_keypoints(low: ArrayLike, high: ArrayLike) -> tuple[Keypoint, ...]:
    """Return the corners of a box as named points, in the order of `CORNER_SIGNS`."""
    middle = 0.5 * (np.asarray(low, float) + np.asarray(high, float))
    half = 0.5 * (np.asarray(high, float) - np.asarray(low, float))
    found = []
    for number, signs in enumerate(CORNER_SIGNS):
        x, y, z = (middle + signs * half).tolist()
        found.append(Keypoint(name=f"corner {number}", position_m=(x, y, z)))
    return tuple(found)


def _ratio(part: NDArray[np.int64], whole: NDArray[np.int64]) -> NDArray[np.float64]:
    with np.errstate(invalid="ignore", divide="ignore"):
        share = part / whole
    return np.where(whole > 0, share, np.nan)

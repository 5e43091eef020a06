"""The objects that a frame shows, each with what can be said of it alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language.colour_words import COLOUR_WORDS, colour_words
from sailenv_ros.frame.language.scene_facts import NO_FACTS, SceneFacts
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import ObjectTable
from sailenv_ros.types.labels import ROOM_PARTS, UNLABELLED_CATEGORY

__all__ = [
    "LEAST_SHARE",
    "NOT_OF_COLOUR",
    "UPRIGHT",
    "SeenObject",
    "seen_objects",
    "seen_parts",
]

LEAST_SHARE = 2e-4
"""Share of the picture from which an object is seen; with less it may be there, and nothing is said
that would be wrong if it were, or if it were not."""

OF_COLOUR, NOT_OF_COLOUR = 0.8, 0.05
"""Share of its pixels from which an object is of a colour, and below which it clearly is not."""

UPRIGHT = 0.999
"""Least cosine between an axis of what stands upright and the vertical."""

OF_MATERIAL = 0.8
"""Share of its surface from which an object is made of a material."""

NOT_NAMED = ROOM_PARTS | {"plane"}
"""Categories that no sentence names: parts of rooms, and the ground outside of them."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SeenObject:
    """An object that a frame shows, with all its parts.

    Attributes
    ----------
    id : int
    name, category : str
    pixels : int
        Visible ones, of its parts too.
    box : (4,) tuple of int
        Left, top, right, bottom of these, the last ones included [px].
    clear : bool
        Whether it takes `LEAST_SHARE` of the picture.
    distance_m : float
        From the camera to the middle of the box around its mesh [m].
    corners_m : (8, 3) float64
        Of that box, in the world [m].
    size_m : (3,) float64
        Of that box, along the object's own axes [m].
    turn : (3, 3) float64
        Rotation world-from-object.
    colours : mapping of str to float
        Shares of its pixels by `COLOUR_WORDS`; empty for frames without the view ``albedo``.
    materials : mapping of str to float
        Shares of its surface by `MATERIAL_WORDS`; empty without `SceneFacts`.
    hidden : float
        Share of its pixels in the picture that other things cover; NaN without amodal masks.
    """

    id: int
    name: str
    category: str
    pixels: int
    box: tuple[int, int, int, int]
    clear: bool
    distance_m: float
    corners_m: NDArray[np.float64]
    size_m: NDArray[np.float64]
    turn: NDArray[np.float64]
    colours: Mapping[str, float] = field(default_factory=dict)
    materials: Mapping[str, float] = field(default_factory=dict)
    hidden: float = math.nan

    @property
    def material(self) -> str:
        """Word for what it is mostly made of; empty if that is not clear."""
        found = (word for word, share in self.materials.items() if word and share >= OF_MATERIAL)
        return next(found, "")

    @property
    def colour(self) -> str:
        """Word for its colour; empty if there is none, or several."""
        found = (word for word, share in self.colours.items() if word and share >= OF_COLOUR)
        return next(found, "")

    @property
    def is_upright(self) -> bool:
        """Whether an axis of its box is vertical: else the box is higher than what is in it."""
        return bool(np.abs(self.turn[2]).max() >= UPRIGHT)

    def distance_to_box_m(self, point: NDArray[np.float64]) -> float:
        """Return how far a point of the world is from its box; 0 inside [m]."""
        offset = np.abs(self.turn.T @ (point - self.middle_m)) - 0.5 * self.size_m
        return float(np.linalg.norm(offset.clip(min=0.0)))

    @property
    def bottom_m(self) -> float:
        """Height of its lowest point in the world [m]."""
        return float(self.corners_m[:, 2].min())

    @property
    def top_m(self) -> float:
        """Height of its highest point in the world [m]."""
        return float(self.corners_m[:, 2].max())

    @property
    def height_m(self) -> float:
        """Extent along the world's z axis [m]."""
        return self.top_m - self.bottom_m

    @property
    def least_height_m(self) -> float:
        """Least extent that what is in it may have: a box that leans is higher [m]."""
        axis = int(np.argmax(np.abs(self.turn[2])))
        upright = float(abs(self.turn[2, axis]) * self.size_m[axis])
        return 2.0 * upright - self.height_m

    @property
    def middle_m(self) -> NDArray[np.float64]:
        """(3,) middle of its box in the world [m]."""
        return np.asarray(self.corners_m.mean(axis=0))


def seen_objects(frame: Frame, facts: SceneFacts = NO_FACTS) -> tuple[SeenObject, ...]:
    """Return the objects that a frame shows, by their ids; parts of rooms are left out.

    Parameters
    ----------
    frame : Frame
    facts : SceneFacts
        Of the same instant.

    Raises
    ------
    InvalidRequest
        If the frame has no view ``instance``, or no states.
    """
    if "instance" not in frame.views or frame.states is None:
        raise InvalidRequest("views", tuple(frame.views), "a frame with 'instance' and states")
    table = frame.objects
    row_of = {id_: row for row, id_ in enumerate(table.ids.tolist())}
    rows_of_whole: dict[int, list[int]] = {}
    for row in range(len(table)):
        rows_of_whole.setdefault(_whole_of(table, row, row_of), []).append(row)
    owned = {
        id_: seen
        for id_, rows in rows_of_whole.items()
        if (seen := [row for row in rows if table.visible_pixels[row]])
    }
    least = LEAST_SHARE * frame.views["instance"].size
    colours = _colours_of(frame, {id_: table.ids[rows] for id_, rows in owned.items()})
    masks = None if frame.draw_amodal is None or frame.row_poses is not None else frame.amodal
    found = []
    for id_, rows in sorted(owned.items()):
        row = row_of[id_]
        labelled = table.category_ids[row] not in (0, UNLABELLED_CATEGORY)
        if not labelled or table.categories[row] in NOT_NAMED:
            continue
        boxes = table.visible_boxes[rows]
        left, top = boxes[:, :2].min(axis=0).tolist()
        right, bottom = boxes[:, 2:].max(axis=0).tolist()
        pixels = int(table.visible_pixels[rows].sum())
        found.append(
            SeenObject(
                id=id_,
                name=table.names[row],
                category=table.categories[row],
                pixels=pixels,
                box=(left, top, right, bottom),
                clear=pixels >= least,
                distance_m=float(table.distances[row]),
                corners_m=table.corners[row],
                size_m=table.box_sizes[row],
                turn=_rotation(table.world_from_object[row]),
                colours=colours.get(id_, {}),
                materials=facts.materials.get(id_, {}),
                hidden=_hidden_share(masks, table, rows_of_whole[id_]),
            )
        )
    return tuple(found)


def seen_parts(frame: Frame) -> frozenset[str]:
    """Return the categories of visible parts, such as the books in a bookcase.

    They are no objects of their own here, so that nothing is said of how many there are.
    """
    table = frame.objects
    rows = np.flatnonzero(np.asarray(table.visible_pixels) * (table.parents != 0))
    return frozenset(table.categories[row] for row in rows.tolist())


def _colours_of(
    frame: Frame, ids_of: Mapping[int, NDArray[np.integer[Any]]]
) -> dict[int, dict[str, float]]:
    """Return the shares of colours of some objects, each with its parts."""
    if "albedo" not in frame.views:
        return {}
    instance, count = frame.views["instance"].astype(np.int64), len(COLOUR_WORDS)
    words = colour_words(frame.views["albedo"])
    pixels = np.bincount((instance * count + words).reshape(-1), minlength=65536 * count)
    by_id = pixels.reshape(-1, count)
    sums = {id_: by_id[ids].sum(axis=0) for id_, ids in ids_of.items()}
    return {
        id_: {word: float(one / total.sum()) for word, one in zip(COLOUR_WORDS, total, strict=True)}
        for id_, total in sums.items()
    }


def _hidden_share(masks: AmodalMasks | None, table: ObjectTable, rows: list[int]) -> float:
    """Return the share of an object that the picture does not show; NaN if that is not known.

    Nor where a part of it is not seen at all.
    """
    if masks is None:
        return math.nan
    covered = np.zeros((masks.height, masks.width), bool)
    for row in rows:
        mask = masks.mask(int(table.ids[row]))
        if mask.any() and not table.visible_pixels[row]:
            return math.nan
        covered |= mask
    whole = int(covered.sum())
    return 1.0 - min(int(table.visible_pixels[rows].sum()) / whole, 1.0) if whole else math.nan


def _whole_of(table: ObjectTable, row: int, row_of: Mapping[int, int]) -> int:
    """Return the id of the object that a row is a part of, or its own."""
    while (parent := int(table.parents[row])) in row_of:
        row = row_of[parent]
    return int(table.ids[row])


def _rotation(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation of a pose whose axes may be scaled."""
    axes = matrix[:3, :3]
    return np.asarray(axes / np.linalg.norm(axes, axis=0))

"""Category and instance tables: ids, names and colours.

A category id is a semantic class, fixed for the package (`config/categories.yaml`); an instance
id is one object of a scene and is the value of its pixels. Both have 0 as background.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, NameTaken, UnknownName

__all__ = [
    "BACKGROUND",
    "MAX_CATEGORY_ID",
    "MAX_INSTANCE_ID",
    "PART_MARK",
    "LIVING",
    "ROOM_PARTS",
    "UNLABELLED_CATEGORY",
    "Category",
    "CategoryTable",
    "Instance",
    "Keypoint",
    "colour_instances",
    "instance_colours",
]

BACKGROUND = 0
"""Category and instance id of pixels where nothing was hit."""

UNLABELLED_CATEGORY = 255
"""Category id of an object that has none (the largest value, as vision_msgs/LabelInfo says)."""

MAX_INSTANCE_ID = 65535

PART_MARK = "/"
"""Stands between an object's name and that of a part of its model, and no name holds it.

The object ``bed`` of the asset ``bed_02`` has the part ``bed/left pillow`` of the asset
``bed_02/left pillow``.
"""

MAX_CATEGORY_ID = 65535

ROOM_PARTS = frozenset(
    {"wall", "floor", "ceiling", "skirting", "window", "door", "curtain", "outside"}
)
"""Names of the categories of parts of rooms: what else there is stands in one."""

LIVING = frozenset({"person", "cat", "dog"})
"""Names of the categories of those who move by themselves."""

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Category:
    """One semantic class.

    Attributes
    ----------
    id : int
        1 to 65535 without 255; 0 is the background and 255 the unlabelled.
    name : str
        Lower-case name, e.g. ``"dining table"`` (COCO's names where COCO has the class).
    colour : (3,) tuple of int
        Red, green, blue of its pictures, 0 to 255.
    """

    id: int
    name: str
    colour: tuple[int, int, int]

    def __post_init__(self) -> None:
        if not 0 <= self.id <= MAX_CATEGORY_ID:
            accepted = f"an integer from 0 to {MAX_CATEGORY_ID}"
            raise InvalidRequest(f"id of category {self.name!r}", self.id, accepted)


class CategoryTable(Mapping[int, Category]):
    """The categories by id; read-only. Background and unlabelled are always in it."""

    def __init__(self, categories: Iterable[Category] = ()) -> None:
        table = {
            BACKGROUND: Category(id=BACKGROUND, name="background", colour=(0, 0, 0)),
            UNLABELLED_CATEGORY: Category(
                id=UNLABELLED_CATEGORY, name="unlabelled", colour=(128, 128, 128)
            ),
        }
        for category in categories:
            if category.id in table and table[category.id].name != category.name:
                raise NameTaken("category id", str(category.id))
            table[category.id] = category
        self._by_id = dict(sorted(table.items()))
        self._by_name = {category.name: category for category in self._by_id.values()}
        if len(self._by_name) != len(self._by_id):
            names = [category.name for category in self._by_id.values()]
            raise NameTaken("category", next(n for n in names if names.count(n) > 1))

    def __getitem__(self, category_id: int) -> Category:
        return self._by_id[category_id]

    def __iter__(self) -> Iterator[int]:
        return iter(self._by_id)

    def __len__(self) -> int:
        return len(self._by_id)

    def __reduce__(self) -> Any:
        # Without the palette, which is read-only and as large as a picture.
        return type(self), (tuple(self._by_id.values()),)

    def named(self, name: str) -> Category:
        """Find a category by its name.

        Raises
        ------
        UnknownName
            If there is none of that name.
        """
        if name not in self._by_name:
            raise UnknownName("category", name, self._by_name)
        return self._by_name[name]

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Type of the category view: uint8, or uint16 if an id is more than 255."""
        return np.dtype(np.uint8 if max(self._by_id) <= UNLABELLED_CATEGORY else np.uint16)

    @cached_property
    def palette(self) -> NDArray[np.uint8]:
        """(65536, 3) uint8 read-only: RGB colour of each category id; grey where there is none."""
        palette = np.full((MAX_CATEGORY_ID + 1, 3), 128, dtype=np.uint8)
        for category in self._by_id.values():
            palette[category.id] = category.colour
        palette.flags.writeable = False
        return palette


@dataclass(frozen=True, slots=True, kw_only=True)
class Keypoint:
    """A named point of an object; `position_m` is in the object's own frame [m]."""

    name: str
    position_m: Vector3


@dataclass(frozen=True, slots=True, kw_only=True)
class Instance:
    """One object of a scene, as labels know it.

    Attributes
    ----------
    id : int
        1 to 65535: the value of its pixels in the instance view. Never reused within a scene's
        life (until the scene is changed or reset).
    name : str
        Its name in the scene, unique there.
    asset : str
        The catalogue's name of what it is, e.g. ``"cube"``.
    category_id : int
    category : str
        The category's name.
    static : bool
        True if physics never moves it.
    low_m, high_m : (3,) tuple of float
        Lowest and highest corner of the box around its mesh, in its own frame, its scale applied
        [m].
    parent : int
        Id of the object that it is a part of; 0 for none.
    keypoints : tuple of Keypoint
        Those that its asset names, its scale applied.
    materials : tuple of str
        Names of its own materials, which `set_material` takes; none of a part of a room.
    painted : str
        JSON: a list of its materials as a scene file has them; empty while all are its own.

    A part of an object's model is an instance like others; see `is_part`.
    """

    id: int
    name: str
    asset: str
    category_id: int
    category: str
    static: bool
    low_m: Vector3 = (0.0, 0.0, 0.0)
    high_m: Vector3 = (0.0, 0.0, 0.0)
    parent: int = 0
    keypoints: tuple[Keypoint, ...] = ()
    materials: tuple[str, ...] = ()
    painted: str = ""

    @property
    def is_part(self) -> bool:
        """True for a part of an object's model: it moves with its parent, and only with it."""
        return PART_MARK in self.asset


def instance_colours() -> NDArray[np.uint8]:
    """Return (65536, 3) uint8 RGB: one colour for each instance id, no two alike, 0 black.

    The id is spread over 24 bits by an odd multiplier modulo 2**24, which is a bijection, so
    neighbouring ids look different and no two ids share a colour.
    """
    ids = np.arange(MAX_INSTANCE_ID + 1, dtype=np.uint64)
    spread = (ids * np.uint64(0x9E3779)) & np.uint64(0xFFFFFF)
    channels = [(spread >> np.uint64(shift)) & np.uint64(0xFF) for shift in (0, 8, 16)]
    return np.stack(channels, axis=-1).astype(np.uint8)


def colour_instances(instance: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Colour an instance view.

    Parameters
    ----------
    instance : (H, W) uint16
        Instance ids.

    Returns
    -------
    rgb : (H, W, 3) uint8
        One colour per instance, no two alike; a new array.
    """
    return _INSTANCE_COLOURS[instance]


_INSTANCE_COLOURS = instance_colours()

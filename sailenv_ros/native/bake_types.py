"""The structures of src/kernels/bake_types.h as NumPy types, and records of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import checked
from sailenv_ros.native.render_types import ADDRESS, address, structure

__all__ = [
    "Emitters",
    "LitPoints",
    "MappedTriangles",
    "RayList",
    "Record",
    "SkyWindows",
    "TexelMap",
]

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]


class Record:
    """A structure that kernels are given; keeps the arrays alive whose addresses it holds.

    Parameters
    ----------
    arrays : dict of str to array or None
        By the names of the structure's pointers, in their order; None is a null pointer.
    numbers : dict of str to int or float
        The structure's numbers, which follow: int64 or double.

    Attributes
    ----------
    record : (1,) structured array
    arrays : dict of str to array or None
    """

    def __init__(
        self, arrays: Mapping[str, NDArray[Any] | None], numbers: Mapping[str, float]
    ) -> None:
        fields: list[Any] = [(name, ADDRESS) for name in arrays]
        fields += [
            (name, "<f8" if isinstance(number, float) else "<i8")
            for name, number in numbers.items()
        ]
        self.arrays: Mapping[str, Any] = arrays
        self.record: NDArray[np.void] = np.zeros(1, structure(*fields))
        for name, array in arrays.items():
            self.record[name][0] = address(array)
        for name, number in numbers.items():
            self.record[name][0] = number


class TexelMap(Record):
    """The texels in use of a light map.

    Parameters
    ----------
    index : (H, W) int32
        The number of each texel, -1 where it is unused.
    rows, columns, owners : (N,) int32
    positions, normals, faces : (N, 3) float32
        World frame [m]; normals of the smooth surface and of the triangle, unit length.
    """

    def __init__(
        self,
        index: Integers,
        rows: Integers,
        columns: Integers,
        owners: Integers,
        positions: Floats,
        normals: Floats,
        faces: Floats,
    ) -> None:
        count, (height, width) = len(rows), index.shape
        arrays: dict[str, NDArray[Any]] = {
            "index": checked("index", index, np.int32, (None, None)),
            "rows": checked("rows", rows, np.int32, (count,)),
            "columns": checked("columns", columns, np.int32, (count,)),
            "owners": checked("owners", owners, np.int32, (count,)),
            "positions": checked("positions", positions, np.float32, (count, 3)),
            "normals": checked("normals", normals, np.float32, (count, 3)),
            "faces": checked("faces", faces, np.float32, (count, 3)),
        }
        super().__init__(arrays, {"count": count, "height": height, "width": width})
        self.count = count


class LitPoints(Record):
    """Points of surfaces that are lit.

    Parameters
    ----------
    positions, normals, faces : (N, 3) float32
        World frame [m]; normals of the smooth surface and of the triangle, unit length.
    shifts : (N, 2) float32
        Of the patterns of rays, in sizes of cells.
    """

    def __init__(self, positions: Floats, normals: Floats, faces: Floats, shifts: Floats) -> None:
        count = len(positions)
        arrays: dict[str, NDArray[Any]] = {
            "positions": checked("positions", positions, np.float32, (count, 3)),
            "normals": checked("normals", normals, np.float32, (count, 3)),
            "faces": checked("faces", faces, np.float32, (count, 3)),
            "shifts": checked("shifts", shifts, np.float32, (count, 2)),
        }
        super().__init__(arrays, {"count": count})
        self.count = count


class MappedTriangles(Record):
    """Triangles and the texels of a map that they have.

    Parameters
    ----------
    faces : (T, 3) float32
        Unit normals.
    two_sided : (T,) bool
    twin : (T,) int32
        The triangle that lies on each one back to back, or -1.
    corner : (T, 3) int32
        Which corner of that one each corner lies on.
    places : (T, 3, 2) float32
        Of the corners in the map [texels].
    index : (H, W) int32
        The number of each texel, -1 where it is unused.
    """

    def __init__(
        self,
        faces: Floats,
        two_sided: NDArray[np.bool_],
        twin: Integers,
        corner: Integers,
        places: Floats,
        index: Integers,
    ) -> None:
        count, (height, width) = len(faces), index.shape
        arrays: dict[str, NDArray[Any]] = {
            "faces": checked("faces", faces, np.float32, (count, 3)),
            "two_sided": checked("two-sided triangles", two_sided, np.bool_, (count,)),
            "twin": checked("twins", twin, np.int32, (count,)),
            "corner": checked("corners", corner, np.int32, (count, 3)),
            "places": checked("places", places, np.float32, (count, 3, 2)),
            "index": checked("index", index, np.int32, (None, None)),
        }
        super().__init__(arrays, {"count": count, "height": height, "width": width})


class SkyWindows(Record):
    """The sky, and the windows that it comes in by.

    Parameters
    ----------
    picture : (H, W, 3) float32
        Radiance by direction, laid out as in `SkyMap`.
    panes : (P, 4, 3) float32
        Of each its middle, half its two sides, and its unit normal, in the world frame [m].
    """

    def __init__(self, picture: Floats, panes: Floats) -> None:
        arrays: dict[str, NDArray[Any]] = {
            "picture": checked("sky", picture, np.float32, (None, None, 3)),
            "panes": checked("panes", panes, np.float32, (None, 4, 3)),
        }
        height, width = picture.shape[:2]
        super().__init__(arrays, {"height": height, "width": width, "pane_count": len(panes)})


class Emitters(Record):
    """Balls around small things that shine: (E, 4) float32, middle and radius [m]."""

    def __init__(self, balls: Floats) -> None:
        checked("emitters", balls, np.float32, (None, 4))
        super().__init__({"balls": balls}, {"count": len(balls)})


class RayList(Record):
    """Room for rays that leave some points, in a list that a kernel fills in.

    Parameters
    ----------
    room : int
        How many rays there may be.
    """

    def __init__(self, room: int) -> None:
        self._point = np.empty(room, np.int32)
        self._origins, self._towards = np.empty((2, room, 3), np.float32)
        self._made = np.zeros(1, np.int64)
        arrays: dict[str, NDArray[Any]] = {
            "point": self._point,
            "origins": self._origins,
            "towards": self._towards,
            "made": self._made,
        }
        super().__init__(arrays, {})

    def rays(self) -> tuple[Integers, Floats, Floats]:
        """Return (R,) int32, (R, 3), (R, 3) float32: points, origins and unit directions."""
        made = int(self._made[0])
        return self._point[:made], self._origins[:made], self._towards[:made]

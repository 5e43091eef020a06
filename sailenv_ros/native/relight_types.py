"""The structures of src/kernels/relight_types.h as records."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import Record
from sailenv_ros.native.library import checked
from sailenv_ros.native.render_types import address

__all__ = ["HalfMaps", "MappedTexels", "PatchMap"]

Floats = NDArray[np.float32]
Integers = NDArray[np.int32]


class PatchMap(Record):
    """Tiles of 4 by 4 texels of a light map, as far as they belong to one object.

    Parameters
    ----------
    of_texel : (side, side) int32
        The patch of each texel, -1 for none.
    places : (P, 2) float32
        Column and row of the texel that stands for each patch.
    positions, normals : (P, 3) float32
        World frame [m].
    owners : (P,) int32
        Instances.
    """

    def __init__(
        self,
        of_texel: Integers,
        places: Floats,
        positions: Floats,
        normals: Floats,
        owners: Integers,
    ) -> None:
        side, count = len(of_texel), len(places)
        arrays: dict[str, NDArray[Any]] = {
            "of_texel": checked("patches of texels", of_texel, np.int32, (side, side)),
            "places": checked("places of patches", places, np.float32, (count, 2)),
            "positions": checked("positions of patches", positions, np.float32, (count, 3)),
            "normals": checked("normals of patches", normals, np.float32, (count, 3)),
            "owners": checked("owners of patches", owners, np.int32, (count,)),
        }
        super().__init__(arrays, {"count": count, "side": side})
        self.count, self.side = count, side


class MappedTexels(Record):
    """The texels in use of a light map.

    Parameters
    ----------
    places : (N,) int32
        Row times side plus column.
    positions, normals : (N, 3) float32
        World frame [m].
    owners : (N,) int32
        Instances.
    """

    def __init__(
        self, places: Integers, positions: Floats, normals: Floats, owners: Integers
    ) -> None:
        count = len(places)
        arrays: dict[str, NDArray[Any]] = {
            "places": checked("places", places, np.int32, (count,)),
            "positions": checked("positions", positions, np.float32, (count, 3)),
            "normals": checked("normals", normals, np.float32, (count, 3)),
            "owners": checked("owners", owners, np.int32, (count,)),
        }
        super().__init__(arrays, {"count": count})


class HalfMaps(Record):
    """Channels of maps that a kernel writes to.

    Parameters
    ----------
    maps : list of (side, side, 3) or (side, side) float16
    side : int
    """

    def __init__(self, maps: list[NDArray[np.float16]], side: int) -> None:
        for one in maps:
            checked("layer", one, np.float16, (side, side, 3)[: one.ndim])
        self.maps = maps
        depths = [3 if one.ndim == 3 else 1 for one in maps]
        texels = [
            address(one) + 2 * channel
            for one, depth in zip(maps, depths, strict=True)
            for channel in range(depth)
        ]
        steps = np.repeat(np.array(depths, np.int64), depths)
        arrays: dict[str, NDArray[Any]] = {"texels": np.array(texels, np.uint64), "steps": steps}
        super().__init__(arrays, {"channels": len(steps)})
        self.channels = len(steps)

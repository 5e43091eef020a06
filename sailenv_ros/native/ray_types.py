"""The structures of src/kernels/ray_types.h as NumPy types: what kernels that trace rays are given.

Fields that end in `_at` hold addresses of arrays; whoever fills them keeps the arrays alive.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sailenv_ros.native.lamp import LAMP

__all__ = [
    "RAY_INSTANCE",
    "RAY_LIGHT",
    "RAY_SCENE",
    "RAY_SHAPE",
    "TREE_NODE",
    "WIDTH",
]

WIDTH = 8
"""Children of a node, and the most triangles of a leaf."""

_ADDRESS = "<u8"


def _structure(*fields: tuple[Any, ...]) -> np.dtype[np.void]:
    return np.dtype(list(fields), align=True)


TREE_NODE = _structure(("planes", "<f4", (6, WIDTH)), ("children", "<i4", WIDTH))

RAY_SHAPE = _structure(
    ("nodes_at", _ADDRESS),
    ("triangles_at", _ADDRESS),
    ("order_at", _ADDRESS),
    ("places_at", _ADDRESS),
    ("two_sided_at", _ADDRESS),
    ("count", "<i8"),
    ("first_triangle", "<i8"),
)

RAY_INSTANCE = _structure(
    ("shape_at", _ADDRESS),
    ("radiance_at", _ADDRESS),
    ("body_from_world", "<f4", 12),
    ("sphere", "<f4", 4),
    ("chart", "<f4", 4),
    ("has_chart", "<i4"),
    ("before", "<i4"),
    ("after", "<i4"),
    ("padding", "<i4"),
)

RAY_SCENE = _structure(
    ("nodes_at", _ADDRESS),
    ("order_at", _ADDRESS),
    ("resting_at", _ADDRESS),
    ("changed_at", _ADDRESS),
    ("glass_at", _ADDRESS),
    ("passes_at", _ADDRESS),
    ("sky_at", _ADDRESS),
    ("patches_at", _ADDRESS),
    ("before_at", _ADDRESS),
    ("after_at", _ADDRESS),
    ("changed_count", "<i8"),
    ("patch_count", "<i8"),
    ("resting_count", "<i8"),
    ("sky_height", "<i4"),
    ("sky_width", "<i4"),
    ("height", "<i4"),
    ("width", "<i4"),
    ("channels", "<i4"),
    ("padding", "<i4"),
)

RAY_LIGHT = _structure(
    ("lamp", LAMP),
    ("across", "<f4", 3),
    ("up", "<f4", 3),
    ("radius", "<f4"),
)

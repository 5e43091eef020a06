"""The structures of src/kernels/ray_types.h as NumPy types: what kernels that trace rays are given.

Fields that end in `_at` hold addresses of arrays; whoever fills them keeps the arrays alive.
"""

from __future__ import annotations

from sailenv_ros.native.lamp import LAMP
from sailenv_ros.native.render_types import ADDRESS, structure

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

TREE_NODE = structure(("planes", "<f4", (6, WIDTH)), ("children", "<i4", WIDTH))

RAY_SHAPE = structure(
    ("nodes_at", ADDRESS),
    ("triangles_at", ADDRESS),
    ("order_at", ADDRESS),
    ("places_at", ADDRESS),
    ("two_sided_at", ADDRESS),
    ("count", "<i8"),
    ("first_triangle", "<i8"),
)

RAY_INSTANCE = structure(
    ("shape_at", ADDRESS),
    ("radiance_at", ADDRESS),
    ("body_from_world", "<f4", 12),
    ("sphere", "<f4", 4),
    ("chart", "<f4", 4),
    ("has_chart", "<i4"),
    ("before", "<i4"),
    ("after", "<i4"),
    ("padding", "<i4"),
)

RAY_SCENE = structure(
    ("nodes_at", ADDRESS),
    ("order_at", ADDRESS),
    ("resting_at", ADDRESS),
    ("changed_at", ADDRESS),
    ("glass_at", ADDRESS),
    ("passes_at", ADDRESS),
    ("sky_at", ADDRESS),
    ("patches_at", ADDRESS),
    ("before_at", ADDRESS),
    ("after_at", ADDRESS),
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

RAY_LIGHT = structure(
    ("lamp", LAMP),
    ("across", "<f4", 3),
    ("up", "<f4", 3),
    ("radius", "<f4"),
)

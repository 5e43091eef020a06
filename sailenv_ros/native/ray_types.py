"""The structures of src/kernels/ray_types.h as NumPy types: what kernels that trace rays are given.

Fields that end in `_at` hold addresses of arrays; the code that fills them keeps the arrays alive.
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
    ("nodes_at triangles_at order_at places_at two_sided_at", ADDRESS),
    ("count first_triangle", "<i8"),
)

RAY_INSTANCE = structure(
    ("shape_at radiance_at", ADDRESS),
    ("body_from_world", "<f4", 12),
    ("sphere chart", "<f4", 4),
    ("has_chart before after padding", "<i4"),
)

RAY_SCENE = structure(
    ("nodes_at order_at resting_at changed_at glass_at passes_at sky_at patches_at", ADDRESS),
    ("before_at after_at emitters_at", ADDRESS),
    ("emitter_count", "<i8"),
    ("changed_count patch_count resting_count", "<i8"),
    ("sky_height sky_width height width channels padding", "<i4"),
)

RAY_LIGHT = structure(
    ("lamp", LAMP),
    ("across up", "<f4", 3),
    ("radius", "<f4"),
)

"""The structures of src/kernels/traced_types.h as NumPy types: what mirrored rays are given.

Fields that end in `_at` hold addresses of arrays; the code that fills them keeps the arrays alive.
"""

from __future__ import annotations

from sailenv_ros.native.ray_types import RAY_INSTANCE
from sailenv_ros.native.render_types import ADDRESS, structure

__all__ = ["TRACED_INSTANCE", "TRACED_SCENE"]

TRACED_INSTANCE = structure(
    ("placed", RAY_INSTANCE),
    ("parts_at part_of_at vertices_at", ADDRESS),
    ("inverse_scale", "<f4", 3),
    ("at_baked_pose", "<i4"),
)

TRACED_SCENE = structure(("nodes_at order_at instances_at", ADDRESS), ("count", "<i8"))

"""The structures of src/kernels/render_types.h as NumPy types: what drawing kernels are given.

Fields that end in `_at` hold addresses of arrays; whoever fills them keeps the arrays alive.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS

__all__ = [
    "CLUSTER",
    "DRAW_LIST",
    "INSTANCES",
    "LAYER_SUM",
    "LIGHT",
    "OUTPUTS",
    "PART",
    "PART_DOUBLE_SIDED",
    "PART_FINISH_MAP",
    "PART_MASKED",
    "PART_NORMAL_MAP",
    "TEXTURE",
    "VIEW",
    "address",
    "record",
]

_ADDRESS = "<u8"


def _structure(*fields: tuple[Any, ...]) -> np.dtype[np.void]:
    return np.dtype(list(fields), align=True)


CLUSTER = _structure(
    ("first_index", "<i8"),
    ("index_count", "<i8"),
    ("centre", "<f8", 3),
    ("radius", "<f8"),
    ("axis", "<f8", 3),
    ("cosine", "<f8"),
)

TEXTURE = _structure(("texels_at", _ADDRESS), ("log2_size", "<i8"))

PART_DOUBLE_SIDED, PART_MASKED, PART_FINISH_MAP, PART_NORMAL_MAP = 1, 2, 4, 8

PART = _structure(
    ("corner_x_at", _ADDRESS),
    ("corner_y_at", _ADDRESS),
    ("corner_z_at", _ADDRESS),
    ("corner_indices_at", _ADDRESS),
    ("vertex_indices_at", _ADDRESS),
    ("vertices_at", _ADDRESS),
    ("clusters_at", _ADDRESS),
    ("colour_map_at", _ADDRESS),
    ("detail_map_at", _ADDRESS),
    ("corner_count", "<i4"),
    ("cluster_count", "<i4"),
    ("sphere", "<f4", 4),
    ("colour", "<f4", 4),
    ("base", "<f4", 3),
    ("roughness", "<f4"),
    ("metallic", "<f4"),
    ("alpha_cutoff", "<f4"),
    ("emission", "<f4"),
    ("cutoff_fall", "<f4"),
    ("least_cutoff", "<f4"),
    ("chart", "<f4", 4),
    ("flags", "<i4"),
    ("instance", "<i4"),
    ("id", "<i4"),
    ("has_chart", "<i4"),
)

INSTANCES = _structure(
    ("world_from_body_at", _ADDRESS),
    ("scales_at", _ADDRESS),
    ("drawn_at", _ADDRESS),
    ("at_baked_pose_at", _ADDRESS),
    ("count", "<i8"),
)

DRAW_LIST = _structure(("parts_at", _ADDRESS), ("count", "<i8"))

LAYER_SUM = _structure(
    ("count", "<i8"),
    ("terms", "<i8"),
    ("layers_at", _ADDRESS),
    ("channels_at", _ADDRESS),
    ("factors_at", _ADDRESS),
    ("more_at", _ADDRESS),
    ("shown_at", _ADDRESS),
    ("texels_at", _ADDRESS),
    ("states_at", _ADDRESS),
)

REFLECTION_POINT = _structure(
    ("position", "<f4", 3),
    ("light", "<f4", 4),
)

LIGHT = _structure(
    ("main_colour", "<f4", 3),
    ("main_towards", "<f4", 3),
    ("map_from_world", "<f4", 12),
    ("texel_m", "<f4"),
    ("shadow_size", "<i4"),
    ("shadow_at", _ADDRESS),
    ("static_shadow_at", _ADDRESS),
    ("ambient", "<f4", 3),
    ("sky_share", "<f4"),
    ("sky_zenith", "<f4", 3),
    ("sky_horizon", "<f4", 3),
    ("sky_ground", "<f4", 3),
    ("background", "<f4", 3),
    ("background_plain", "<i4"),
    ("sky_map_at", _ADDRESS),
    ("sky_width", "<i4"),
    ("sky_height", "<i4"),
    ("exposure", "<f4"),
    ("lamp_count", "<i4"),
    ("lamps_at", _ADDRESS),
    ("baked", "<i4"),
    ("reflecting", "<i4"),
    ("light_map_at", _ADDRESS),
    ("light_map_width", "<i4"),
    ("light_map_height", "<i4"),
    ("instance_light_at", _ADDRESS),
    ("main_baked", "<f4"),
    ("main_clear", "<f4"),
    ("edge_index_at", _ADDRESS),
    ("edge_blocks_at", _ADDRESS),
    ("reflections_at", _ADDRESS),
    ("reflection_edge", "<i4"),
    ("reflection_layers", "<i4"),
    ("reflection_scale", "<f4"),
    ("layers_per_roughness", "<f4"),
    ("reflection_points_at", _ADDRESS),
    ("reflection_table_at", _ADDRESS),
    ("room_low", "<f4", 3),
    ("room_high", "<f4", 3),
)

VIEW = _structure(
    ("camera_from_world", "<f8", 16),
    ("world_from_camera", "<f8", 16),
    ("lens", LENS),
    ("width", "<i8"),
    ("height", "<i8"),
    ("smooth_edges", "<i8"),
)

MOST_ATTRIBUTES = 8
"""Views that are attributes of surfaces, at most."""

OUTPUTS = _structure(
    ("surface_at", _ADDRESS),
    ("radiance_at", _ADDRESS),
    ("attributes_at", _ADDRESS, MOST_ATTRIBUTES),
)


def record(structure: np.dtype[np.void], **values: Any) -> NDArray[np.void]:
    """Return a structure, as an array of one, with some fields set and the others 0."""
    result = np.zeros(1, structure)
    for name, value in values.items():
        result[name][0] = value
    return result


def address(array: NDArray[Any] | None) -> int:
    """Return where an array's numbers lie; 0 for None."""
    return 0 if array is None else int(array.ctypes.data)

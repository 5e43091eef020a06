"""The structures of src/kernels/render_types.h as NumPy types: what drawing kernels are given.

Fields that end in `_at` hold addresses of arrays. A `Record` keeps alive the arrays that it is
given for that; the code that fills the structure keeps the others.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens import LENS

__all__ = [
    "ADDRESS",
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
    "RIGID",
    "TEXTURE",
    "TRIANGLE_PLACE",
    "VIEW",
    "Record",
    "address",
    "record",
    "structure",
]

ADDRESS = "<u8"
"""Type of a field that holds an address."""


def structure(*fields: tuple[Any, ...]) -> np.dtype[np.void]:
    """Return a structure as C++ lays it out: of names with spaces between, their type and shape."""
    return np.dtype(
        [(name, *kind) for names, *kind in fields for name in names.split()], align=True
    )


CLUSTER = structure(
    ("first_index index_count", "<i8"),
    ("centre", "<f8", 3),
    ("radius", "<f8"),
    ("axis", "<f8", 3),
    ("cosine", "<f8"),
)
"""A cluster: its indices, the sphere around it, the middle of its normals, and the cosine of the
angle by which one of them deviates at most (-1: nothing can be said of where it faces)."""

TEXTURE = structure(("texels_at", ADDRESS), ("log2_size", "<i8"))

PART_DOUBLE_SIDED, PART_MASKED, PART_FINISH_MAP, PART_NORMAL_MAP = 1, 2, 4, 8

RIGID = -1
"""`first_vertex` of parts of models that do not deform."""

PART = structure(
    ("corner_x_at corner_y_at corner_z_at corner_indices_at vertex_indices_at", ADDRESS),
    ("vertices_at clusters_at colour_map_at detail_map_at", ADDRESS),
    ("corner_count cluster_count", "<i4"),
    ("sphere colour", "<f4", 4),
    ("base", "<f4", 3),
    ("roughness metallic alpha_cutoff emission cutoff_fall least_cutoff", "<f4"),
    ("chart", "<f4", 4),
    ("flags instance id has_chart first_vertex first_of_model", "<i4"),
)

INSTANCES = structure(
    ("world_from_body_at scales_at drawn_at at_baked_pose_at", ADDRESS),
    ("count clipped", "<i8"),
    ("clip", "<i4", 4),
)

DRAW_LIST = structure(("parts_at", ADDRESS), ("count", "<i8"))

LAYER_SUM = structure(
    ("count terms", "<i8"),
    ("layers_at channels_at factors_at more_at shown_at texels_at states_at", ADDRESS),
)

REFLECTION_POINT = structure(
    ("position", "<f4", 3),
    ("light", "<f4", 4),
)

LIGHT = structure(
    ("main_colour main_towards", "<f4", 3),
    ("map_from_world", "<f4", 12),
    ("texel_m", "<f4"),
    ("shadow_size", "<i4"),
    ("shadow_at static_shadow_at", ADDRESS),
    ("ambient", "<f4", 3),
    ("sky_share", "<f4"),
    ("sky_zenith sky_horizon sky_ground background", "<f4", 3),
    ("background_plain", "<i4"),
    ("sky_map_at", ADDRESS),
    ("sky_width sky_height", "<i4"),
    ("sky_factor exposure", "<f4"),
    ("lamp_count", "<i4"),
    ("lamps_at", ADDRESS),
    ("baked reflecting", "<i4"),
    ("light_map_at", ADDRESS),
    ("light_map_width light_map_height", "<i4"),
    ("instance_light_at vertex_factors_at", ADDRESS),
    ("main_baked main_clear", "<f4"),
    ("edge_index_at edge_blocks_at reflections_at", ADDRESS),
    ("reflection_edge reflection_layers", "<i4"),
    ("reflection_scale layers_per_roughness", "<f4"),
    ("reflection_points_at reflection_table_at", ADDRESS),
    ("room_low room_high", "<f4", 3),
    ("traced_at mirrored_lights_at", ADDRESS),
    ("mirrored_light_count", "<i8"),
    ("outside_id", "<i4"),
    ("outside_radiance", "<f4"),
)

VIEW = structure(
    ("camera_from_world world_from_camera", "<f8", 16),
    ("lens", LENS),
    ("width height smooth_edges parallel", "<i8"),
    ("table_at fine_table_at", ADDRESS),
)

TRIANGLE_PLACE = structure(("vertices", "<u4", 3), ("weights", "<f4", 3))

MOST_ATTRIBUTES = 8
"""Views that are attributes of surfaces, at most."""

OUTPUTS = structure(
    ("surface_at radiance_at", ADDRESS),
    ("attributes_at", ADDRESS, MOST_ATTRIBUTES),
    ("places_at", ADDRESS),
)


class Record(np.ndarray[Any, np.dtype[np.void]]):
    """A structure, as an array of one, that keeps alive what its addresses point to.

    Attributes
    ----------
    kept : tuple of object
        Copies keep the same.
    """

    kept: tuple[object, ...]

    def __array_finalize__(self, made_from: object) -> None:
        self.kept = getattr(made_from, "kept", ())


def record(kind: np.dtype[np.void], kept: tuple[object, ...] = (), /, **values: Any) -> Record:
    """Return a structure that keeps some objects, with some fields set and the others 0."""
    result = np.zeros(1, kind).view(Record)
    for name, value in values.items():
        result[name][0] = value
    result.kept = kept
    return result


def address(array: NDArray[Any] | None) -> int:
    """Return where an array's numbers lie; 0 for None."""
    return 0 if array is None else int(array.ctypes.data)

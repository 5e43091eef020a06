"""Tables of points, and meshes, as binary PLY files (G. Turk, "The PLY Polygon File Format")."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["ply_bytes"]

_TYPES = {
    "float32": "float",
    "float64": "double",
    "uint8": "uchar",
    "uint16": "ushort",
    "int32": "int",
}


def ply_bytes(
    columns: Mapping[str, NDArray[Any]], triangles: NDArray[np.int32] | None = None
) -> bytes:
    """Write points, or a mesh.

    Parameters
    ----------
    columns : mapping of str to (N,) array
        Properties of the vertices by their names, in their order.
    triangles : (M, 3) int32 or None
        Numbers of vertices.

    Returns
    -------
    data : bytes
        A file of the format ``binary_little_endian``.
    """
    count = len(next(iter(columns.values())))
    order = [(name, values.dtype.newbyteorder("<")) for name, values in columns.items()]
    table = np.empty(count, np.dtype(order))
    for name, values in columns.items():
        table[name] = values
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    lines += [f"property {_TYPES[v.dtype.name]} {name}" for name, v in columns.items()]
    faces = b""
    if triangles is not None:
        lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
        made = np.empty(len(triangles), np.dtype([("count", "u1"), ("numbers", "<i4", 3)]))
        made["count"], made["numbers"] = 3, triangles
        faces = made.tobytes()
    return "\n".join([*lines, "end_header\n"]).encode() + table.tobytes() + faces

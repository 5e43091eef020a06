"""A small model as users upload them: a zip of an obj with its mtl."""

from __future__ import annotations

import io
import zipfile

OBJ = """mtllib box.mtl
v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1
usemtl red
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""
"""A box of 2 x 2 x 2 units that stands on the ground, its y upwards."""


def box_zip(obj: str = OBJ) -> bytes:
    """Return the archive's bytes."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr("box/box.obj", obj)
        archive.writestr("box/box.mtl", "newmtl red\nKd 1 0 0\n")
    return data.getvalue()

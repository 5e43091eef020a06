"""A binary glTF file that grows: arrays, pictures, nodes."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_content.scene_import.usd_meshes import Corners
from sailenv_ros.assets.gltf_description import appended, glb_with

__all__ = ["GltfTree"]

_LIGHTS = "KHR_lights_punctual"


class GltfTree:
    """Entries and bytes of one file."""

    def __init__(self) -> None:
        self._binary = bytearray()
        self._tree: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": []}],
        }

    def append(self, key: str, entry: Mapping[str, Any]) -> int:
        """Add an entry; return its number."""
        return appended(self._tree, key, entry)

    def bytes_of(self, data: bytes) -> int:
        """Add bytes; return the number of their view."""
        self._binary += bytes(-len(self._binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
        self._binary += data
        return self.append("bufferViews", view)

    def corners(self, corners: Corners, moved: NDArray[np.float64]) -> tuple[dict[str, int], int]:
        """Add corners of triangles, equal ones once, moved by a matrix (4, 4).

        Returns
        -------
        attributes : dict of str to int
        indices : int
            Numbers of accessors.
        """
        turn = moved[:3, :3]
        columns = [corners.positions @ turn.T + moved[:3, 3]]
        names, widths = ["POSITION"], [3]
        if corners.normals is not None:
            # Normals of what is scaled unequally lean the other way.
            leaned = corners.normals @ np.linalg.inv(turn)
            lengths = np.linalg.norm(leaned, axis=1, keepdims=True)
            columns.append(leaned / np.maximum(lengths, 1e-12))
            names.append("NORMAL")
            widths.append(3)
        if corners.uvs is not None:
            columns.append(corners.uvs * (1.0, -1.0) + (0.0, 1.0))
            names.append("TEXCOORD_0")
            widths.append(2)
        rows = np.ascontiguousarray(np.concatenate(columns, axis=1), "<f4")
        kept, numbers = np.unique(rows, axis=0, return_inverse=True)
        if np.linalg.det(turn) < 0.0:
            numbers = numbers.reshape(-1, 3)[:, ::-1]
        attributes, begin = {}, 0
        for name, width in zip(names, widths, strict=True):
            attributes[name] = self._accessor(kept[:, begin : begin + width], f"VEC{width}", 5126)
            begin += width
        indices = self._accessor(numbers.reshape(-1).astype("<u4"), "SCALAR", 5125)
        return attributes, indices

    def place(self, node: Mapping[str, Any], pose: NDArray[np.float64]) -> None:
        """Add a node of the scene with its pose (4, 4)."""
        number = self.append("nodes", {**node, "matrix": pose.T.reshape(-1).tolist()})
        self._tree["scenes"][0]["nodes"].append(number)

    def place_light(
        self, node: Mapping[str, Any], light: Mapping[str, Any], pose: NDArray[np.float64]
    ) -> None:
        """Add a light and its node."""
        held = self._tree.setdefault("extensions", {}).setdefault(_LIGHTS, {"lights": []})
        held["lights"].append(light)
        number = len(held["lights"]) - 1
        self.place({**node, "extensions": {_LIGHTS: {"light": number}}}, pose)

    def data(self) -> bytes:
        """Return the whole file."""
        self._binary += bytes(-len(self._binary) % 4)
        self._tree["buffers"] = [{"byteLength": len(self._binary)}]
        chunk = struct.pack("<I", len(self._binary)) + b"BIN\0" + bytes(self._binary)
        return glb_with(self._tree, chunk)

    def _accessor(self, values: NDArray[Any], kind: str, component: int) -> int:
        entry: dict[str, Any] = {
            "bufferView": self.bytes_of(np.ascontiguousarray(values).tobytes()),
            "componentType": component,
            "count": len(values),
            "type": kind,
        }
        if kind == "VEC3":
            entry["min"] = values.min(axis=0).astype(float).tolist()
            entry["max"] = values.max(axis=0).astype(float).tolist()
        return self.append("accessors", entry)

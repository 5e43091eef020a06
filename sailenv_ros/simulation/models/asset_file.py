"""An `Asset` ↔ one file of plain numbers, so that a process hands it to another without pickling.

A line of JSON that describes it, then the arrays it refers to, one after the other. Nothing in such
a file can run: it may come from a process that was taken over by what it was importing.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import Asset, ConvexShape, Material, Mesh, Model, ModelPart

__all__ = ["read_asset", "write_asset"]

_DTYPES = ("float32", "float64", "uint32", "uint8")
_MESH = ("positions", "normals", "uvs", "triangles")
_TEXTURES = ("base_colour_texture", "metallic_roughness_texture", "normal_texture")
_ALPHAS = ("opaque", "mask", "blend")
_LONGEST_LINE = 2**24


def write_asset(path: Path, asset: Asset) -> None:
    """Write an asset whose collision shapes are convex pieces.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    arrays: list[NDArray[Any]] = []

    def kept(array: NDArray[Any]) -> dict[str, Any]:
        arrays.append(np.ascontiguousarray(array))
        return {"dtype": str(array.dtype), "shape": list(array.shape)}

    parts = []
    for part in asset.model.parts:
        material = {
            field.name: getattr(part.material, field.name)
            for field in dataclasses.fields(Material)
            if field.name not in _TEXTURES
        }
        textures = {name: getattr(part.material, name) for name in _TEXTURES}
        parts.append(
            {
                "mesh": {name: kept(getattr(part.mesh, name)) for name in _MESH},
                "material": material,
                "textures": {n: kept(t) for n, t in textures.items() if t is not None},
            }
        )
    hulls = [kept(shape.points) for shape in asset.collision if isinstance(shape, ConvexShape)]
    description = {
        "name": asset.name,
        "display_name": asset.display_name,
        "category": asset.category,
        "mass_kg": asset.mass_kg,
        "centre_of_mass_m": asset.centre_of_mass_m,
        "parts": parts,
        "hulls": hulls,
    }
    with path.open("wb") as file:
        file.write(json.dumps(description).encode() + b"\n")
        for array in arrays:
            file.write(array.tobytes())


_MALFORMED = (LookupError, ValueError, TypeError, AttributeError, RecursionError, OverflowError)
"""Exceptions that a malformed description may raise."""


def read_asset(path: Path) -> Asset:
    """Read what `write_asset` wrote.

    Raises
    ------
    AssetError
        If it is anything else.
    OSError
        If it cannot be read.
    """
    data = path.read_bytes()
    line, _, rest = data[:_LONGEST_LINE].partition(b"\n")
    reader = _Reader(data, len(line) + 1)
    del rest
    try:
        return _asset(json.loads(line), reader)
    except _MALFORMED as problem:
        raise AssetError(path.name, f"it is no asset as an import writes it ({problem})") from None


class _Reader:
    """Takes arrays from a buffer in the order in which they were written."""

    def __init__(self, data: bytes, at: int) -> None:
        self._data, self._at = data, at

    def take(self, told: Mapping[str, Any]) -> NDArray[Any]:
        if told["dtype"] not in _DTYPES:
            raise ValueError(f"dtype {told['dtype']!r}")
        shape = tuple(int(size) for size in told["shape"])
        if any(size < 0 for size in shape):
            raise ValueError(f"shape {shape}")
        dtype = np.dtype(told["dtype"])
        count = int(np.prod(shape, dtype=object))
        array = np.frombuffer(self._data, dtype, count, self._at).reshape(shape)
        self._at += array.nbytes
        return array


def _asset(told: Mapping[str, Any], reader: _Reader) -> Asset:
    parts = tuple(_part(entry, reader) for entry in told["parts"])
    hulls = tuple(ConvexShape(points=_points(reader.take(entry))) for entry in told["hulls"])
    return Asset(
        name=str(told["name"]),
        display_name=str(told["display_name"]),
        category=str(told["category"]),
        model=Model(name=str(told["name"]), parts=parts),
        collision=hulls,
        mass_kg=float(told["mass_kg"]),
        centre_of_mass_m=_numbers(told["centre_of_mass_m"], 3),
    )


def _part(told: Mapping[str, Any], reader: _Reader) -> ModelPart:
    mesh = Mesh(**{name: reader.take(told["mesh"][name]) for name in _MESH})
    given = dict(told["material"])
    alpha = given["alpha"]
    if alpha not in _ALPHAS:
        raise ValueError(f"alpha {alpha!r}")
    textures = {n: _texture(reader.take(t)) for n, t in told["textures"].items() if n in _TEXTURES}
    return ModelPart(
        mesh=mesh,
        material=Material(
            name=str(given["name"]),
            base_colour=_numbers(given["base_colour"], 4),
            metallic=float(given["metallic"]),
            roughness=float(given["roughness"]),
            emission=_numbers(given["emission"], 3),
            glow=_numbers(given["glow"], 3),
            alpha=alpha,
            alpha_cutoff=float(given["alpha_cutoff"]),
            double_sided=bool(given["double_sided"]),
            **textures,
        ),
    )


def _numbers(told: Any, count: int) -> Any:
    numbers = tuple(float(number) for number in told)
    if len(numbers) != count:
        raise ValueError(f"{count} numbers, got {len(numbers)}")
    return numbers


def _points(array: NDArray[Any]) -> NDArray[np.float64]:
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise ValueError("points must be (N, 3) finite numbers")
    return np.asarray(array, dtype=np.float64)


def _texture(array: NDArray[Any]) -> NDArray[np.uint8]:
    if array.ndim != 3 or array.shape[2] != 4 or array.dtype != np.uint8:
        raise ValueError("a texture must be (H, W, 4) uint8")
    return array

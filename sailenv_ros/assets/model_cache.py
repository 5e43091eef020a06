"""Models that take long to read or to make: once on a machine, as plain arrays after that."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.glb import read_glb
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.types.model import ConvexShape, Material, Mesh, ModelPart

__all__ = ["cached_parts", "read_once"]

_LIBRARIES = ("trimesh", "pillow")
_MESH = tuple(field.name for field in fields(Mesh))
_TEXTURES = ("base_colour_texture", "metallic_roughness_texture", "normal_texture")
_NUMBERS = tuple(field.name for field in fields(Material) if field.name not in _TEXTURES)

Parts = tuple[ModelPart, ...]
Hulls = tuple[ConvexShape, ...]


def read_once(path: Path, checksum: str) -> tuple[Parts, Hulls]:
    """Read a file as `read_glb` does, or what is kept of a file of the same checksum.

    Parameters
    ----------
    path : Path
    checksum : str
        SHA-256 of the file; empty reads it, and keeps nothing.

    Raises
    ------
    AssetError
        If it cannot be read.
    """
    if not checksum:
        return read_glb(path)
    code = code_digest("assets", "types", libraries=_LIBRARIES)
    return _model_of(
        cached_arrays("model", [checksum], lambda: _arrays_of(*read_glb(path)), code=code)
    )


def cached_parts(
    kind: str, key: Iterable[object], make: Callable[[], Parts], *, code: str
) -> Parts:
    """Return the parts of a model that code makes; see `cached_arrays` for the parameters."""
    return _model_of(cached_arrays(kind, key, lambda: _arrays_of(make(), ()), code=code))[0]


def _arrays_of(parts: Parts, hulls: Hulls) -> Arrays:
    arrays: dict[str, NDArray[Any]] = {}
    textures: dict[bytes, str] = {}
    materials: dict[int, int] = {}
    told_materials: list[dict[str, Any]] = []
    told_parts = []
    for place, part in enumerate(parts):
        for name in _MESH:
            arrays[f"part {place} {name}"] = getattr(part.mesh, name)
        material = part.material
        if id(material) not in materials:
            materials[id(material)] = len(told_materials)
            told: dict[str, Any] = {name: getattr(material, name) for name in _NUMBERS}
            for name in _TEXTURES:
                texture = getattr(material, name)
                if texture is not None:
                    # Files decode the picture of a hundred books a hundred times.
                    key = blake2b(repr(texture.shape).encode() + texture.tobytes()).digest()
                    told[name] = textures.setdefault(key, f"texture {len(textures)}")
                    arrays[told[name]] = texture
            told_materials.append(told)
        told_parts.append([list(part.names), materials[id(material)]])
    for place, hull in enumerate(hulls):
        arrays[f"hull {place}"] = hull.points
    told = {"materials": told_materials, "parts": told_parts, "hulls": len(hulls)}
    arrays["description"] = np.frombuffer(json.dumps(told).encode(), np.uint8)
    return arrays


def _model_of(arrays: Arrays) -> tuple[Parts, Hulls]:
    told = json.loads(arrays["description"].tobytes())
    materials = [Material(**dict(_fields(given, arrays))) for given in told["materials"]]
    parts = tuple(
        ModelPart(
            mesh=Mesh(**{name: arrays[f"part {place} {name}"] for name in _MESH}),
            material=materials[material],
            names=tuple(names),
        )
        for place, (names, material) in enumerate(told["parts"])
    )
    hulls = tuple(ConvexShape(points=arrays[f"hull {n}"]) for n in range(told["hulls"]))
    return parts, hulls


def _fields(given: Mapping[str, Any], arrays: Arrays) -> Iterator[tuple[str, Any]]:
    for name, value in given.items():
        if name in _TEXTURES:
            yield name, arrays[value]
        else:
            yield name, tuple(value) if isinstance(value, list) else value

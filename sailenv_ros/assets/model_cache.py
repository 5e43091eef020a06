"""Models and assets that take long to read or to make: once on a machine, as arrays after that."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any, Protocol, TypeVar, cast
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.glb import read_glb
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.types.inertia import Inertia
from sailenv_ros.types.joints import Detents, SoftClose
from sailenv_ros.types.model import (
    Asset,
    AssetPart,
    BoxShape,
    ConvexShape,
    CylinderShape,
    Material,
    Mesh,
    Model,
    ModelPart,
    MovingPart,
    SphereShape,
    Texture,
    TriangleShape,
)
from sailenv_ros.types.rig import Rig, RigPoint

__all__ = ["SharedTextures", "cached_object", "read_once"]

_LIBRARIES = ("trimesh", "pillow")
_KINDS: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (
        *(Asset, AssetPart, Model, ModelPart, MovingPart, Mesh, Material),
        *(BoxShape, ConvexShape, CylinderShape, SphereShape, TriangleShape),
        *(Detents, SoftClose, Inertia, Rig, RigPoint),
    )
}

T = TypeVar("T")


class SharedTextures(Protocol):
    """Textures that many models have, which are kept by name."""

    def name_of(self, texture: Texture) -> str | None:
        """Return the name of a texture; None if it is none of them."""

    def named(self, name: str) -> Texture:
        """Return a texture by its name; the same object each time."""


def read_once(path: Path, checksum: str) -> tuple[tuple[ModelPart, ...], tuple[ConvexShape, ...]]:
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
    return cached_object("model", [checksum], lambda: read_glb(path), code=code)


def cached_object(
    kind: str,
    key: Iterable[object],
    make: Callable[[], T],
    *,
    code: str,
    shared: SharedTextures | None = None,
) -> T:
    """Return a model, an asset, or tuples of what they are made of: made, or as it was kept.

    Parameters
    ----------
    kind, key, make, code
        See `cached_arrays`.
    shared : SharedTextures or None
        Textures that are not kept again for each object. With them, materials of equal values are
        one object, whatever they belong to, unless they have textures of their own.
    """
    arrays = cached_arrays(kind, key, lambda: _Packer(shared).packed(make()), code=code)
    return cast("T", _Unpacker(arrays, shared).unpacked())


class _Packer:
    """Gathers the arrays of objects; what is one object, or equal bytes, is kept once."""

    def __init__(self, shared: SharedTextures | None) -> None:
        self._shared = shared
        self._arrays: dict[str, NDArray[Any]] = {}
        self._names: dict[bytes, str] = {}
        self._objects: list[tuple[str, dict[str, Any]]] = []
        self._places: dict[int, int] = {}

    def packed(self, value: object) -> Arrays:
        told = {"value": self._told(value), "objects": self._objects}
        return {**self._arrays, "description": np.frombuffer(json.dumps(told).encode(), np.uint8)}

    def _told(self, value: Any) -> Any:
        if isinstance(value, tuple):
            return [self._told(one) for one in value]
        if isinstance(value, np.ndarray):
            return self._told_array(value)
        if not is_dataclass(value):
            return value
        if id(value) not in self._places:
            if type(value).__name__ not in _KINDS:
                raise TypeError(f"{type(value).__name__} cannot be kept")
            told = {field.name: self._told(getattr(value, field.name)) for field in fields(value)}
            self._places[id(value)] = len(self._objects)
            self._objects.append((type(value).__name__, told))
        return {"object": self._places[id(value)]}

    def _told_array(self, array: NDArray[Any]) -> dict[str, str]:
        known = None if self._shared is None else self._shared.name_of(array)
        if known is not None:
            return {"shared": known}
        # Files decode the picture of a hundred books a hundred times.
        digest = blake2b(f"{array.dtype}{array.shape}".encode() + array.tobytes()).digest()
        name = self._names.setdefault(digest, f"{len(self._names)}")
        self._arrays[name] = array
        return {"array": name}


_materials: WeakValueDictionary[str, Material] = WeakValueDictionary()


class _Unpacker:
    """Makes the objects again: those that were one are one."""

    def __init__(self, arrays: Arrays, shared: SharedTextures | None) -> None:
        self._arrays, self._shared = arrays, shared
        self._objects: list[Any] = []

    def unpacked(self) -> object:
        told = json.loads(self._arrays["description"].tobytes())
        for kind, values in told["objects"]:
            self._objects.append(self._made(kind, values))
        return self._value(told["value"])

    def _made(self, kind: str, told: dict[str, Any]) -> object:
        made = _KINDS[kind](**{name: self._value(value) for name, value in told.items()})
        if kind != "Material" or self._shared is None:
            return made
        own = any(isinstance(value, dict) and "array" in value for value in told.values())
        return made if own else _materials.setdefault(json.dumps(told), made)

    def _value(self, told: Any) -> Any:
        if isinstance(told, list):
            return tuple(self._value(one) for one in told)
        if not isinstance(told, dict):
            return told
        ((key, place),) = told.items()
        if key == "object":
            return self._objects[place]
        if key == "array":
            return self._arrays[place]
        assert self._shared is not None
        return self._shared.named(place)

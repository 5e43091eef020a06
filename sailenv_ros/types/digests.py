"""Hashes of models and skies, by their content: what is kept on disk for them is found by these.

Each is computed once, and forgotten with what it is of.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.lights import SkyMap
from sailenv_ros.types.model import Material, Model

__all__ = ["add_array", "appearance_digest", "model_digest", "once", "sky_digest"]


T = TypeVar("T")
Found = TypeVar("Found")


def once(find: Callable[[T], Found]) -> Callable[[T], Found]:
    """Return a function that finds something of what never changes once, and forgets it with it."""
    kept: WeakKeyDictionary[T, Found] = WeakKeyDictionary()

    @wraps(find)
    def known(one: T) -> Found:
        try:
            return kept[one]
        except KeyError:
            found = kept[one] = find(one)
            return found

    return known


@once
def model_digest(model: Model) -> bytes:
    """Hash what baked light depends on of a model; models never change."""
    digest = hashlib.blake2b(digest_size=16)
    for part in model.parts:
        mesh = part.mesh
        for array in (mesh.positions, mesh.normals, mesh.uvs, mesh.triangles):
            add_array(digest, array)
        _add_material(digest, part.material)
    return digest.digest()


@once
def appearance_digest(model: Model) -> bytes:
    """Hash all that is seen of a model: what light depends on, and how its surfaces shine."""
    digest = hashlib.blake2b(model_digest(model), digest_size=16)
    for part in model.parts:
        material = part.material
        digest.update(repr((material.metallic, material.roughness)).encode())
        for texture in (material.metallic_roughness_texture, material.normal_texture):
            if texture is None:
                digest.update(b"-")
            else:
                add_array(digest, texture)
    return digest.digest()


@once
def sky_digest(sky: SkyMap) -> bytes:
    """Hash a sky; skies never change."""
    digest = hashlib.blake2b(digest_size=16)
    add_array(digest, sky.radiance)
    return digest.digest()


def add_array(digest: hashlib.blake2b, array: NDArray[Any]) -> None:
    """Add an array's shape and values."""
    digest.update(repr(array.shape).encode())
    digest.update(np.ascontiguousarray(array).data)


def _add_material(digest: hashlib.blake2b, material: Material) -> None:
    told = (
        material.base_colour, material.emission, material.glow, material.alpha,
        material.alpha_cutoff, material.double_sided,
    )  # fmt: skip
    digest.update(json.dumps(told).encode())
    if material.base_colour_texture is not None:
        add_array(digest, material.base_colour_texture)

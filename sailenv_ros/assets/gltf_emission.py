"""Emission in glTF files, as far as trimesh does not read or write it.

`KHR_materials_emissive_strength` in a file's description, and pictures of emission: our materials
have one picture, so triangles that glow become a mesh of their own.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.gltf_description import description_of, glb_with
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.errors import AssetError
from sailenv_ros.types.colour import LINEAR_OF_SRGB8
from sailenv_ros.types.model import Material, Texture

__all__ = ["by_glow", "description_with_strength", "lit_by_picture", "write_strength"]

EXTENSION = "KHR_materials_emissive_strength"

DARK = 0.004
"""Linear value up to which a picture of emission is dark."""

_SAMPLES = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [4, 4, 4], [6, 6, 0], [6, 0, 6], [0, 6, 6]], np.float64
)
_SAMPLES /= _SAMPLES.sum(axis=1, keepdims=True)
"""Weights of corners: where of each triangle a picture is looked at."""


def description_with_strength(path: Path) -> bytes | None:
    """Return a glTF file with the strengths multiplied into its factors; None if it has none.

    A file that is no glTF at all is left to its reader.
    """
    if EXTENSION.encode() not in path.read_bytes():
        return None
    try:
        tree, rest = description_of(path)
        _multiply(tree)
    except (AssetError, ValueError, TypeError, AttributeError):
        return None
    is_binary = path.suffix.lower() == ".glb"
    return glb_with(tree, rest) if is_binary else json.dumps(tree).encode()


def _multiply(tree: Any) -> None:
    for material in tree.get("materials", ()):
        told = material.get("extensions", {}).get(EXTENSION, {})
        strength = float(told.get("emissiveStrength", 1.0))
        if not 0.0 <= strength < 1e9:
            raise ValueError(f"emissive strength {strength}")
        factor = [float(value) * strength for value in material.get("emissiveFactor", (0, 0, 0))]
        material["emissiveFactor"] = factor


def write_strength(tree: Any) -> None:
    """Bring factors above 1 of a file that is being written into glTF's form, in place."""
    found = False
    for material in tree.get("materials", ()):
        factor = material.get("emissiveFactor")
        strength = 0.0 if factor is None else float(max(factor))
        if strength > 1.0:
            material["emissiveFactor"] = [float(value) / strength for value in factor]
            material.setdefault("extensions", {})[EXTENSION] = {"emissiveStrength": strength}
            found = True
    if found:
        tree["extensionsUsed"] = sorted({*tree.get("extensionsUsed", ()), EXTENSION})


def lit_by_picture(material: Material, picture: Texture) -> tuple[Material, Material]:
    """Return what a material is where a picture of its emission is dark, and where it glows.

    A material has one picture: where it glows it shows that of its glow. What is cut out or
    transparent keeps its own, and glows with the mean colour of the other.
    """
    if material.alpha != "opaque":
        mean = LINEAR_OF_SRGB8[picture[..., :3]].reshape(-1, 3).mean(axis=0)
        red, green, blue = (float(a * b) for a, b in zip(material.emission, mean, strict=True))
        even = dataclasses.replace(material, emission=(red, green, blue))
        return even, even
    dark = dataclasses.replace(material, emission=(0.0, 0.0, 0.0))
    bright = dataclasses.replace(
        material, base_colour=(1.0, 1.0, 1.0, 1.0), base_colour_texture=picture
    )
    return dark, bright


def by_glow(mesh: RawMesh, picture: Texture) -> tuple[RawMesh | None, RawMesh | None]:
    """Return the triangles for which a picture of emission is dark, and those that glow.

    A triangle glows if the picture does at a corner, in the middle of a side or in its own.
    """
    places = np.einsum("sc,tcx->tsx", _SAMPLES, mesh.uvs[mesh.triangles])
    height, width = picture.shape[:2]
    column = np.floor(places[..., 0] * width).astype(np.int64) % width
    row = np.floor((1.0 - places[..., 1]) * height).astype(np.int64) % height
    light: NDArray[np.float64] = LINEAR_OF_SRGB8[picture[row, column][..., :3]].max(axis=-1)
    glows = light.max(axis=1) > DARK
    chosen = (
        dataclasses.replace(mesh, triangles=mesh.triangles[kept]) if kept.any() else None
        for kept in (~glows, glows)
    )
    dark, bright = chosen
    return dark, bright

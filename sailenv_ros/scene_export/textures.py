"""Textures of a scene as picture files, each once: equal pictures have one name."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from sailenv_ros.assets.glb import JPEG_QUALITY
from sailenv_ros.frame.pictures.codecs import encode_jpeg, encode_png
from sailenv_ros.scene_export.mesh_files import MeshFiles
from sailenv_ros.types.model import Material, Texture

__all__ = ["SLOTS", "Picture", "Textures", "halved", "texture_slots"]

SLOTS = ("base_colour", "metallic_roughness", "normal")
"""Maps of a material, as its fields begin."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """One picture file.

    Attributes
    ----------
    name : str
        Of the file, after its content.
    data : bytes
    mime_type : str
    """

    name: str
    data: bytes
    mime_type: str


class FilesBeside:
    """Meshes and pictures that lie beside a file.

    Parameters
    ----------
    png : bool
        As of `Textures`.
    """

    def __init__(self, *, png: bool = False) -> None:
        self._meshes, self._textures = MeshFiles(), Textures(png=png)

    @property
    def files(self) -> dict[str, bytes]:
        """All of them by their names."""
        pictures = self._textures.pictures.values()
        return self._meshes.files | {picture.name: picture.data for picture in pictures}


class Textures:
    """Picture files by what they are of.

    Parameters
    ----------
    png : bool
        True stores all of them as PNG, for programs that read nothing else.
    """

    def __init__(self, *, png: bool = False) -> None:
        self._png = png
        self._of: dict[tuple[int, bool], Picture] = {}
        self._kept: list[Texture] = []
        self._by_name: dict[str, Picture] = {}

    @property
    def pictures(self) -> Mapping[str, Picture]:
        """All pictures that were asked for, by their names."""
        return self._by_name

    def of(self, texture: Texture, *, alpha: bool) -> Picture:
        """Return the file of a texture, the same one for the same content.

        Parameters
        ----------
        texture : (H, W, 4) uint8
        alpha : bool
            Whether its alpha is seen.
        """
        lossless = alpha or self._png
        key = id(texture), alpha
        if key not in self._of:
            data = _stored(texture, lossless=lossless, alpha=alpha)
            stem, kind = hashlib.sha256(data).hexdigest()[:16], "png" if lossless else "jpg"
            mime = "image/png" if lossless else "image/jpeg"
            made = Picture(name=f"{stem}.{kind}", data=data, mime_type=mime)
            self._of[key] = self._by_name.setdefault(made.name, made)
            self._kept.append(texture)  # so that no other one gets its id
        return self._of[key]


def texture_slots(material: Material) -> Iterator[tuple[str, Texture, bool]]:
    """Yield the name of each map that a material has, the map, and whether its alpha is seen."""
    seen = material.alpha != "opaque"
    for slot in SLOTS:
        texture: Texture | None = getattr(material, f"{slot}_texture")
        if texture is not None:
            yield slot, texture, seen and slot == "base_colour"


def halved(texture: Texture) -> Texture:
    """Return a texture of half the width and height, at least 1."""
    height, width = (max(side // 2, 1) for side in texture.shape[:2])
    made = cv2.resize(texture, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(made, np.uint8)


def _stored(texture: Texture, *, lossless: bool, alpha: bool) -> bytes:
    """Return the bytes of a JPEG file, of the quality of those in packs, or of a PNG."""
    picture = np.ascontiguousarray(texture[..., : 4 if alpha else 3])
    if lossless:
        return encode_png(picture)
    return encode_jpeg(picture, JPEG_QUALITY, full_colour=True)

"""Textures as the native kernels read them; each is made once and kept while it is shown."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.drawing import mip_chain
from sailenv_ros.native.render_types import TEXTURE, address, record
from sailenv_ros.render.scene.packed_maps import pack_maps
from sailenv_ros.render.scene.texture_images import SIZES_PX, array_of, square_texels
from sailenv_ros.types.model import Material, Texture

__all__ = ["TextureStore"]

_Key = tuple[int, ...]


class TextureStore:
    """The textures of the scenes that were shown last."""

    def __init__(self) -> None:
        # The number of a texture is unique only while it lives: the first entry keeps it.
        self._textures: dict[_Key, tuple[object, NDArray[np.uint32], NDArray[np.void]]] = {}

    def colour_map(self, material: Material) -> int:
        """Return the address of a material's colour map; 0 if it has none."""
        texture = material.base_colour_texture
        if texture is None:
            return 0
        key = (id(texture),)
        if key not in self._textures:
            self._add(key, texture, texture, is_colour=True)
        return address(self._textures[key][2])

    def detail_map(self, material: Material) -> int:
        """Return the address of a material's normals, roughness and metallic; 0 if it has none."""
        key = _detail_key(material)
        if key not in self._textures:
            packed = pack_maps(material)
            if packed is None:
                return 0
            kept = material.metallic_roughness_texture, material.normal_texture
            self._add(key, kept, packed, is_colour=False)
        return address(self._textures[key][2])

    def trim(self, shown: Iterable[Material]) -> None:
        """Forget what is not shown, if that is more than what is."""
        kept: set[_Key] = set()
        for material in shown:
            kept |= {(id(material.base_colour_texture),), _detail_key(material)}
        sizes = {key: chain.nbytes for key, (_, chain, _) in self._textures.items()}
        held = sum(size for key, size in sizes.items() if key in kept)
        if sum(sizes.values()) > 2 * held:
            self._textures = {key: entry for key, entry in self._textures.items() if key in kept}

    def _add(self, key: _Key, kept: object, texture: Texture, *, is_colour: bool) -> None:
        edge = SIZES_PX[array_of(texture)]
        chain = mip_chain(square_texels(texture, edge, is_colour=is_colour))
        entry = record(TEXTURE, texels_at=address(chain), log2_size=edge.bit_length() - 1)
        self._textures[key] = (kept, chain, entry)


def _detail_key(material: Material) -> _Key:
    return id(material.metallic_roughness_texture), id(material.normal_texture)

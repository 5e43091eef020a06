"""Textures as the native kernels read them; each is made once and kept while it is shown."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.drawing import mip_chain
from sailenv_ros.native.render_types import TEXTURE, address, record
from sailenv_ros.render.scene.packed_maps import pack_maps
from sailenv_ros.render.scene.texture_images import SIZES_PX, array_of, square_texels
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.model import Material, Texture

__all__ = ["TextureStore"]

SPARE_BYTES = 8 << 20
"""Most that is kept of textures that are not shown: of objects that come and go [B]."""

_Key = tuple[int, ...]

_Entry = tuple[object, NDArray[np.uint32], NDArray[np.void]]
"""Textures that keep the key unique, the texels of all levels, the TEXTURE that tells of them."""


class TextureStore:
    """The textures of the scenes that were shown last."""

    def __init__(self) -> None:
        # The number of a texture is unique only while it lives: the first entry keeps it.
        self._textures: dict[_Key, _Entry] = {}

    def prepare(self, materials: Iterable[Material]) -> None:
        """Make the maps of materials, several at once: a room has some hundreds."""
        missing: dict[_Key, tuple[Callable[[Material], _Entry | None], Material]] = {}
        for material in materials:
            missing[_colour_key(material)] = _colour_entry, material
            missing[_detail_key(material)] = _detail_entry, material
        for key in self._textures.keys() & missing.keys():
            del missing[key]
        if not missing:
            return
        with ThreadPoolExecutor(thread_count()) as pool:
            made = pool.map(lambda job: job[0](job[1]), missing.values())
            self._textures.update(
                (key, entry) for key, entry in zip(missing, made, strict=True) if entry is not None
            )

    def colour_map(self, material: Material) -> int:
        """Return the address of a material's colour map; 0 if it has none."""
        return self._address(_colour_key(material), material, _colour_entry)

    def detail_map(self, material: Material) -> int:
        """Return the address of a material's normals, roughness and metallic; 0 if it has none."""
        return self._address(_detail_key(material), material, _detail_entry)

    def trim(self, shown: Iterable[Material]) -> None:
        """Forget what is not shown, if that is more than `SPARE_BYTES`."""
        kept: set[_Key] = set()
        for material in shown:
            kept |= {_colour_key(material), _detail_key(material)}
        spare = self._textures.keys() - kept
        if sum(self._textures[key][1].nbytes for key in spare) > SPARE_BYTES:
            for key in spare:
                del self._textures[key]

    def _address(
        self, key: _Key, material: Material, make: Callable[[Material], _Entry | None]
    ) -> int:
        entry = self._textures.get(key) or make(material)
        if entry is None:
            return 0
        self._textures[key] = entry
        return address(entry[2])


def _colour_entry(material: Material) -> _Entry | None:
    texture = material.base_colour_texture
    return None if texture is None else _entry(texture, texture, is_colour=True)


def _detail_entry(material: Material) -> _Entry | None:
    packed = pack_maps(material)
    if packed is None:
        return None
    kept = material.metallic_roughness_texture, material.normal_texture
    return _entry(kept, packed, is_colour=False)


def _entry(kept: object, texture: Texture, *, is_colour: bool) -> _Entry:
    edge = SIZES_PX[array_of(texture)]
    chain = mip_chain(square_texels(texture, edge, is_colour=is_colour))
    return kept, chain, record(TEXTURE, texels_at=address(chain), log2_size=edge.bit_length() - 1)


def _colour_key(material: Material) -> _Key:
    return (id(material.base_colour_texture),)


def _detail_key(material: Material) -> _Key:
    return id(material.metallic_roughness_texture), id(material.normal_texture)

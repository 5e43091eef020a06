"""Materials and textures on the GPU.

Materials come in, row numbers of a storage buffer go out. Textures lie in three arrays by size;
each is brought to the next size that holds it, with mip-maps and anisotropic filtering.
"""

from __future__ import annotations

from collections.abc import Iterable

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.model import Material, Texture
from sailenv_ros.render.programs import set_uniform

__all__ = ["MaterialBuffers"]

SIZES_PX = (128, 512, 1024)
"""Edge lengths of the three texture arrays."""

ANISOTROPY = 4.0

_LAYER_BITS = 12
_FIRST_TEXTURE_UNIT = 8

ROW = np.dtype(
    [
        ("base_colour", "<f4", 4),
        ("roughness", "<f4"),
        ("metallic", "<f4"),
        ("alpha_cutoff", "<f4"),
        ("emission", "<f4"),
        ("textures", "<i4", 4),
    ]
)

EMISSION_SCALE = 16.0
"""Radiance, in units of the base colour, that the G-buffer's 8 bits can hold."""


class MaterialBuffers:
    """All materials and textures of one context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._rows: dict[int, int] = {}
        self._kept: list[Material] = []
        self._layers: tuple[list[Texture], ...] = tuple([] for _ in SIZES_PX)
        self._place_of: dict[int, int] = {}
        self._buffer: moderngl.Buffer | None = None
        self._arrays: list[moderngl.TextureArray] = []

    def upload(self, materials: Iterable[Material]) -> None:
        """Make sure that all materials are there."""
        new = list({id(m): m for m in materials if id(m) not in self._rows}.values())
        if not new and self._buffer is not None:
            return
        textures_before = sum(len(layers) for layers in self._layers)
        for material in new:
            self._rows[id(material)] = len(self._kept)
            self._kept.append(material)
        rows = np.zeros(max(1, len(self._kept)), ROW)
        for row, material in zip(rows, self._kept, strict=False):
            self._fill(row, material)
        if self._buffer is not None:
            self._buffer.release()
        self._buffer = self._context.buffer(rows.tobytes())
        if not self._arrays or textures_before != sum(len(layers) for layers in self._layers):
            self._build_arrays()

    def row(self, material: Material) -> int:
        """Give the row of an uploaded material."""
        return self._rows[id(material)]

    def bind(self, program: moderngl.Program) -> None:
        """Make rows and textures readable for a program."""
        if self._buffer is not None:
            self._buffer.bind_to_storage_buffer(1)
        for number, array in enumerate(self._arrays):
            array.use(_FIRST_TEXTURE_UNIT + number)
            set_uniform(program, f"textures_{number}", _FIRST_TEXTURE_UNIT + number)

    def close(self) -> None:
        """Free everything on the GPU."""
        for array in self._arrays:
            array.release()
        if self._buffer is not None:
            self._buffer.release()
        self._arrays, self._buffer = [], None

    def _fill(self, row: np.void, material: Material) -> None:
        base = np.asarray(material.base_colour, dtype=np.float64)
        glow = float(max(material.emission))
        if glow > 0.0:
            # The G-buffer holds one colour and one strength: what glows has the glow's colour.
            base[:3] = np.asarray(material.emission) / glow
        row["base_colour"] = base
        row["roughness"], row["metallic"] = material.roughness, material.metallic
        row["alpha_cutoff"] = material.alpha_cutoff
        row["emission"] = min(1.0, glow / EMISSION_SCALE)
        textures = (
            material.base_colour_texture,
            material.metallic_roughness_texture,
            material.normal_texture,
        )
        row["textures"] = [*(self._place(texture) for texture in textures), -1]

    def _place(self, texture: Texture | None) -> int:
        """Give array and layer of a texture as one number, -1 for none."""
        if texture is None:
            return -1
        if id(texture) not in self._place_of:
            size = next(
                (i for i, edge in enumerate(SIZES_PX) if max(texture.shape[:2]) <= edge),
                len(SIZES_PX) - 1,
            )
            layers = self._layers[size]
            self._place_of[id(texture)] = (size << _LAYER_BITS) + len(layers)
            layers.append(texture)
        return self._place_of[id(texture)]

    def _build_arrays(self) -> None:
        for array in self._arrays:
            array.release()
        self._arrays = []
        for edge, layers in zip(SIZES_PX, self._layers, strict=True):
            # An array that nothing lies in still has to be bound: the smallest there is.
            pixels = [_resized(layer, edge) for layer in layers] or [np.zeros((1, 1, 4), np.uint8)]
            shape = (pixels[0].shape[1], pixels[0].shape[0], len(pixels))
            array = self._context.texture_array(shape, 4, np.stack(pixels).tobytes())
            array.build_mipmaps()
            array.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
            array.anisotropy = ANISOTROPY
            self._arrays.append(array)


def _resized(texture: Texture, edge: int) -> NDArray[np.uint8]:
    """Bring a texture to a square, its bottom row first as OpenGL has it."""
    flipped = np.ascontiguousarray(texture[::-1])
    if flipped.shape[:2] == (edge, edge):
        return flipped
    shrinks = max(flipped.shape[:2]) > edge
    method = cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(flipped, (edge, edge), interpolation=method), dtype=np.uint8)
